"""The demo recordings of both children: `gaitlab demo-data` writes them."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..mocap.c3d import write_c3d
from ..multibody.presets import ABLE_BODIED_CHILD, CP_CHILD
from .demo_gait import reference_gait
from .demo_markers import body_parameters, standing_coordinates, with_markers
from .demo_patterns import GaitPattern, demo_patterns
from .demo_recording import Laboratory, static_recording, walk_recording
from .demo_reference import reference_walk

HEIGHTS = {child.name: child.height for child in (CP_CHILD, ABLE_BODIED_CHILD)}
"""[m]"""
WALKS: Mapping[str, Mapping[str, tuple[float, float]]] = {
    "demo_cp_child": {"walk1": (1.20, 0.78), "walk2": (1.12, 0.84)},
    "demo_able_bodied_child": {"walk1": (1.04, 1.10), "walk2": (0.96, 1.20)},
}
"""Stride time [s] and speed [m/s]."""
LABORATORIES = {"walk1": Laboratory(), "walk2": Laboratory(heading=np.pi, noise=5e-4, seed=2)}


def write_demo_data(directory: Path) -> None:
    """Write the demo recordings of both children into a folder, one folder for each child.

    Raises:
        OutputError: The folder cannot be written.
    """
    for pattern in demo_patterns():
        folder = directory / pattern.name
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{folder}: cannot be made ({error}); choose another folder") from error
        _write_child(folder, pattern)


def _write_child(folder: Path, pattern: GaitPattern) -> None:
    subject = pattern.preset()
    parameters = body_parameters(subject, HEIGHTS[subject.name])
    subject = with_markers(subject, parameters, pattern.tilt)
    standing = standing_coordinates(subject, pattern)
    write_c3d(folder / "static.c3d", static_recording(subject, standing, parameters))
    for name, (stride_time, speed) in WALKS[pattern.name].items():
        gait = reference_gait(pattern.paced(stride_time, speed))
        walk = replace(reference_walk(gait), subject=subject)
        write_c3d(folder / f"{name}.c3d", walk_recording(name, walk, parameters, LABORATORIES[name]))
