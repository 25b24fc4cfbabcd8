"""Results per frame that are written into a C3D file as points of a type: angles, moments, powers."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

OutputKind = Literal["ANGLES", "MOMENTS", "POWERS"]
"""Groups of POINT that name the points of a type, as Vicon's files have them."""


@dataclass(frozen=True, kw_only=True)
class PointOutput:
    """One point of a type."""

    label: str
    kind: OutputKind
    values: np.ndarray
    """Angles [deg], moments [N*m/kg], powers [W/kg], shape (n_frames, 3); a frame with NaN is missing as a whole."""
    meaning: str
    """Of the three components, in words."""


def save_outputs(path: Path, outputs: Sequence[PointOutput]) -> None:
    """Writes `outputs` as a numpy archive without pickled objects."""
    head = [{"label": output.label, "kind": output.kind, "meaning": output.meaning} for output in outputs]
    text = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    with path.open("wb") as file:
        np.savez(file, head=text, values=np.stack([output.values for output in outputs]))


def load_outputs(path: Path) -> tuple[PointOutput, ...]:
    """Reads what `save_outputs` wrote."""
    with np.load(path, allow_pickle=False) as archive:
        head, values = json.loads(archive["head"].tobytes().decode()), archive["values"]
    return tuple(PointOutput(**members, values=value) for members, value in zip(head, values, strict=True))
