"""The demo recordings of both children: `gaitlab demo-data` writes them."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import OutputError
from ..mocap.c3d import write_c3d
from .demo_patterns import GaitPattern, demo_patterns
from .demo_recording import Laboratory, walk_recording
from .demo_subject import demo_subject
from .demo_walk import demo_walk

WALKS: Mapping[str, Mapping[str, tuple[float, float]]] = {
    "demo_cp_child": {"walk1": (1.20, 0.78), "walk2": (1.12, 0.84)},
    "demo_able_bodied_child": {"walk1": (1.04, 1.10), "walk2": (0.96, 1.20)},
}
"""Stride time [s] and speed [m/s]."""
LABORATORIES = {"walk1": Laboratory(), "walk2": Laboratory(heading=np.pi, noise=5e-4, seed=2)}
WEIGHTS: Mapping[str, dict[str, float]] = {
    "demo_cp_child": {
        "lateral_stability": 0.35,
        "torque": 0.25,
        "hip_adduction_torque": 0.25,
        "hip_rotation_torque": 0.15,
    },
    "demo_able_bodied_child": {
        "lateral_stability": 0.15,
        "torque": 0.50,
        "hip_adduction_torque": 0.20,
        "hip_rotation_torque": 0.15,
    },
}
"""Of criteria divided by their values on the tracked stride; truth.json restates them for the recorded stride."""


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
    child = demo_subject(pattern)
    write_c3d(folder / "static.c3d", child.static)
    truth: dict[str, Any] = {
        "preset": child.preset.name,
        "parameters": child.parameters,
        "static_q": child.standing.round(7).tolist(),
        "markers_noise_m": {name: laboratory.noise for name, laboratory in LABORATORIES.items()},
        "walks": {},
    }
    for name, (stride_time, speed) in WALKS[pattern.name].items():
        demo = demo_walk(pattern.paced(stride_time, speed), child.model, WEIGHTS[pattern.name])
        write_c3d(folder / f"{name}.c3d", walk_recording(name, demo.walk, child.parameters, LABORATORIES[name]))
        truth["walks"][name] = demo.truth
    (folder / "truth.json").write_text(json.dumps(truth, separators=(",", ":")) + "\n")
