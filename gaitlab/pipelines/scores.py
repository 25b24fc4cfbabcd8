"""Strides, consistency and scores of analysed trials in the form of the result document."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..clinical.cycle_average import average, complete
from ..clinical.document import CURVES, SIDES
from ..clinical.gait_deviation_index import gait_deviation_index
from ..clinical.gait_profile import GaitProfile, gait_profile, overall_score
from ..clinical.normative import ReferenceCohort, SpeedBin, choose_bin, describe, expected_distances
from ..clinical.score_document import (
    ConsistencyEntry,
    ReferenceEntry,
    ScoresEntry,
    SideScores,
    StrideEntry,
    StridesEntry,
)
from ..clinical.spatiotemporal import GRAVITY
from ..clinical.strides import (
    CURVE_FLOOR,
    FEWEST,
    MODIFIED_Z,
    RELATIVE_FLOOR,
    consistency,
    outlier_reasons,
    representative,
)
from ..mocap.recording import Side
from .references import References
from .trial import TrialAnalysis

RULE = (
    f"flagged: more than {MODIFIED_Z:g} robust standard deviations (median absolute deviation) and more than "
    f"{CURVE_FLOOR:g} deg rms from the median stride in a curve, or {100.0 * RELATIVE_FLOOR:.0f} % in length, time or "
    f"speed; judged from {FEWEST} strides of a side on; flagged strides stay in the means"
)
Curves = Mapping[str, Sequence[np.ndarray]]


def strides_entry(trials: Sequence[TrialAnalysis]) -> StridesEntry:
    """All strides of all trials, judged side by side."""
    found = {side: _side_curves(trials, side) for side in SIDES}
    alike: dict[str, dict[Side, ConsistencyEntry]] = {
        curve: {side: entry for side in SIDES if (entry := _consistency(found[side][curve])) is not None}
        for curve in CURVES
    }
    return StridesEntry(
        strides=[stride for side in SIDES for stride in _strides(trials, side, found[side])],
        consistency={curve: sides for curve, sides in alike.items() if sides},
        rule=RULE,
    )


def scores_entry(
    trials: Sequence[TrialAnalysis], references: References, leg_length: float | None, speed: float | None
) -> ScoresEntry:
    """Scores against the references; what could not be computed is said in `missing`.

    Args:
        trials: Walks of one person.
        references: Norms and basis, as far as they could be read.
        leg_length: Mean of both legs [m].
        speed: Mean speed over the ground [m/s].
    """
    missing = list(references.problems)
    part = None
    if references.cohort is not None:
        slowness = None if leg_length is None or speed is None else speed / float(np.sqrt(GRAVITY * leg_length))
        part, remark = choose_bin(references.cohort, references.speed, slowness)
        missing += [remark] if remark else []
    curves = {side: _side_curves(trials, side) for side in SIDES}
    profiles = {side: _profile(curves[side], part) for side in SIDES}
    for side in SIDES:
        missing += _what_is_missing(side, curves[side], profiles[side])
    return ScoresEntry(
        reference=None
        if part is None or references.cohort is None
        else _reference(references.cohort, part, leg_length),
        left=_side(curves["left"], profiles["left"], part, references),
        right=_side(curves["right"], profiles["right"], part, references),
        gps_overall=_overall(profiles["left"], profiles["right"]),
        gdi_reference="" if references.basis is None else references.basis.source,
        missing=missing,
    )


def _side_curves(trials: Sequence[TrialAnalysis], side: Side) -> dict[str, list[np.ndarray]]:
    return {curve: [cycle for trial in trials for cycle in trial.curves[curve][side]] for curve in CURVES}


def _strides(trials: Sequence[TrialAnalysis], side: Side, curves: Curves) -> list[StrideEntry]:
    cycles = [(trial.name, cycle) for trial in trials for cycle in trial.cycles[side]]
    distances = [entry for trial in trials for entry in trial.spatiotemporal[side]]
    reasons = outlier_reasons(curves, distances)
    chosen = representative(curves, [bool(found) for found in reasons])
    return [
        StrideEntry(
            trial=name,
            side=side,
            start_s=cycle.start,
            end_s=cycle.end,
            complete=all(bool(np.all(np.isfinite(values[index]))) for values in curves.values()),
            outlier=list(reasons[index]),
            representative=index == chosen,
        )
        for index, (name, cycle) in enumerate(cycles)
    ]


def _consistency(curves: Sequence[np.ndarray]) -> ConsistencyEntry | None:
    found = consistency(curves)
    return None if found is None else ConsistencyEntry(sd_deg=found.sd, cmc=found.cmc, n_strides=found.n_strides)


def _profile(curves: Curves, part: SpeedBin | None) -> GaitProfile | None:
    means = _means(curves)
    return gait_profile(means, _reference_means(part)) if means and part is not None else None


def _means(curves: Curves) -> dict[str, np.ndarray]:
    return {name: average(whole)[0] for name, values in curves.items() if (whole := complete(values))}


def _reference_means(part: SpeedBin) -> dict[str, np.ndarray]:
    return {name: np.array(band.mean) for name, band in part.curves.items()}


def _what_is_missing(side: Side, curves: Curves, profile: GaitProfile | None) -> list[str]:
    if not _means(curves):
        return [f"scores of the {side} side: no complete cycle of it"]
    if profile is None or not profile.missing:
        return []
    names = ", ".join(name.replace("_", " ") for name in profile.missing)
    return [f"GPS of the {side} side: no complete curve, or no reference, of {names}"]


def _overall(left: GaitProfile | None, right: GaitProfile | None) -> float | None:
    return None if left is None or right is None else overall_score(left, right)


def _side(curves: Curves, profile: GaitProfile | None, part: SpeedBin | None, given: References) -> SideScores | None:
    means = _means(curves)
    if not means or (profile is None and given.basis is None):
        return None
    every = [] if part is None else _each_cycle(curves, part)
    return SideScores(
        gvs=dict(profile.gvs) if profile is not None else {},
        gps=None if profile is None else profile.gps,
        gps_sd=float(np.std(every, ddof=1)) if len(every) > 1 else None,
        n_cycles=len(every),
        gdi=None if given.basis is None else gait_deviation_index(given.basis, means),
    )


def _each_cycle(curves: Curves, part: SpeedBin) -> list[float]:
    reference = _reference_means(part)
    count = max(len(values) for values in curves.values())
    profiles = [gait_profile({name: values[k] for name, values in curves.items()}, reference) for k in range(count)]
    return [profile.gps for profile in profiles if profile.gps is not None]


def _reference(
    cohort: ReferenceCohort | None, part: SpeedBin | None, leg_length: float | None
) -> ReferenceEntry | None:
    if cohort is None or part is None:
        return None
    return ReferenceEntry(
        description=describe(cohort, part),
        source=cohort.source,
        licence=cohort.licence,
        n=part.n,
        age_years=None if cohort.age_words else cohort.age_years,
        speed_bin=part.name,
        curves=part.curves,
        kinetics=part.kinetics,
        emg=part.emg,
        spatiotemporal=dict(expected_distances(part, leg_length, GRAVITY)),
        gvs=part.gvs,
        gps=part.gps,
        weights=part.weights,
    )
