"""The body measurements of the conventional gait model: given, stored in the files, or estimated from markers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from gaitlab.errors import InvalidSubject
from gaitlab.inverse.conventional_calibration import SIDES
from gaitlab.inverse.static_knee import knee_marker
from gaitlab.mocap.recording import Recording, Side

STANDARD_MARKER_DIAMETER = 0.014  # [m], Plug-in Gait's default
MARKER_DIAMETERS = (0.004, 0.03)  # [m], what exists
WIDTH_PER_LEG_LENGTH: Mapping[str, float] = {"knee_width": 0.132, "ankle_width": 0.081}
"""Mean of six children and three adults (26 to 85 kg); the spread is 13 %, about 6 mm at the joint centre."""
ANKLE_MEDIAL = ("MED", "MMA")
KNEE_MEDIAL = ("KNM",)
SAME = 0.02  # relative difference of a measurement between static and walk that is worth no word
MEASUREMENTS = ("mass", "height", "inter_asis_distance", "marker_diameter", "leg_length", "knee_width", "ankle_width")


@dataclass(frozen=True, kw_only=True)
class BodyMeasurements:
    """Everything numeric that is known about the person."""

    values: Mapping[str, float]
    """SI units: mass, height, marker_diameter, inter_asis_distance, left_leg_length, left_knee_width ..., and the
    angles stored in the files."""
    warnings: tuple[str, ...] = ()
    """What was estimated, and where static and walk disagree."""


def body_measurements(
    given: Mapping[str, float], static: Recording | None = None, walk: Recording | None = None
) -> BodyMeasurements:
    """What the user gave, else what the walk's file holds, else the static's, else estimates from markers.

    Leg length is ASIS to lateral knee to lateral ankle, widths are those between medial and lateral markers, else
    fractions of leg length; ASIS to trochanter is 0.1288 leg length - 0.04856 m (Davis et al. 1991); marker diameter
    follows from joint centres stored in the file, else 14 mm. Every estimate is reported.

    Raises:
        InvalidSubject: A measurement is impossible, or there is neither a static nor any measurement.
    """
    for name, value in given.items():
        if name.endswith(MEASUREMENTS) and not value > 0.0:
            raise InvalidSubject(
                f"{name} is {value:g}, but must be greater than zero (kg or m); give the measured value"
            )
    stored = dict(static.parameters if static else {}) | dict(walk.parameters if walk else {})
    values = stored | dict(given)
    warnings = _disagreements(static, walk, given)
    if static is None and not any(name.endswith(("leg_length", "knee_width", "height")) for name in values):
        raise InvalidSubject(
            "there is neither a static trial nor any body measurement: give a static, or leg length, knee width and "
            "ankle width of both sides"
        )
    source = static if static is not None else walk
    if source is not None:
        for complete in (_marker_diameter, _inter_asis, _leg_lengths, _widths):
            warnings += complete(values, source, walk)
    for side in SIDES:
        leg = values.get(f"{side}_leg_length")
        if leg is not None:
            values.setdefault(f"{side}_asis_trochanter", 0.1288 * leg - 0.04856)
    return BodyMeasurements(values=values, warnings=tuple(warnings))


def _disagreements(static: Recording | None, walk: Recording | None, given: Mapping[str, float]) -> list[str]:
    if static is None or walk is None:
        return []
    different = [
        f"{name} {static.parameters[name]:.4g} and {value:.4g}"
        for name, value in walk.parameters.items()
        if name.endswith(MEASUREMENTS) and name in static.parameters and name not in given
        if abs(static.parameters[name] - value) > SAME * abs(value)
    ]
    if not different:
        return []
    return [f"static and walk hold different measurements, the walk's are used: {', '.join(different)} (kg, m)"]


def _marker_diameter(values: dict[str, float], source: Recording, walk: Recording | None) -> list[str]:
    if "marker_diameter" in values:
        return []
    implied = [d for trial in (walk, source) if trial is not None for d in _implied_diameters(values, trial)]
    if implied and MARKER_DIAMETERS[0] < min(implied) and max(implied) < MARKER_DIAMETERS[1]:
        values["marker_diameter"] = float(np.median(implied))
        why = "it follows from the knee centres stored in the file"
    else:
        values["marker_diameter"] = STANDARD_MARKER_DIAMETER
        why = "it is assumed; give the right one if it differs"
    return [f"marker diameter not stored: {1e3 * values['marker_diameter']:.1f} mm, {why}"]


def _implied_diameters(values: Mapping[str, float], trial: Recording) -> list[float]:
    """Twice the distance from stored knee centres (FEO) to KNE, less the knee width [m]."""
    found: list[float] = []
    for side in SIDES:
        letter = side[0].upper()
        marker, centre = trial.markers.get(f"{letter}KNE"), trial.model_outputs.get(f"{letter}FEO")
        width = values.get(f"{side}_knee_width")
        distance = None if marker is None or centre is None else _distance(marker, centre)
        if width is not None and distance is not None:
            found.append(2 * distance - width)
    return found


def _inter_asis(values: dict[str, float], source: Recording, walk: Recording | None) -> list[str]:
    del walk  # The static shows it best.
    if "inter_asis_distance" in values:
        return []
    distance = _between(source.markers, ("LASI",), ("RASI",))
    if distance is None:
        return []
    values["inter_asis_distance"] = distance
    return [f"distance between the ASIS not stored: {1e3 * distance:.0f} mm between the markers"]


def _leg_lengths(values: dict[str, float], source: Recording, walk: Recording | None) -> list[str]:
    del walk

    def estimate(side: Side) -> tuple[float, str] | None:
        letter = side[0].upper()
        markers = dict(source.markers) | knee_marker(source.markers, side)
        thigh = _between(markers, (f"{letter}ASI",), (f"{letter}KNE",))
        shank = _between(markers, (f"{letter}KNE",), (f"{letter}ANK",))
        return None if thigh is None or shank is None else (thigh + shank, "ASIS to knee to ankle markers")

    return _complete_sides(values, "leg_length", estimate)


def _widths(values: dict[str, float], source: Recording, walk: Recording | None) -> list[str]:
    del walk
    warnings: list[str] = []
    for name, lateral, medial in (("knee_width", "KNE", KNEE_MEDIAL), ("ankle_width", "ANK", ANKLE_MEDIAL)):

        def estimate(
            side: Side, name: str = name, lateral: str = lateral, medial: tuple[str, ...] = medial
        ) -> tuple[float, str] | None:
            letter = side[0].upper()
            markers = dict(source.markers) | knee_marker(source.markers, side)
            distance = _between(markers, (letter + lateral,), tuple(letter + m for m in medial))
            if distance is not None and distance > values["marker_diameter"]:
                return distance - values["marker_diameter"], "between medial and lateral marker"
            leg = values.get(f"{side}_leg_length")
            factor = WIDTH_PER_LEG_LENGTH[name]
            return None if leg is None else (factor * leg, f"{factor:g} of leg length; joint centres may be 6 mm off")

        warnings += _complete_sides(values, name, estimate)
    return warnings


def _complete_sides(
    values: dict[str, float], name: str, estimate: Callable[[Side], tuple[float, str] | None]
) -> list[str]:
    """Fills in `name` of both sides: from the other side, else by `estimate`; says so."""
    known = [side for side in SIDES if f"{side}_{name}" in values]
    warnings: list[str] = []
    for side in SIDES:
        if side in known:
            continue
        found = (values[f"{known[0]}_{name}"], f"as on the {known[0]}") if known else estimate(side)
        if found is not None:
            values[f"{side}_{name}"], why = found
            warnings.append(f"{side} {name.replace('_', ' ')} not given: {1e3 * found[0]:.0f} mm, {why}")
    return warnings


def _between(markers: Mapping[str, np.ndarray], first: tuple[str, ...], second: tuple[str, ...]) -> float | None:
    """Median distance [m] of the first pair of markers that are seen together; None if there is none."""
    for a in first:
        for b in second:
            if a in markers and b in markers:
                distance = _distance(markers[a], markers[b])
                if distance is not None:
                    return distance
    return None


def _distance(a: np.ndarray, b: np.ndarray) -> float | None:
    distances = np.linalg.norm(a - b, axis=1)
    distances = distances[np.isfinite(distances)]
    return float(np.median(distances)) if distances.size else None
