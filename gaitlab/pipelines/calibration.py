"""Calibration of a walk, and what the document says about it."""

from collections.abc import Mapping

from ..clinical.document import SIDES, CalibrationEntry
from ..inverse.conventional_calibration import Calibration
from ..inverse.static import CalibrationSettings, calibrate, calibrate_subject, stored_offsets
from ..inverse.static_offsets import OFFSETS
from ..mocap.recording import Recording
from .options import StaticOffsets


def calibrate_walk(
    static: Recording | None, walk: Recording, given: Mapping[str, float], offsets: StaticOffsets
) -> tuple[Calibration, CalibrationEntry]:
    """Calibration of a walk with the chosen offsets, and both kinds of offsets side by side."""
    settings = CalibrationSettings(offsets="file" if offsets == "file" else "static")
    calibration = calibrate_subject(static, walk, given, settings)
    computed = {} if static is None else _offsets(calibrate(static, calibration.parameters))
    return calibration, CalibrationEntry(used=_used(calibration), computed=computed, stored=_stored(calibration))


def assumed_parameters(
    calibration: Calibration, static: Recording | None, walk: Recording, given: Mapping[str, float]
) -> tuple[str, ...]:
    """Names of body parameters that nobody gave and that were estimated."""
    known = {*given, *walk.parameters, *(static.parameters if static is not None else ())}
    return tuple(sorted(name for name in calibration.parameters if name not in known))


def _used(calibration: Calibration) -> str:
    origin = {"file": "stored in the file", "static": "computed from the static trial", "none": "none known"}
    return "; ".join(f"{side} {origin[c.offsets]}, knee axis by {c.method}" for side, c in calibration.sides.items())


def _offsets(calibration: Calibration) -> dict[str, float]:
    return {f"{side}_{name}": float(getattr(calibration.sides[side], name)) for side in SIDES for name in OFFSETS}


def _stored(calibration: Calibration) -> dict[str, float]:
    stored = {side: stored_offsets(calibration.parameters, side) for side in SIDES}
    return {f"{side}_{name}": value for side, values in stored.items() for name, value in values.items()}
