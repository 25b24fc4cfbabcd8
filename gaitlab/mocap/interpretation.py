"""From the contents of a C3D file to a `Recording`: names, units, events, plates, subject parameters."""

from collections.abc import Collection

import numpy as np

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.force_plates import force_plates, plate_channels
from gaitlab.mocap.labels import OUTPUT_GROUPS, sort_labels
from gaitlab.mocap.laboratory import rotation_to_z_up
from gaitlab.mocap.privacy import privacy_warnings
from gaitlab.mocap.raw import RawRecording
from gaitlab.mocap.recording import Event, EventKind, Recording, Side, SoleChange, SoleChangeKind
from gaitlab.mocap.subject_parameters import subject_parameters

METRES = {"mm": 1e-3, "millimeters": 1e-3, "millimetres": 1e-3, "cm": 1e-2, "m": 1.0, "meters": 1.0, "metres": 1.0}
SIDES: dict[str, Side] = {"left": "left", "right": "right", "l": "left", "r": "right"}
KINDS: dict[str, EventKind] = {
    "foot strike": "foot_strike",
    "heel strike": "foot_strike",
    "initial contact": "foot_strike",
    "foot off": "foot_off",
    "toe off": "foot_off",
}
SOLE_KINDS: dict[str, SoleChangeKind] = {"foot flat": "foot_flat", "heel off": "heel_off", "heel rise": "heel_off"}


def interpret(raw: RawRecording, name: str, sha256: str) -> Recording:
    """The trial `raw` with canonical names and SI units.

    Raises:
        InvalidRecording: There are no markers or no frames, or the rate is missing.
    """
    if raw.points.shape[0] == 0 or raw.points.shape[1] == 0:
        raise InvalidRecording(f"{name}: the C3D file holds no markers; export the trial with its trajectories")
    if not raw.rate > 0:
        raise InvalidRecording(f"{name}: the C3D file states no frame rate; export the trial again")
    groups = {group: raw.numbered_texts("POINT", group) for group in OUTPUT_GROUPS}
    sorted_points = sort_labels(raw.labels, groups)
    if not sorted_points.markers:
        raise InvalidRecording(f"{name}: the C3D file holds no markers, only model outputs; export the trajectories")
    metre, unit_warnings = _metre(raw)
    rotation, vertical = rotation_to_z_up({label: raw.points[:, k] for label, k in sorted_points.markers.items()})
    to_laboratory = metre * rotation.T
    plates, plate_warnings = force_plates(raw, metre, rotation)
    events, event_warnings = file_events(raw)
    parameters, parameter_warnings = subject_parameters(raw)
    positions = {label: raw.points[:, k] @ to_laboratory for label, k in sorted_points.positions.items()}
    outputs = {label: raw.points[:, k].copy() for label, k in sorted_points.outputs.items()}
    turned = () if vertical == "+z" else (f"the file's vertical axis is {vertical}; it is turned so that z points up",)
    said = sorted_points.warnings + unit_warnings + turned + plate_warnings + event_warnings + parameter_warnings
    channels, units = _other_channels(raw), raw.numbered_texts("ANALOG", "UNITS")
    return Recording(
        name=name,
        sha256=sha256,
        rate=raw.rate,
        first_frame=raw.first_frame,
        markers={label: raw.points[:, k] @ to_laboratory for label, k in sorted_points.markers.items()},
        model_outputs=positions | outputs,
        force_plates=plates,
        events=events,
        sole_changes=file_sole_changes(raw),
        parameters=parameters,
        analog={label: raw.analog[:, k].copy() for label, k in channels.items()},
        analog_units={label: units[k] for label, k in channels.items() if k < len(units) and units[k]},
        analog_rate=raw.analog_rate,
        warnings=said + privacy_warnings(raw),
    )


def _metre(raw: RawRecording) -> tuple[float, tuple[str, ...]]:
    """Metres per file unit; without a stated unit, coordinates beyond 20 must be millimetres."""
    stated = (raw.texts("POINT", "UNITS") or ("",))[0].lower()
    if stated in METRES:
        return METRES[stated], ()
    large = np.nanmedian(np.abs(raw.points)) > 20.0 if np.isfinite(raw.points).any() else True
    unit = "mm" if large else "m"
    return METRES[unit], (f"the file states no known length unit; its coordinates are taken as {unit}",)


def file_events(raw: RawRecording) -> tuple[tuple[Event, ...], tuple[str, ...]]:
    """Foot strikes and foot offs of the EVENT group, in time order, and warnings."""
    marks, outside = _marks(raw, {**KINDS, **SOLE_KINDS})
    events = [
        Event(side=side, kind=KINDS[label], time=time, source="file") for side, label, time in marks if label in KINDS
    ]
    warnings = (f"{outside} events of the file lie outside its stored frames and are not used",) if outside else ()
    return tuple(events), warnings


def file_sole_changes(raw: RawRecording) -> tuple[SoleChange, ...]:
    """Foot flats and heel offs of the EVENT group, in time order."""
    marks, _ = _marks(raw, SOLE_KINDS)
    return tuple(SoleChange(side=side, kind=SOLE_KINDS[label], time=time) for side, label, time in marks)


def _marks(raw: RawRecording, wanted: Collection[str]) -> tuple[list[tuple[Side, str, float]], int]:
    """Side, label and time [s] of the EVENT group's entries with a wanted label, in time order; how many lie outside.

    EVENT:TIMES [min; s] count from the start of capture: t = 60 TIMES_0 + TIMES_1 - first_frame / rate.
    """
    labels, contexts = raw.numbered_texts("EVENT", "LABELS"), raw.numbered_texts("EVENT", "CONTEXTS")
    times = raw.numbers("EVENT", "TIMES")
    if not labels or times.size < 2 * len(labels):
        return [], 0
    times = times.ravel(order="F")[: 2 * len(labels)].reshape(-1, 2).T  # stored in pairs
    seconds = 60.0 * times[0] + times[1] - raw.first_frame / raw.rate
    end = (raw.points.shape[0] - 1) / raw.rate
    marks: list[tuple[Side, str, float]] = []
    outside = 0
    for context, stored, time in zip(contexts, labels, seconds, strict=False):
        side, label = SIDES.get(context.strip().lower()), stored.strip().lower()
        if side is None or label not in wanted:
            continue
        if -0.5 / raw.rate <= time <= end + 0.5 / raw.rate:
            marks.append((side, label, min(max(float(time), 0.0), end)))
        else:
            outside += 1
    return sorted(marks, key=lambda mark: mark[2]), outside


def _other_channels(raw: RawRecording) -> dict[str, int]:
    """Columns of the analogue channels that belong to no force plate, by label; equal labels get a number."""
    labels = raw.numbered_texts("ANALOG", "LABELS")
    used = plate_channels(raw)
    channels: dict[str, int] = {}
    for k in range(raw.analog.shape[1]):
        if k in used:
            continue
        label = labels[k] if k < len(labels) and labels[k] else f"channel {k + 1}"
        channels[label if label not in channels else f"{label} ({k + 1})"] = k
    return channels
