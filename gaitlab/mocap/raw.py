"""What a C3D file holds, before anything is interpreted: the value that the reading process hands over."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ParameterValue = tuple[str, ...] | np.ndarray


@dataclass(frozen=True, kw_only=True)
class RawRecording:
    """Contents of one C3D file in the file's own units."""

    labels: tuple[str, ...]
    """One label per point, LABELS, LABELS2 ... joined."""
    points: np.ndarray
    """Points in the file's units, laboratory frame, shape (n_frames, n_points, 3); NaN where missing."""
    rate: float
    """Video frames per second [Hz]."""
    first_frame: int
    """Frames between the start of capture and the first stored frame."""
    analog: np.ndarray
    """Scaled analogue samples in the file's units, shape (n_samples, n_channels)."""
    analog_rate: float
    """Analogue samples per second [Hz]; 0 without analogue channels."""
    parameters: Mapping[str, Mapping[str, ParameterValue]]
    """Group and parameter names in capitals; texts as tuples, numbers as arrays of the file's shape."""

    def texts(self, group: str, name: str) -> tuple[str, ...]:
        """Text parameter, stripped; empty when it is missing or numeric."""
        value = self.parameters.get(group, {}).get(name, ())
        return value if isinstance(value, tuple) else ()

    def numbers(self, group: str, name: str) -> np.ndarray:
        """Numeric parameter, shape as in the file; shape (0,) when it is missing or text."""
        value = self.parameters.get(group, {}).get(name, ())
        return np.empty(0) if isinstance(value, tuple) else value

    def numbered_texts(self, group: str, name: str) -> tuple[str, ...]:
        """NAME, NAME2, NAME3 ... joined: C3D parameters hold at most 255 entries each."""
        joined = self.texts(group, name)
        number = 2
        while f"{name}{number}" in self.parameters.get(group, {}):
            joined += self.texts(group, f"{name}{number}")
            number += 1
        return joined


def save_raw(path: Path, raw: RawRecording) -> None:
    """Writes `raw` as a numpy archive without pickled objects."""
    parameters = {
        group: {name: _to_json(value) for name, value in members.items()} for group, members in raw.parameters.items()
    }
    head = {
        "labels": raw.labels,
        "rate": raw.rate,
        "first_frame": raw.first_frame,
        "analog_rate": raw.analog_rate,
        "parameters": parameters,
    }
    text = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    with path.open("wb") as file:
        np.savez(file, head=text, points=raw.points, analog=raw.analog)


def load_raw(path: Path) -> RawRecording:
    """Reads what `save_raw` wrote."""
    with np.load(path, allow_pickle=False) as archive:
        head = json.loads(archive["head"].tobytes().decode())
        points, analog = archive["points"], archive["analog"]
    parameters = {
        group: {name: _from_json(value) for name, value in members.items()}
        for group, members in head["parameters"].items()
    }
    return RawRecording(
        labels=tuple(head["labels"]),
        points=points,
        rate=head["rate"],
        first_frame=head["first_frame"],
        analog=analog,
        analog_rate=head["analog_rate"],
        parameters=parameters,
    )


def _to_json(value: ParameterValue) -> list[str] | dict[str, list[float] | list[int]]:
    if isinstance(value, tuple):
        return list(value)
    return {"shape": list(value.shape), "values": [float(x) for x in value.ravel()]}


def _from_json(value: list[str] | dict[str, list[float]]) -> ParameterValue:
    if isinstance(value, list):
        return tuple(value)
    return np.array(value["values"]).reshape([int(n) for n in value["shape"]])
