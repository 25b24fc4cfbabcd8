"""What is in a C3D file, in words."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..mocap.c3d import read_c3d
from ..mocap.recording import Recording


@dataclass(frozen=True, kw_only=True)
class Inspection:
    """One file as rows of title and text."""

    name: str
    rows: tuple[tuple[str, str], ...]


def inspect_file(path: Path) -> Inspection:
    """Read a C3D file and describe it."""
    return Inspection(name=str(path), rows=tuple(_rows(read_c3d(path))))


def _rows(recording: Recording) -> Iterator[tuple[str, str]]:
    seconds = recording.n_frames / recording.rate
    yield "frames", f"{recording.n_frames} at {recording.rate:g} Hz, {seconds:.2f} s, first {recording.first_frame}"
    yield "markers", ", ".join(sorted(recording.markers))
    yield "markers with gaps", ", ".join(_gaps(recording)) or "none"
    yield "events", ", ".join(_events(recording)) or "none"
    yield "event times", ", ".join(_event_times(recording)) or "none"
    yield "force plates", ", ".join(_plates(recording)) or "none"
    yield "body parameters", ", ".join(f"{k} {v:.4g}" for k, v in sorted(recording.parameters.items())) or "none"
    yield "outputs of other software", str(len(recording.model_outputs))
    yield "other analogue channels", str(len(recording.analog))
    yield "warnings", "; ".join(recording.warnings) or "none"
    yield "sha256", recording.sha256


def _gaps(recording: Recording) -> Iterator[str]:
    for name, positions in sorted(recording.markers.items()):
        missing = int(np.isnan(positions).any(axis=1).sum())
        if missing:
            yield f"{name} {missing}"


def _events(recording: Recording) -> Iterator[str]:
    counts = Counter((event.side, event.kind.replace("_", " ")) for event in recording.events)
    for (side, kind), count in sorted(counts.items()):
        yield f"{count} {side} {kind}"


def _event_times(recording: Recording) -> Iterator[str]:
    for event in sorted(recording.events, key=lambda event: event.time):
        yield f"{event.side} {event.kind.replace('_', ' ')} {event.time:.4f}"


def _plates(recording: Recording) -> Iterator[str]:
    for number, plate in enumerate(recording.force_plates, 1):
        yield f"{number}: up to {np.nanmax(np.abs(plate.force), initial=0.0):.0f} N at {plate.rate:g} Hz"
