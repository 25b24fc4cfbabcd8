"""Measurements: functions that yield rows of evidence for one "Must hold" line of an issue."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent
SHARED_DATA = ROOT.parent / "shared" / "data"
CHILDREN = ("HC002D", "HC030A", "HC032A", "HC033A", "HC040A", "HC050A")


@dataclass(frozen=True, kw_only=True)
class Row:
    """One number."""

    quantity: str
    value: float
    limit: str
    """What must hold, for instance "<= 0.1"; empty for a number that is only reported."""
    unit: str
    subject: str
    """Child, file or case that the number belongs to."""


Measure = Callable[[], Iterable[Row]]


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """A function with the issue and the line that it gives evidence for."""

    issue: int
    line: int
    name: str
    measure: Measure


MEASUREMENTS: list[Measurement] = []


def measurement(issue: int, line: int) -> Callable[[Measure], Measure]:
    """Register a function that yields rows: `@measurement(issue=2, line=1)`."""

    def register(measure: Measure) -> Measure:
        MEASUREMENTS.append(Measurement(issue=issue, line=line, name=measure.__name__, measure=measure))
        return measure

    return register


def holds(row: Row) -> bool | None:
    """Whether the value keeps its limit; None where there is no limit."""
    if not row.limit:
        return None
    relation, bound = row.limit.split()
    return row.value <= float(bound) if relation == "<=" else row.value >= float(bound)
