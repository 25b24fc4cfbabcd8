"""Weights of several strides of one person, together."""

from collections.abc import Callable, Sequence

import numpy as np

from ..bilevel.weight_intervals import bootstrap_means
from ..clinical.document import (
    Comparison,
    CriterionWeight,
    Fit,
    PooledWeights,
    Solver,
    StrideWeights,
    WeightsEntry,
)

FEWEST = 3
"""Strides without which a bootstrap says nothing."""


def pool_strides(strides: Sequence[StrideWeights]) -> PooledWeights:
    """Mean weights of the strides and their sample standard deviation between strides; null with one stride."""
    names = list(strides[0].weights)
    values = np.array([[stride.weights[name] for name in names] for stride in strides])  # (n_strides, n_criteria)
    spread = np.std(values, axis=0, ddof=1) if len(strides) > 1 else np.full(len(names), np.nan)
    return PooledWeights(
        n_strides=len(strides),
        weights=dict(zip(names, np.mean(values, axis=0).tolist(), strict=True)),
        between_stride_sd={name: _known(sd) for name, sd in zip(names, spread.tolist(), strict=True)},
        bootstrap_95=dict(zip(names, bootstrap_means(values).tolist(), strict=True)) if len(strides) >= FEWEST else {},
    )


def combine_entries(entries: Sequence[WeightsEntry]) -> WeightsEntry:
    """The weights of several trials as one entry.

    A weight is the mean over all strides. Its variance is the larger of the mean variance within strides and the
    variance between them, divided by the number of strides. It is identifiable when it is so in every trial.
    """
    strides = [stride for entry in entries for stride in entry.strides]
    pooled = pool_strides(strides)
    n_criteria = len(entries[0].criteria)
    return WeightsEntry(
        criteria=[_criterion([entry.criteria[k] for entry in entries], pooled) for k in range(n_criteria)],
        fit=_fit([entry.fit for entry in entries]),
        solver=_solver([entry.solver for entry in entries]),
        comparison=_comparison([entry.comparison for entry in entries if entry.comparison is not None]),
        strides=strides,
        pooled=pooled,
        notes=list(dict.fromkeys(note for entry in entries for note in entry.notes)),
    )


def _criterion(same: Sequence[CriterionWeight], pooled: PooledWeights) -> CriterionWeight:
    name = same[0].name
    within = [criterion.sd**2 for criterion in same if criterion.sd is not None]
    between = pooled.between_stride_sd[name]
    variances = ([float(np.mean(within))] if within else []) + ([] if between is None else [between**2])
    return CriterionWeight(
        name=name,
        weight=pooled.weights[name],
        sd=float(np.sqrt(max(variances) / pooled.n_strides)) if variances else None,
        identifiable=bool(variances) and all(criterion.identifiable for criterion in same),
        at_bound=all(criterion.at_bound for criterion in same),
    )


def _fit(fits: Sequence[Fit]) -> Fit:
    joints = fits[0].per_joint
    unseen: dict[str, float] = {}
    for fit in fits:
        unseen |= fit.unseen_stride_rms_rad
    return Fit(
        rms_rad=_rms([fit.rms_rad for fit in fits]),
        per_joint={joint: _rms([fit.per_joint[joint] for fit in fits]) for joint in joints},
        unseen_stride_rms_rad=unseen,
    )


def _comparison(comparisons: Sequence[Comparison]) -> Comparison | None:
    if not comparisons:
        return None
    names = comparisons[0].single_criterion_rms_rad
    return Comparison(
        equal_weights_rms_rad=_rms_if_all([c.equal_weights_rms_rad for c in comparisons]),
        single_criterion_rms_rad={
            name: _rms_if_all([c.single_criterion_rms_rad.get(name) for c in comparisons]) for name in names
        },
    )


def _solver(solvers: Sequence[Solver]) -> Solver:
    worst = next((solver for solver in solvers if solver.status != "solved"), solvers[0])
    return Solver(
        status=worst.status,
        kkt_residual=_if_all(max, [solver.kkt_residual for solver in solvers]),
        iterations=sum(solver.iterations for solver in solvers),
        seconds=sum(solver.seconds for solver in solvers),
        reduced_hessian=worst.reduced_hessian,
        tracking_rms_rad=_rms_if_all([solver.tracking_rms_rad for solver in solvers]),
        tracking_seconds=_if_all(sum, [solver.tracking_seconds for solver in solvers]),
        regularisation_share=_if_all(max, [solver.regularisation_share for solver in solvers]),
        message="; ".join(solver.message for solver in solvers if solver.message),
    )


def _rms_if_all(values: Sequence[float | None]) -> float | None:
    return _if_all(_rms, values)


def _if_all(combine: Callable[[list[float]], float], values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return combine(known) if known and len(known) == len(values) else None


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None
