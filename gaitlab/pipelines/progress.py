"""What a long computation tells its caller while it runs."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Step:
    """One report of progress."""

    stage: str
    """What is being done, in words: "reading", "tracking" ..."""
    trial: str = ""
    """File stem of the recording, where the step belongs to one."""
    done: float | None = None
    """Finished part of the stage, 0 to 1, where known."""
    iteration: int | None = None
    residual: float | None = None


Progress = Callable[[Step], None]
"""Called between iterations. It cancels the computation by raising `gaitlab.errors.Cancelled`."""


def silent(step: Step) -> None:
    """Report nothing."""
    del step  # Unused.
