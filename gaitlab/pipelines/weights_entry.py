"""Weights of one stride in the form of the result document."""

from collections.abc import Sequence

import numpy as np

from ..bilevel.uncertainty import correlation
from ..clinical.document import Comparison, CriterionWeight, Fit, Solver, StrideWeights, WeightsEntry
from ..mocap.cycle import Cycle
from ..walking.explanation import Explanation
from .weight_confidence import confidence_intervals, confused_criteria

AT_BOUND = 1e-4
"""Weights below this are zero because the simplex ends there."""

LARGE_FLOORS = 0.2
"""Share of the floors in the cost above which the weights come with a caution; healthy strides have 0.03 to 0.06."""

TRACKED = (
    "The standard deviations hold the misfit between those instants, not errors of the given states themselves, to "
    "which the weights are sensitive. Read differences between strides as a lower bound of what is uncertain."
)
ESTIMATED = (
    "The model explains this walk to within the noise of its measurement: the states at those instants were estimated "
    "together with the weights, from every frame, and the standard deviations hold their uncertainty, too."
)

FLOORS = ("torque_floor", "smoothness_floor", "contact_force_floor")

JOINTS = (
    "pelvis_position",
    "pelvis_orientation",
    "right_hip",
    "right_knee",
    "right_ankle",
    "left_hip",
    "left_knee",
    "left_ankle",
    "trunk",
)
"""Groups of three coordinates in the order of q; pelvis_position in metres, the others in radians."""


def weights_entry(found: Explanation, seconds: float) -> WeightsEntry:
    """Weights, uncertainty, fit and certificate; `seconds` is the time that they took."""
    covariance = found.estimate.covariance
    return WeightsEntry(
        criteria=_criteria(found),
        fit=_fit(found),
        solver=_solver(found, seconds),
        covariance=_finite(covariance),
        correlation=_finite(correlation(covariance)),
        not_told_apart=confused_criteria(found),
        comparison=Comparison(equal_weights_rms_rad=found.equal_rms, single_criterion_rms_rad=dict(found.single_rms)),
        notes=_notes(found),
    )


def stride_entry(trial: str, cycle: Cycle, found: Explanation, seconds: float) -> StrideWeights:
    """The short form for the table of strides; `seconds` is the time that it took."""
    names = found.level.settings.criteria
    return StrideWeights(
        trial=trial,
        side=cycle.side,
        start_s=cycle.start,
        end_s=cycle.end,
        weights=dict(zip(names, found.estimate.theta.tolist(), strict=True)),
        fit_rms_rad=found.estimate.rms,
        solver=_solver(found, seconds),
    )


def _criteria(found: Explanation) -> list[CriterionWeight]:
    estimate, level = found.estimate, found.level
    terms = found.optimum.cost_terms()
    total = sum(terms.values())
    variances = np.diag(estimate.covariance)
    intervals = confidence_intervals(found)
    return [
        CriterionWeight(
            name=name,
            weight=float(estimate.theta[k]),
            sd=float(np.sqrt(variances[k])) if np.isfinite(variances[k]) else None,
            identifiable=bool(estimate.identifiable[k]),
            raw_weight=float(estimate.theta[k] / level.normalisers[k]),
            cost_share=terms[name] / total,
            tracked_value=float(level.normalisers[k]),
            at_bound=bool(estimate.theta[k] < AT_BOUND),
            interval_95=intervals[k],
        )
        for k, name in enumerate(level.settings.criteria)
    ]


def _fit(found: Explanation) -> Fit:
    residual = found.optimum.residual_by_time()
    groups = residual.reshape(len(residual), -1, 3)
    joints = {name: float(np.sqrt(np.mean(groups[:, k] ** 2))) for k, name in enumerate(JOINTS[: groups.shape[1]])}
    return Fit(rms_rad=found.estimate.rms, per_joint=joints)


def _solver(found: Explanation, seconds: float) -> Solver:
    solution, terms = found.optimum.solution, found.optimum.cost_terms()
    minimum = found.optimum.sensitivity.is_minimum()
    return Solver(
        status="solved" if found.is_certified else "not_converged",
        kkt_residual=solution.residuals.max(),
        iterations=found.estimate.iterations + found.estimate.lower_iterations + found.tracked.solution.iterations,
        seconds=seconds,
        reduced_hessian="positive definite" if minimum else "not positive definite",
        tracking_rms_rad=found.tracked.rms,
        tracking_seconds=found.tracking_seconds,
        regularisation_share=sum(terms[name] for name in FLOORS) / sum(terms.values()),
        message="" if found.is_certified else f"{found.estimate.reason}; {solution.status.value}",
    )


def _notes(found: Explanation) -> list[str]:
    level, settings = found.level, found.level.settings
    notes = [
        f"The states of the body at {len(level.given_nodes)} of {len(found.tracked.stride.times)} instants (at most "
        f"{1000 * level.longest_arc:.0f} ms apart) are given to the optimal control problem as boundary values; the "
        "fit counts the instants between them.",
        f"Besides the criteria the cost holds a torque floor of {settings.torque_floor:g} and a smoothness floor of "
        f"{settings.smoothness_floor:g} of their {'optimal' if found.states_estimated else 'tracked'} values.",
        ESTIMATED if found.states_estimated else TRACKED,
    ]
    terms = found.optimum.cost_terms()
    floors = sum(terms[name] for name in FLOORS) / sum(terms.values())
    if floors > LARGE_FLOORS:
        notes.append(
            f"The floors pay {100 * floors:.0f} % of the cost: the criteria explain little of this stride. "
            "Check its markers before reading the weights."
        )
    blind = [n for n, known in zip(settings.criteria, found.estimate.identifiable, strict=True) if not known]
    if blind:
        notes.append(f"The data do not tell the weights of: {', '.join(blind)}.")
    notes += [
        f"The data cannot tell {first} and {second} apart: one could take over the other's weight without a worse fit "
        "than chance. Read only the sum of both weights."
        for first, second in confused_criteria(found)
    ]
    return notes


def _finite(matrix: np.ndarray) -> list[list[float | None]]:
    return [_row(row) for row in matrix.tolist()]


def _row(row: Sequence[float]) -> list[float | None]:
    return [value if np.isfinite(value) else None for value in row]
