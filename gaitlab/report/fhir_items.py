"""The numbers and curves of a result, one by one, with code, unit and convention, ready to become FHIR Observations."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..clinical.document import CURVES, SIDES, Curve, Document, SideSpatiotemporal, WeightsEntry
from ..clinical.kinetics_document import UNITS, CycleAverage
from ..clinical.normative import ReferenceValue
from ..clinical.score_document import ReferenceEntry, SideScores
from ..clinical.spatiotemporal import Spatiotemporal
from ..mocap.recording import Side
from .formatting import label, unit_of
from .kinematics_figure import PANELS as ANGLE_PANELS
from .kinetics_figure import PANELS as FORCE_PANELS
from .wording import CAVEAT, spoken

Json = dict[str, Any]
CODES = "urn:gaitlab:codes"
UCUM: Mapping[str, str] = {
    "m": "m",
    "m/s": "m/s",
    "s": "s",
    "%": "%",
    "steps/min": "{steps}/min",
    "deg": "deg",
    "kg": "kg",
    "N*m/kg": "N.m/kg",
    "W/kg": "W/kg",
    "%BW": "%",
    "1": "1",
}
"""Units of the result to UCUM codes."""
_DIRECTIONS = {panel.name: panel.direction for panel in (*ANGLE_PANELS, *FORCE_PANELS)}
_DIGITS = 5  # of the samples of curves


@dataclass(frozen=True, kw_only=True)
class Item:
    """One observation."""

    code: str
    """In gaitlab's own system."""
    words: str
    value: Json
    """The member value[x]."""
    side: str = ""
    method: str = ""
    """Convention: sign, frame, what was averaged."""
    components: Sequence[Json] = ()
    loinc: str = ""
    note: str = ""
    expected: Json | None = None
    """Member of referenceRange."""
    settled: bool = True
    """False where the number itself carries no certificate: such an observation stays preliminary."""


def items(document: Document) -> Iterator[Item]:
    """Everything that the result holds: body, distances and times, scores, curves, weights."""
    yield from _body(document)
    for side in SIDES:
        entry = document.spatiotemporal.left if side == "left" else document.spatiotemporal.right
        if entry is not None:
            reference = None if document.scores is None else document.scores.reference
            yield from _distances(side, entry, reference)
            yield from _curves(document, side, entry.mean.stride_time_s)
    yield from _scores(document)
    if document.weights is not None:
        yield from _weights(document.weights)


def _quantity(value: float, unit: str) -> Json:
    return {"value": value, "unit": unit, "system": "http://unitsofmeasure.org", "code": UCUM[unit]}


def _component(code: str, value: Json) -> Json:
    return {"code": {"coding": [{"system": CODES, "code": code}], "text": code.replace("-", " ")}, **value}


def _spread(sd: float | None, unit: str, n_cycles: int | None = None) -> list[Json]:
    count = [] if n_cycles is None else [_component("number-of-cycles", {"valueInteger": n_cycles})]
    if sd is None:
        return count
    return [_component("standard-deviation", {"valueQuantity": _quantity(sd, unit)}), *count]


def _body(document: Document) -> Iterator[Item]:
    known = (
        ("body-mass", "Body mass", document.subject.mass_kg, "kg", "29463-7"),
        ("body-height", "Body height", document.subject.height_m, "m", "8302-2"),
    )
    for code, words, value, unit, loinc in known:
        if value is not None:
            yield Item(code=code, words=words, value={"valueQuantity": _quantity(value, unit)}, loinc=loinc)


def _distances(side: Side, entry: SideSpatiotemporal, reference: ReferenceEntry | None) -> Iterator[Item]:
    for name in Spatiotemporal.__struct_fields__:
        value: float | None = getattr(entry.mean, name)
        if value is None:
            continue
        unit = unit_of(name)
        yield Item(
            code=f"spatiotemporal.{name}.{side}",
            words=f"{label(name)}, {side}",
            value={"valueQuantity": _quantity(value, unit)},
            side=side,
            method="mean over the cycles, foot strike to foot strike of the side",
            components=_spread(getattr(entry.sd, name), unit, entry.n_cycles),
            expected=None if reference is None else _expected(reference.spatiotemporal.get(name), unit, reference),
        )
    for name in entry.normalised.__struct_fields__:
        value = getattr(entry.normalised, name)
        if value is not None:
            yield Item(
                code=f"spatiotemporal.normalised.{name}.{side}",
                words=f"{label(name)}, dimensionless, {side}",
                value={"valueQuantity": _quantity(value, "1")},
                side=side,
                method="with leg length l: v / sqrt(g l), f / sqrt(g / l), x / l, t / sqrt(l / g) (Hof 1996)",
            )


def _expected(value: ReferenceValue | None, unit: str, reference: ReferenceEntry) -> Json | None:
    if value is None:
        return None
    low, high = (_quantity(value.mean + sign * value.sd, unit) for sign in (-1.0, 1.0))
    return {"low": low, "high": high, "text": f"mean ± 1 SD of {reference.description}"}


def _curves(document: Document, side: Side, stride_time: float | None) -> Iterator[Item]:
    """Mean curves of a side; samples need a period, so there is none without a stride time."""
    if stride_time is None:
        return
    angles = {name: getattr(sides, side) for name in CURVES if (sides := document.kinematics.get(name)) is not None}
    for name, curve in angles.items():
        if curve is not None:
            yield _curve(f"kinematics.{name}.{side}", side, curve, ("deg", stride_time, ""))
    kinetics = document.kinetics
    for name, unit in UNITS.items() if kinetics is not None else ():
        sides = None if kinetics is None else kinetics.curves.get(name)
        curve = None if sides is None else getattr(sides, side)
        if kinetics is not None and curve is not None:
            frame = f"; internal, in {kinetics.moments_in}" if name.endswith("moment") else ""
            yield _curve(f"kinetics.{name}.{side}", side, curve, (unit, stride_time, frame))


def _curve(code: str, side: Side, curve: Curve | CycleAverage, how: tuple[str, float, str]) -> Item:
    unit, stride_time, frame = how
    name = code.split(".")[1]
    direction = _DIRECTIONS.get(name, f"positive: {name.replace('_', ' ')}")
    return Item(
        code=code,
        words=f"{name.replace('_', ' ')} over the gait cycle, {side}",
        value={"valueSampledData": _samples(curve.mean, unit, stride_time)},
        side=side,
        method=f"mean of the cycles, 0 to 100 % in 101 samples; the period is that of the mean stride; "
        f"{direction}{frame}",
        components=[
            _component("standard-deviation", {"valueSampledData": _samples(curve.sd, unit, stride_time)}),
            *_spread(None, unit, curve.n_cycles),
        ],
    )


def _samples(values: Sequence[float | None], unit: str, stride_time: float) -> Json:
    written = " ".join("E" if value is None else f"{value:.{_DIGITS}f}" for value in values)
    period = 1000.0 * stride_time / (len(values) - 1)  # [ms]
    return {"origin": _quantity(0.0, unit), "period": period, "dimensions": 1, "data": written}


def _scores(document: Document) -> Iterator[Item]:
    scores = document.scores
    if scores is None:
        return
    against = "" if scores.reference is None else f"against {scores.reference.description}; Baker et al. 2009"
    for side, own in (("left", scores.left), ("right", scores.right)):
        if own is not None:
            yield from _side_scores(side, own, against, scores.gdi_reference)
    if scores.gps_overall is not None:
        value = {"valueQuantity": _quantity(scores.gps_overall, "deg")}
        yield Item(code="gps.overall", words="gait profile score, overall", value=value, method=against)


def _side_scores(side: str, own: SideScores, against: str, basis: str) -> Iterator[Item]:
    for name, value in own.gvs.items():
        yield Item(
            code=f"gvs.{name}.{side}",
            words=f"gait variable score, {name.replace('_', ' ')}, {side}",
            value={"valueQuantity": _quantity(value, "deg")},
            side=side,
            method=against,
        )
    if own.gps is not None:
        yield Item(
            code=f"gps.{side}",
            words=f"gait profile score, {side}",
            value={"valueQuantity": _quantity(own.gps, "deg")},
            side=side,
            method=against,
            components=_spread(own.gps_sd, "deg", own.n_cycles),
        )
    if own.gdi is not None:
        yield Item(
            code=f"gdi.{side}",
            words=f"gait deviation index, {side}",
            value={"valueQuantity": _quantity(own.gdi, "1")},
            side=side,
            method=f"basis: {basis}; Schwartz & Rozumalski 2008",
        )


def _weights(weights: WeightsEntry) -> Iterator[Item]:
    settled = weights.solver.status == "solved"
    state = "" if settled else f"Not converged ({weights.solver.status}): this is the last iterate, not a result. "
    for criterion in weights.criteria:
        unknown = "" if criterion.identifiable else "Not identifiable from this recording: not to be read. "
        yield Item(
            code=f"criterion-weight.{criterion.name}",
            words=f"weight of the criterion {spoken(criterion.name)}",
            value={"valueQuantity": _quantity(criterion.weight, "1")},
            method="inverse optimal control; criteria divided by their values on the tracked walk, weights sum to one",
            components=_spread(criterion.sd, "1"),
            note=f"{state}{unknown}{CAVEAT}",
            settled=settled,
        )
