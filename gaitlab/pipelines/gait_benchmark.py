"""The inverse problems of the thesis's gait models at full size: solved, certified, and compared with the truth."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..bilevel.implicit_gauss_newton import ImplicitGaussNewton
from ..bilevel.result import WeightEstimate
from ..bilevel.uncertainty import ellipsoid_holds
from ..errors import NotConverged
from ..nlp.sparse_solution import Status
from ..nlp.workers import Workers
from ..walking.criteria import THESIS
from ..walking.gait_search import first_estimate
from ..walking.point_foot_gait import GaitLevel, GaitOptimum
from .gait_cases import GaitCase

CERTIFICATE = 1e-6
"""Largest first-order residual of a certified solution."""


@dataclass(frozen=True, kw_only=True)
class GaitRun:
    """One inverse problem and its solution."""

    case: GaitCase
    noise: float
    """In units of 1 degree and 10 mm."""
    seed: int
    level: GaitLevel
    estimate: WeightEstimate
    optimum: GaitOptimum
    seconds: float
    """From measurements to weights, by the clock [s]."""

    @property
    def certified(self) -> bool:
        """First-order conditions to 1e-6, a minimum to second order in every stage, a converged upper level."""
        return self.optimum.solution.is_optimal(CERTIFICATE) and self.optimum.is_minimum() and self.estimate.converged

    @property
    def error(self) -> float:
        """Largest difference of a normalised weight from the truth."""
        return float(np.max(np.abs(self.estimate.theta - self.case.weights)))

    @property
    def objective(self) -> float:
        """Half the squared differences from the measurements as in (15.2), all standard deviations one."""
        n_q = self.level.n_q
        last = len(self.optimum.states) - 1
        total = 0.0
        for k, (x, q) in enumerate(zip(self.optimum.states, self.level.measured.q, strict=True)):
            gap = x[:, :n_q] - q
            total += 0.5 * float(np.sum((gap if k == last else gap[:-1]) ** 2))
        return total

    @property
    def thesis_weights(self) -> np.ndarray:
        """The estimate in the thesis's scaling, sum one, shape (4,)."""
        gamma = self.estimate.theta / self.case.gait.normalisers / self.case.thesis.scalings
        return gamma / gamma.sum()

    @property
    def n_variables(self) -> int:
        """Variables of the lower level."""
        return sum(structure.n_w for structure in self.level.structures)

    @property
    def n_constraints(self) -> int:
        """Equations of the lower level."""
        return sum(structure.sparse.n_g for structure in self.level.structures)

    @property
    def n_pairs(self) -> int:
        """Inequalities of the lower level, each with its multiplier."""
        return sum(structure.sparse.n_c for structure in self.level.structures)

    def covers_truth(self) -> bool:
        """Whether the 95 % confidence ellipsoid of the weights holds the truth."""
        return ellipsoid_holds(self.estimate.theta - self.case.weights, self.estimate.covariance)


def solve_case(
    case: GaitCase,
    noise: float = 0.0,
    seed: int = 0,
    start: np.ndarray | None = None,
    progress: Callable[[int, float], None] | None = None,
    workers: Workers | None = None,
) -> GaitRun:
    """Weights from simulated measurements, from start weights, shape (4,), equal ones by default.

    Workers solve the stages side by side.

    Raises:
        NotConverged: The lower level is not solved for the first weights.
    """
    theta = np.full(len(THESIS), 1.0 / len(THESIS)) if start is None else start
    measured = case.measured(noise, seed)
    began = time.perf_counter()
    level = GaitLevel(case.gait, measured, workers=workers)
    theta, first = first_estimate(level, theta)
    status = first.solution.status
    if status is not Status.SOLVED:
        raise NotConverged(f"{case.gait.name}: no optimal gait for the first weights: {status}")
    estimate = ImplicitGaussNewton().solve(level, theta, first, progress)
    seconds = time.perf_counter() - began
    problems = level.problems(estimate.theta)
    optimum = GaitOptimum(level, problems, level.split(estimate.response.solution))
    return GaitRun(
        case=case, noise=noise, seed=seed, level=level, estimate=estimate, optimum=optimum, seconds=seconds
    )  # fmt: skip


COLUMNS = ("quantity", "thesis", "ours", "truth")


def rows(run: GaitRun) -> list[tuple[str, str, str, str]]:
    """The table of one run under `COLUMNS`; what the thesis does not print is a dash."""
    thesis, estimate = run.case.thesis, run.estimate
    deviation = np.sqrt(np.diag(estimate.covariance))
    grids = "/0/".join(str(n) for n in thesis.n_intervals)
    n_nodes = sum(len(x) for x in run.optimum.states)
    table = [
        ("intervals per stage", grids, grids, ""),
        ("measured values", f"{thesis.n_measured} x 24", f"{thesis.n_measured} x 24", ""),
        ("variables", str(thesis.n_variables), f"{run.n_variables} (lower level, {n_nodes} nodes)", ""),
        ("equations", "7243", str(run.n_constraints), ""),
        ("complementary pairs", str(thesis.n_pairs), str(run.n_pairs), ""),
        ("noise", "real data", f"{run.noise:g} deg, {10 * run.noise:g} mm, seed {run.seed}", ""),
        ("objective (15.2)", f"{thesis.objective:.5g}", f"{run.objective:.5g}", ""),
        (
            "objective / measured values",
            f"{thesis.objective / (24 * thesis.n_measured):.3g}",
            f"{run.objective / (24 * thesis.n_measured):.3g}",
            "",
        ),
    ]
    for i, name in enumerate(THESIS):
        ours = f"{estimate.theta[i]:.5f} +- {deviation[i]:.5f}"
        table.append((f"weight of {name}, normalised", "-", ours, f"{run.case.weights[i]:.5f}"))
    for i, name in enumerate(THESIS):
        printed = f"{thesis.weights[i]:.5g}"
        table.append((f"gamma_{i + 1} ({name})", printed, f"{run.thesis_weights[i]:.5g}", printed))
    return [
        *table,
        ("iterations", str(thesis.iterations), str(estimate.iterations), ""),
        ("seconds", f"{thesis.seconds:.6g}", f"{run.seconds:.2f}", ""),
        ("thesis's time / ours", "1", f"{thesis.seconds / run.seconds:.0f}", ""),
        ("certified", "no", "yes" if run.certified else f"no: {estimate.reason}", ""),
        ("largest torque [N*m]", "<= 500", f"{run.optimum.largest_torque():.0f}", ""),
    ]
