"""A reference cohort from a laboratory's own results of able-bodied people."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..errors import InvalidReference
from .document import CURVES, SIDES, Curve, CurveSides, Document
from .gait_profile import gait_profile
from .kinetics_document import UNITS, CycleAverage, UnitCurve
from .normative import ReferenceBand, ReferenceCohort, ReferenceValue, SpeedBin, band_of, value_of
from .spatiotemporal import NormalisedSpatiotemporal, Spatiotemporal

FEWEST = 2
"""Persons of a speed bin; fewer have no standard deviation."""


@dataclass(frozen=True, kw_only=True)
class CohortSettings:
    """What the results do not say themselves."""

    name: str
    source: str
    licence: str = "own data of the laboratory"
    population: str = "able-bodied"
    age_years: tuple[float, float] | None = None
    speed_edges: tuple[float, ...] = ()
    """Dimensionless speeds v / sqrt(g l) between the bins, ascending; empty: one bin."""


@dataclass(frozen=True, kw_only=True)
class _Person:
    """Means of both sides."""

    curves: dict[str, np.ndarray]
    """Name to mean of the sides [deg], shapes (101,)."""
    kinetics: dict[str, np.ndarray]
    """The same of moments, powers and ground reactions, in their units, shapes (101,)."""
    sides: tuple[dict[str, np.ndarray], ...]
    """The same of each side, shapes (101,)."""
    spatiotemporal: dict[str, float]
    normalised: dict[str, float]
    weights: dict[str, float]
    """Of the criteria; empty unless they are certified."""


def build_cohort(documents: Sequence[Document], settings: CohortSettings) -> tuple[ReferenceCohort, tuple[str, ...]]:
    """Mean and standard deviation between persons, both sides of a person averaged first.

    Args:
        documents: One result per person.
        settings: Name, source and speed bins.

    Returns:
        The cohort, and sentences on what was left out.

    Raises:
        InvalidReference: No bin holds two persons.
    """
    if list(settings.speed_edges) != sorted(set(settings.speed_edges)):
        raise InvalidReference("edges of the speed bins must ascend")
    people = [_person(document) for document in documents]
    bins: list[SpeedBin] = []
    notes: list[str] = []
    for low, high in pairwise((-np.inf, *settings.speed_edges, np.inf)):
        name = _bin_name(low, high)
        members = [person for person in people if _belongs(person, low, high)]
        if len(members) < FEWEST:
            notes.append(f"speed bin '{name}' left out: {len(members)} of the {FEWEST} persons that a band needs")
        else:
            bins.append(_bin(name, members))
    unknown = sum("speed" not in person.normalised for person in people)
    if settings.speed_edges and unknown:
        notes.append(f"{unknown} persons left out: no leg length, hence no dimensionless speed")
    if not bins:
        raise InvalidReference(f"no norms could be built from {len(documents)} results: {'; '.join(notes)}")
    largest = max(bins, key=lambda part: part.n)
    cohort = ReferenceCohort(
        name=settings.name,
        source=settings.source,
        licence=settings.licence,
        population=settings.population,
        age_years=settings.age_years,
        default_bin=largest.name,
        bins=bins,
    )
    return cohort, tuple(notes)


def _belongs(person: _Person, low: float, high: float) -> bool:
    if np.isinf(low) and np.isinf(high):
        return True
    return "speed" in person.normalised and low <= person.normalised["speed"] < high


def _bin_name(low: float, high: float) -> str:
    if np.isinf(low) and np.isinf(high):
        return "all speeds"
    if np.isinf(low):
        return f"below {high:g}"
    return f"from {low:g}" if np.isinf(high) else f"{low:g} to {high:g}"


def _person(document: Document) -> _Person:
    sides = tuple(_side_curves(document.kinematics, side) for side in SIDES)
    forces = tuple(_side_curves({} if document.kinetics is None else document.kinetics.curves, s) for s in SIDES)
    entries = [entry for entry in (document.spatiotemporal.left, document.spatiotemporal.right) if entry is not None]
    return _Person(
        curves=_mean_of_sides(sides, CURVES),
        kinetics=_mean_of_sides(forces, tuple(UNITS)),
        sides=sides,
        spatiotemporal=_means([entry.mean for entry in entries]),
        normalised=_means([entry.normalised for entry in entries]),
        weights=_certified_weights(document),
    )


def _certified_weights(document: Document) -> dict[str, float]:
    found = document.weights
    solved = found is not None and found.solver.status == "solved"
    return {criterion.name: criterion.weight for criterion in found.criteria} if found is not None and solved else {}


def _mean_of_sides(sides: Sequence[Mapping[str, np.ndarray]], names: Sequence[str]) -> dict[str, np.ndarray]:
    known = {name: [side[name] for side in sides if name in side] for name in names}
    return {name: np.mean(values, axis=0) for name, values in known.items() if values}


def _side_curves(curves: Mapping[str, CurveSides | UnitCurve], side: str) -> dict[str, np.ndarray]:
    found: dict[str, np.ndarray] = {}
    for name, sides in curves.items():
        curve: Curve | CycleAverage | None = getattr(sides, side)
        if curve is not None and None not in curve.mean:
            found[name] = np.array(curve.mean, dtype=float)
    return found


def _means(entries: Sequence[Spatiotemporal | NormalisedSpatiotemporal]) -> dict[str, float]:
    names = entries[0].__struct_fields__ if entries else ()
    values = {name: [v for entry in entries if (v := getattr(entry, name)) is not None] for name in names}
    return {name: float(np.mean(known)) for name, known in values.items() if known}


def _bin(name: str, people: Sequence[_Person]) -> SpeedBin:
    curves = _bands([person.curves for person in people])
    speeds = [person.normalised["speed"] for person in people if "speed" in person.normalised]
    means = {curve: np.array(band.mean) for curve, band in curves.items()}
    profiles = [gait_profile(side, means) for person in people for side in person.sides]
    scores = {curve: [p.gvs[curve] for p in profiles if curve in p.gvs] for curve in CURVES}
    totals = [profile.gps for profile in profiles if profile.gps is not None]
    return SpeedBin(
        name=name,
        n=len(people),
        speed=value_of(speeds) if len(speeds) >= FEWEST else None,
        speed_range=(min(speeds), max(speeds)) if speeds else None,
        curves=curves,
        kinetics=_bands([person.kinetics for person in people]),
        spatiotemporal=_values([person.spatiotemporal for person in people]),
        normalised=_values([person.normalised for person in people]),
        gvs={curve: value_of(values) for curve, values in scores.items() if len(values) >= FEWEST},
        gps=value_of(totals) if len(totals) >= FEWEST else None,
        weights=_values(_same_criteria(people)),
    )


def _same_criteria(people: Sequence[_Person]) -> list[dict[str, float]]:
    """Weights of those persons who share the most frequent choice of criteria; others cannot be averaged with them."""
    choices = Counter(frozenset(person.weights) for person in people if person.weights)
    if not choices:
        return []
    most = choices.most_common(1)[0][0]
    return [person.weights for person in people if frozenset(person.weights) == most]


def _bands(people: Sequence[dict[str, np.ndarray]]) -> dict[str, ReferenceBand]:
    names = dict.fromkeys(name for person in people for name in person)
    gathered = {name: [person[name] for person in people if name in person] for name in names}
    return {name: band_of(values) for name, values in gathered.items() if len(values) >= FEWEST}


def _values(people: Sequence[dict[str, float]]) -> dict[str, ReferenceValue]:
    names = dict.fromkeys(name for person in people for name in person)
    known = {name: [person[name] for person in people if name in person] for name in names}
    return {name: value_of(values) for name, values in known.items() if len(values) >= FEWEST}
