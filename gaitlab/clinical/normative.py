"""Reference cohorts: what able-bodied people of some age do at some speed, and how a person finds their bin."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from ..errors import InvalidReference, OutputError
from .cycle_average import N_SAMPLES

FORMAT = "gaitlab-norms-1"
SpeedChoice = Literal["default", "matched"]
"""Bin of the cohort's own comfortable speed, or the bin nearest to the person's dimensionless speed."""


class ReferenceBand(msgspec.Struct, frozen=True, kw_only=True):
    """Mean and standard deviation between persons of one curve, 0 to 100 % of the cycle, 101 samples each."""

    mean: list[float]
    sd: list[float]


class ReferenceValue(msgspec.Struct, frozen=True, kw_only=True):
    """Mean and standard deviation between persons of one number."""

    mean: float
    sd: float


class SpeedBin(msgspec.Struct, frozen=True, kw_only=True):
    """The part of a cohort that walked at one speed."""

    name: str
    n: int
    """Persons."""
    speed: ReferenceValue | None = None
    """Dimensionless, v / sqrt(g l) with leg length l."""
    speed_range: tuple[float, float] | None = None
    """Slowest and fastest walk of the bin, dimensionless."""
    curves: dict[str, ReferenceBand]
    """The nine angles [deg]."""
    kinetics: dict[str, ReferenceBand] = {}
    """By the names and in the units of `clinical.kinetics_document.UNITS`."""
    emg: dict[str, ReferenceBand] = {}
    """Envelopes by muscle (`mocap.emg.MUSCLES`), part of a maximum."""
    spatiotemporal: dict[str, ReferenceValue] = {}
    """By the names of `clinical.spatiotemporal.Spatiotemporal`."""
    normalised: dict[str, ReferenceValue] = {}
    """By the names of `clinical.spatiotemporal.NormalisedSpatiotemporal`."""
    gvs: dict[str, ReferenceValue] = {}
    """Gait variable scores of the cohort's own persons [deg]: how far one of them is from their mean."""
    gps: ReferenceValue | None = None
    weights: dict[str, ReferenceValue] = {}
    """Weights of the criteria, all of one choice of criteria; empty where fewer than two persons have some."""


class ReferenceCohort(msgspec.Struct, frozen=True, kw_only=True):
    """A cohort with its origin; `read_cohort` and `write_cohort` keep it in a JSON file."""

    format: Literal["gaitlab-norms-1"] = FORMAT
    name: str
    source: str
    """Publication or laboratory, in words."""
    licence: str
    population: str = ""
    age_years: tuple[float, float] | None = None
    """Youngest and oldest; null where not known."""
    age_words: str = ""
    """Printed instead of the ages, where the source at hand does not state them in years."""
    default_bin: str
    bins: list[SpeedBin]

    def bin(self, name: str) -> SpeedBin:
        """The bin of that name.

        Raises:
            InvalidReference: There is none.
        """
        found = next((part for part in self.bins if part.name == name), None)
        if found is None:
            raise InvalidReference(
                f"norms {self.name}: no speed bin '{name}'; available: {', '.join(part.name for part in self.bins)}"
            )
        return found


def read_cohort(path: Path) -> ReferenceCohort:
    """Read and check a cohort.

    Raises:
        InvalidReference: The file is absent, is no cohort, or holds curves that no cohort can have.
    """
    try:
        cohort = msgspec.json.decode(path.read_bytes(), type=ReferenceCohort)
    except OSError as error:
        raise InvalidReference(f"norms {path.name} cannot be read ({error.strerror})") from error
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise InvalidReference(f"norms {path.name} is not a gaitlab reference cohort: {error}") from error
    _check(cohort, path.name)
    return cohort


def write_cohort(cohort: ReferenceCohort, path: Path) -> None:
    """Write a cohort as JSON; the same cohort gives the same bytes."""
    try:
        path.write_bytes(msgspec.json.encode(cohort) + b"\n")
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def _check(cohort: ReferenceCohort, name: str) -> None:
    if not cohort.bins:
        raise InvalidReference(f"norms {name} holds no speed bin")
    cohort.bin(cohort.default_bin)
    for part in cohort.bins:
        if part.n < 1 or not part.curves:
            raise InvalidReference(f"norms {name}, bin {part.name}: no persons or no curves")
        for curve, band in (part.curves | part.kinetics | part.emg).items():
            _check_band(band, f"norms {name}, bin {part.name}, {curve}")


def _check_band(band: ReferenceBand, where: str) -> None:
    if len(band.mean) != N_SAMPLES or len(band.sd) != N_SAMPLES:
        raise InvalidReference(f"{where}: {N_SAMPLES} samples of mean and of sd are needed")
    if not np.all(np.isfinite(band.mean)) or not np.all(np.isfinite(band.sd)) or min(band.sd) < 0.0:
        raise InvalidReference(f"{where}: not all samples are finite, or an sd is negative")


def age_problem(cohort: ReferenceCohort, age: float | None) -> str:
    """Why this cohort says nothing about a person of that age [years]; empty when it does or an age is unknown."""
    if age is None or cohort.age_years is None:
        return ""
    low, high = cohort.age_years
    if low <= age < high + 1.0:
        return ""
    held = cohort.age_words or f"{low:g} to {high:g} years"
    return f"no norms for this age: {cohort.name} holds {held}, this person is {age:g}"


def choose_bin(cohort: ReferenceCohort, choice: SpeedChoice, speed: float | None) -> tuple[SpeedBin, str]:
    """The bin to compare with, and what to say when it is not the one asked for.

    Args:
        cohort: The cohort.
        choice: Which bin is asked for.
        speed: The person's dimensionless speed, v / sqrt(g l); None when unknown.
    """
    default = cohort.bin(cohort.default_bin)
    if choice == "default":
        return default, ""
    known = [(part, part.speed.mean) for part in cohort.bins if part.speed is not None]
    if speed is None or not known:
        what = "the person's dimensionless speed" if speed is None else f"the speed of the bins of {cohort.name}"
        return default, f"norms at bin '{default.name}': {what} is not known, so no speed could be matched"
    return min(known, key=lambda item: abs(item[1] - speed))[0], ""


def band_of(curves: Sequence[np.ndarray]) -> ReferenceBand:
    """Mean and sample standard deviation of persons' curves, any unit, shape (101,) each, two at least."""
    stacked = np.array(curves)
    return ReferenceBand(mean=stacked.mean(axis=0).tolist(), sd=stacked.std(axis=0, ddof=1).tolist())


def value_of(values: Sequence[float]) -> ReferenceValue:
    """Mean and sample standard deviation of persons' numbers, two at least."""
    return ReferenceValue(mean=float(np.mean(values)), sd=float(np.std(values, ddof=1)))


def describe(cohort: ReferenceCohort, part: SpeedBin) -> str:
    """Source, n, age and speed of a band, as printed beside it."""
    years = "" if cohort.age_years is None else f"{cohort.age_years[0]:g}-{cohort.age_years[1]:g} years"
    age = cohort.age_words or years or "age not stated"
    speed = "" if part.speed is None else f" ({part.speed.mean:.2f} ± {part.speed.sd:.2f} of sqrt(g leg length))"
    return f"{cohort.name}, n = {part.n}, {age}, speed: {part.name}{speed}"


def expected_distances(part: SpeedBin, leg_length: float | None, gravity: float) -> Mapping[str, ReferenceValue]:
    """Spatiotemporal values of the bin for a person of that leg length [m]: dimensionless ones are multiplied out.

    v = v* sqrt(g l), cadence = 60 f* sqrt(g / l) steps/min, lengths x = x* l, times t = t* sqrt(l / g) (Hof 1996).
    """
    if leg_length is None or leg_length <= 0.0:
        return part.spatiotemporal
    root = float(np.sqrt(gravity * leg_length))
    factors = {
        "speed": ("speed_m_per_s", root),
        "cadence": ("cadence_steps_per_min", 60.0 * gravity / root),
        "stride_length": ("stride_length_m", leg_length),
        "step_length": ("step_length_m", leg_length),
        "step_width": ("step_width_m", leg_length),
        "stride_time": ("stride_time_s", root / gravity),
        "step_time": ("step_time_s", root / gravity),
    }
    found = {
        factors[name][0]: ReferenceValue(mean=value.mean * factors[name][1], sd=value.sd * factors[name][1])
        for name, value in part.normalised.items()
        if name in factors
    }
    return dict(part.spatiotemporal) | found
