"""Any number of results side by side: tables, differences beside minimal differences, bands of groups.

Works on every document of the contract, whatever made it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import NotFound, ProblemError
from .document import CURVES, SIDES, Curve, Document, SideSpatiotemporal
from .gait_profile import GPS_MINIMAL_DIFFERENCE
from .kinetics_document import UNITS, CycleAverage
from .spatiotemporal import Spatiotemporal

Cell = str | float | int | bool | None
CycleCurve = Curve | CycleAverage


@dataclass(frozen=True, kw_only=True)
class MinimalDifference:
    """Smallest difference that matters to patients, with its source."""

    value: float
    source: str


MINIMAL: Mapping[str, MinimalDifference] = {
    name: MinimalDifference(value=GPS_MINIMAL_DIFFERENCE, source="Baker et al., Gait Posture 35:612, 2012")
    for name in ("gps", "gps_overall")
}
"""By quantity; more may be given where they are published for the patients at hand."""


@dataclass(frozen=True, kw_only=True)
class Member:
    """One result."""

    label: str
    group: str
    document: Document


@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows of cells, as written to a file; None is unknown."""

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One number of one side of one result."""

    name: str
    side: str
    """left, right or empty for the whole person."""
    value: float
    sd: float | None
    """Between the cycles; None with one cycle or where it has no meaning."""


@dataclass(frozen=True, kw_only=True)
class Band:
    """Point-by-point mean and standard deviation between the results of a group."""

    mean: np.ndarray
    """Mean in the curve's unit, shape (101,)."""
    sd: np.ndarray | None
    """Sample standard deviation in the curve's unit, shape (101,); None with one result, then of its cycles where it
    has them."""
    n: int


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """All results with a baseline."""

    members: tuple[Member, ...]
    baseline: str
    """Label of the result that the others are compared with."""
    minimal: Mapping[str, MinimalDifference]

    def groups(self) -> dict[str, tuple[Member, ...]]:
        """Members by group, in the order given."""
        names = dict.fromkeys(member.group for member in self.members)
        return {name: tuple(m for m in self.members if m.group == name) for name in names}


def compare(
    members: Sequence[Member], baseline: str = "", minimal: Mapping[str, MinimalDifference] = MINIMAL
) -> Comparison:
    """Put results side by side.

    Args:
        members: Results with labels of their own.
        baseline: Label of the one that differences are taken from; empty: the first.
        minimal: Minimal clinically important differences by quantity.

    Raises:
        ProblemError: There is no result, or two have the same label.
        NotFound: No result has the label of the baseline.
    """
    labels = [member.label for member in members]
    if not labels:
        raise ProblemError("nothing to compare: give at least one folder with a result.json")
    twice = sorted({label for label in labels if labels.count(label) > 1})
    if twice:
        raise ProblemError(f"two results are called {twice[0]}: give each folder a name of its own")
    if baseline and baseline not in labels:
        raise NotFound("result", baseline, labels)
    return Comparison(members=tuple(members), baseline=baseline or labels[0], minimal=minimal)


def quantities(document: Document) -> list[Quantity]:
    """Distances, times and scores of a result; its weights are in a table of their own."""
    return [*_distances(document), *_scores(document)]


def _distances(document: Document) -> Iterator[Quantity]:
    for side in SIDES:
        entry: SideSpatiotemporal | None = getattr(document.spatiotemporal, side)
        if entry is None:
            continue
        for name in Spatiotemporal.__struct_fields__:
            value = getattr(entry.mean, name)
            if value is not None:
                yield Quantity(name=name, side=side, value=value, sd=getattr(entry.sd, name))


def _scores(document: Document) -> Iterator[Quantity]:
    if document.scores is None:
        return
    for side in SIDES:
        scores = document.scores.left if side == "left" else document.scores.right
        if scores is None:
            continue
        for name, value in scores.gvs.items():
            yield Quantity(name=f"gvs_{name}", side=side, value=value, sd=None)
        if scores.gps is not None:
            yield Quantity(name="gps", side=side, value=scores.gps, sd=scores.gps_sd)
        if scores.gdi is not None:
            yield Quantity(name="gdi", side=side, value=scores.gdi, sd=None)
    if document.scores.gps_overall is not None:
        yield Quantity(name="gps_overall", side="", value=document.scores.gps_overall, sd=None)


def tables(comparison: Comparison) -> dict[str, Table]:
    """All tables by name: quantities, weights, curves, bands, missing."""
    return {
        "quantities": _quantity_table(comparison),
        "weights": _weight_table(comparison),
        "curves": _curve_table(comparison),
        "bands": _band_table(comparison),
        "missing": _missing_table(comparison),
    }


def _quantity_table(comparison: Comparison) -> Table:
    columns = ("result", "group", "quantity", "side", "value", "sd", "difference", "minimal_difference")
    base_member = next(member for member in comparison.members if member.label == comparison.baseline)
    base = {(q.name, q.side): q.value for q in quantities(base_member.document)}
    judged_by = _judged_by(base_member.document)
    rows: list[tuple[Cell, ...]] = []
    for member in comparison.members:
        for q in quantities(member.document):
            same = not _is_score(q.name) or _judged_by(member.document) == judged_by
            start = base.get((q.name, q.side)) if same else None
            known = comparison.minimal.get(q.name)
            difference = None if start is None else q.value - start
            least = None if known is None else known.value
            reached = None if difference is None or least is None else abs(difference) >= least
            source = "" if known is None else known.source
            head = (member.label, member.group, q.name, q.side, q.value, q.sd)
            rows.append((*head, difference, least, reached, source))
    return Table(columns=(*columns, "reaches_minimal_difference", "source"), rows=tuple(rows))


def _is_score(name: str) -> bool:
    return name.startswith(("gvs_", "gps", "gdi"))


def _judged_by(document: Document) -> tuple[str, str]:
    """What scores refer to: scores of different references have no difference."""
    scores = document.scores
    if scores is None:
        return "", ""
    return "" if scores.reference is None else scores.reference.description, scores.gdi_reference


def _weight_table(comparison: Comparison) -> Table:
    columns = ("result", "group", "criterion", "weight", "sd", "cost_share", "identifiable", "at_bound", "status")
    rows = [
        (m.label, m.group, c.name, c.weight, c.sd, c.cost_share, c.identifiable, c.at_bound, weights.solver.status)
        for m in comparison.members
        if (weights := m.document.weights) is not None
        for c in weights.criteria
    ]
    return Table(columns=columns, rows=tuple(rows))


def _curve_table(comparison: Comparison) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for member in comparison.members:
        for name, side, curve in document_curves(member.document):
            head = (member.label, member.group, name, side, unit_of_curve(name))
            rows.append((*head, "mean", curve.n_cycles, *curve.mean))
            rows.append((*head, "sd", curve.n_cycles, *curve.sd))
    columns = ("result", "group", "curve", "side", "unit", "statistic", "n_cycles", *_percents())
    return Table(columns=columns, rows=tuple(rows))


def _band_table(comparison: Comparison) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for group, members in comparison.groups().items():
        for (name, side), band in group_bands(members).items():
            head = (group, name, side, unit_of_curve(name))
            rows.append((*head, "mean", band.n, *band.mean.tolist()))
            if band.sd is not None:
                rows.append((*head, "sd", band.n, *band.sd.tolist()))
    columns = ("group", "curve", "side", "unit", "statistic", "n_results", *_percents())
    return Table(columns=columns, rows=tuple(rows))


def _missing_table(comparison: Comparison) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for member in comparison.members:
        document = member.document
        sentences = [] if document.scores is None else document.scores.missing
        rows += [(member.label, member.group, "scores", sentence) for sentence in sentences]
        base = next(m.document for m in comparison.members if m.label == comparison.baseline)
        if _judged_by(document) != _judged_by(base):
            why = f"other references than {comparison.baseline} has"
            rows.append((member.label, member.group, "differences of scores", why))
        if document.scores is None:
            rows.append((member.label, member.group, "scores", "the result holds none"))
        if document.kinetics is None or not document.kinetics.curves:
            reasons = [] if document.kinetics is None else document.kinetics.missing
            rows.append((member.label, member.group, "kinetics", "; ".join(reasons) or "the result holds none"))
        if document.weights is None:
            rows.append((member.label, member.group, "weights", "the result holds none"))
    return Table(columns=("result", "group", "what", "why"), rows=tuple(rows))


def _percents() -> tuple[str, ...]:
    return tuple(f"p{percent}" for percent in range(101))


def document_curves(document: Document) -> Iterator[tuple[str, str, CycleCurve]]:
    """Every curve of a result with its name and side: angles, then moments, powers and ground reactions."""
    forces = {} if document.kinetics is None else document.kinetics.curves
    for name in (*CURVES, *UNITS):
        sides = document.kinematics.get(name) or forces.get(name)
        for side in SIDES:
            curve: CycleCurve | None = None if sides is None else getattr(sides, side)
            if curve is not None:
                yield name, side, curve


def unit_of_curve(name: str) -> str:
    """Unit of a curve of a result: deg for angles."""
    return UNITS.get(name, "deg")


def group_bands(members: Sequence[Member]) -> dict[tuple[str, str], Band]:
    """Band of each curve and side over the results of a group; a single result brings the spread of its cycles."""
    gathered: dict[tuple[str, str], list[CycleCurve]] = {}
    for member in members:
        for name, side, curve in document_curves(member.document):
            if None not in curve.mean:
                gathered.setdefault((name, side), []).append(curve)
    return {key: _band(curves) for key, curves in gathered.items()}


def _band(curves: Sequence[CycleCurve]) -> Band:
    stacked = np.array([curve.mean for curve in curves], dtype=float)
    if len(stacked) > 1:
        return Band(mean=stacked.mean(axis=0), sd=stacked.std(axis=0, ddof=1), n=len(stacked))
    own = np.array(curves[0].sd, dtype=float)
    return Band(mean=stacked[0], sd=own if np.all(np.isfinite(own)) else None, n=1)
