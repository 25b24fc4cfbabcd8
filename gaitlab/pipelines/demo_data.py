"""The demo recordings, simulated from known weights."""

from pathlib import Path

from ..errors import ProblemError


def write_demo_data(directory: Path) -> None:
    """Write the demo recordings of both children into a folder."""
    raise ProblemError(f"{directory}: the demo recordings cannot be simulated yet")
