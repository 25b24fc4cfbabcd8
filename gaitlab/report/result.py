"""`result.json` as a reader sees it: whatever is absent or of another type reads as missing, never as an error."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

import numpy as np

from ..clinical.cycle_average import N_SAMPLES
from ..clinical.document import SIDES
from ..errors import OutputError
from ..mocap.recording import Event, EventKind, Side

_SIDES: Mapping[object, Side] = {side: side for side in SIDES}
_KINDS: Mapping[object, EventKind] = {"foot_strike": "foot_strike", "foot_off": "foot_off"}
SOLVED = "solved"
"""The solver state that certifies a result; every other state marks the report."""


@dataclass(frozen=True, kw_only=True)
class Criterion:
    """Weight of one criterion of the model's cost; None where the document says nothing."""

    name: str
    weight: float | None
    """Normalised by the criterion's value on the tracked gait; the weights sum to one."""
    sd: float | None
    identifiable: bool
    raw: float | None
    share: float | None
    """Share of the optimal cost."""
    at_bound: bool
    """Whether the weight is zero because weights cannot be negative."""


@dataclass(frozen=True, kw_only=True)
class Weights:
    """What the upper level found, or how far it came."""

    criteria: tuple[Criterion, ...]
    correlation: np.ndarray | None
    """Correlation of the weights' estimates, shape (n_criteria, n_criteria)."""
    fit_rms: float | None
    """Root mean square of model-optimal minus measured coordinates [rad]."""
    per_joint: Mapping[str, float]
    """The same per joint [rad]."""
    comparison: Mapping[str, float]
    """The same with other weights [rad]: `equal weights`, and each criterion alone."""
    solver: Mapping[str, object]
    document: Mapping[str, object]
    """All of `weights`, as the document has it."""

    @property
    def status(self) -> str:
        """What the solver said, in lower case; empty if it said nothing."""
        return str(self.solver.get("status") or "").lower()

    @property
    def converged(self) -> bool:
        """Whether the weights carry a certificate."""
        return self.status == SOLVED


@dataclass(frozen=True, kw_only=True)
class Curve:
    """One quantity over the gait cycle, 0 to 100 % in 101 samples, NaN where missing."""

    mean: np.ndarray
    """Mean over the cycles, shape (101,); angles in deg."""
    sd: np.ndarray | None
    """Standard deviation, shape (101,); None with fewer than two cycles."""
    n_cycles: int | None


@dataclass(frozen=True, kw_only=True)
class Result:
    """One trial, or the overall document of several."""

    name: str
    document: Mapping[str, object]
    """The whole of result.json."""
    events: tuple[Event, ...]
    kinematics: Mapping[str, Mapping[str, Curve]]
    """Curve name to side to its average cycle."""
    weights: Weights | None
    kinetics: Mapping[str, Mapping[str, Curve]] = field(default_factory=dict[str, Mapping[str, Curve]])
    """Moments, powers and ground reactions by name, to side, in their units."""
    emg: Mapping[str, Mapping[str, Curve]] = field(default_factory=dict[str, Mapping[str, Curve]])
    """Envelopes by label, to side, in the file's unit."""

    def part(self, key: str) -> Mapping[str, object]:
        """Object under `key`; empty if absent."""
        return mapping(self.document.get(key))

    def parts(self, key: str) -> list[object]:
        """List under `key`; empty if absent."""
        return sequence(self.document.get(key))

    @property
    def warnings(self) -> list[str]:
        """Warnings as sentences."""
        return [as_words(warning) for warning in self.parts("warnings")]

    @property
    def mass(self) -> float | None:
        """Body mass [kg]."""
        return first_real(self.part("subject"), ("mass_kg",))


def mapping(value: object) -> Mapping[str, object]:
    """`value` if it is a JSON object, otherwise an empty one."""
    return cast("Mapping[str, object]", value) if isinstance(value, dict) else {}


def sequence(value: object) -> list[object]:
    """`value` if it is a JSON list, otherwise an empty one."""
    return cast("list[object]", value) if isinstance(value, list) else []


def real(value: object) -> float | None:
    """`value` if it is a finite number, otherwise None."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if np.isfinite(value) else None


def first_real(values: Mapping[str, object], keys: Sequence[str]) -> float | None:
    """First finite number found under one of `keys`."""
    return next((number for number in (real(values.get(key)) for key in keys) if number is not None), None)


def reals(value: object) -> dict[str, float]:
    """Those members of a JSON object that are finite numbers."""
    pairs = ((key, real(member)) for key, member in mapping(value).items())
    return {key: number for key, number in pairs if number is not None}


def as_words(value: object) -> str:
    """A JSON value as words: an object's `message` or its members, a string as it is."""
    members = mapping(value)
    if "message" in members:
        return str(members["message"])
    return "; ".join(f"{key}: {member}" for key, member in members.items()) if members else str(value)


def _criterion(value: object) -> Criterion:
    members = mapping(value)
    return Criterion(
        name=str(members.get("name", "unnamed")),
        weight=first_real(members, ("weight",)),
        sd=first_real(members, ("sd",)),
        identifiable=members.get("identifiable") is not False,
        raw=first_real(members, ("raw_weight",)),
        share=first_real(members, ("cost_share",)),
        at_bound=members.get("at_bound") is True,
    )


def _square(value: object, size: int) -> np.ndarray | None:
    rows = [[real(cell) for cell in sequence(row)] for row in sequence(value)]
    if len(rows) != size or any(len(row) != size for row in rows) or size == 0:
        return None
    return np.array([[np.nan if cell is None else cell for cell in row] for row in rows])


def _comparison(members: Mapping[str, object]) -> dict[str, float]:
    """Fit [rad] with equal weights and with each criterion alone."""
    comparison = mapping(members.get("comparison"))
    equal = first_real(comparison, ("equal_weights_rms_rad",))
    single = reals(comparison.get("single_criterion_rms_rad"))
    return ({} if equal is None else {"equal weights": equal}) | {f"only {name}": rms for name, rms in single.items()}


def _weights(value: object) -> Weights | None:
    members = mapping(value)
    if not members:
        return None
    criteria = tuple(_criterion(item) for item in sequence(members.get("criteria")))
    fit = mapping(members.get("fit"))
    return Weights(
        criteria=criteria,
        correlation=_square(members.get("correlation"), len(criteria)),
        fit_rms=first_real(fit, ("rms_rad",)),
        per_joint=reals(fit.get("per_joint")),
        comparison=_comparison(members),
        solver=mapping(members.get("solver")),
        document=members,
    )


def _samples(value: object) -> np.ndarray | None:
    numbers = [real(sample) for sample in sequence(value)]
    if len(numbers) != N_SAMPLES:
        return None
    return np.array([np.nan if number is None else number for number in numbers])


def curve_of(value: object) -> Curve | None:
    """A curve of the document; None when it has not 101 samples or none is known."""
    members = mapping(value) or {"mean": value}
    mean, sd = _samples(members.get("mean")), _samples(members.get("sd"))
    if mean is None or not np.any(np.isfinite(mean)):
        return None
    spread = sd if sd is not None and np.any(np.isfinite(sd)) else None
    n_cycles = real(members.get("n_cycles"))
    return Curve(mean=mean, sd=spread, n_cycles=None if n_cycles is None else int(n_cycles))


def _curves(value: object) -> dict[str, dict[str, Curve]]:
    curves = dict[str, dict[str, Curve]]()
    for name, sides in mapping(value).items():
        read = {side: curve_of(mapping(sides).get(side)) for side in SIDES}
        curves[name] = {side: curve for side, curve in read.items() if curve is not None}
    return curves


def _events(values: list[object]) -> tuple[Event, ...]:
    events = list[Event]()
    for value in values:
        members = mapping(value)
        time = first_real(members, ("time_s",))
        side, kind = _SIDES.get(str(members.get("side"))), _KINDS.get(str(members.get("kind")))
        if time is not None and side is not None and kind is not None:
            source = "file" if members.get("source") == "file" else "detected"
            events.append(Event(side=side, kind=kind, time=time, source=source))
    return tuple(events)


def _name(inputs: list[object], directory: Path) -> str:
    """File stem of the walk, or the directory's name if there is not exactly one walk."""
    walks = [str(mapping(item).get("name")) for item in inputs if mapping(item).get("role") == "walk"]
    return Path(walks[0]).stem if len(walks) == 1 else directory.resolve().name


def read_result(directory: Path) -> Result:
    """Read `result.json` of an output directory.

    Raises:
        OutputError: the file is absent or is no JSON object.
    """
    path = directory / "result.json"
    if not path.is_file():
        raise OutputError(f"{directory} has no result.json; give the directory that 'gaitlab analyse --out' wrote")
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} is not readable JSON ({error}); run 'gaitlab analyse' again") from error
    if not isinstance(document, dict):
        raise OutputError(f"{path} holds no JSON object; run 'gaitlab analyse' again")
    members = mapping(document)
    return Result(
        name=_name(sequence(members.get("inputs")), directory),
        document=members,
        events=_events(sequence(members.get("events"))),
        kinematics=_curves(members.get("kinematics")),
        kinetics=_curves(mapping(members.get("kinetics")).get("curves")),
        emg=_curves(mapping(members.get("emg")).get("envelopes")),
        weights=_weights(members.get("weights")),
    )


def trial_directories(directory: Path) -> tuple[Path, ...]:
    """Directories of the single trials of an output directory, in order of name; itself if there is but one trial."""
    inside = tuple(sorted(path.parent for path in directory.glob("*/result.json")))
    return inside or (directory,)
