"""Sweeps over the weights, where the solution is a formula, where it ends, and on a demo walk."""

import casadi as ca
import numpy as np
import planar_body
import pytest
from symbolic_program import SymbolicProgram
from weighted_level import SOLVER, WeightedLevel, WeightedResponse

from gaitlab.errors import Cancelled, ProblemError
from gaitlab.nlp.interior_point import InteriorPoint
from gaitlab.nlp.sensitivity import Sensitivity
from gaitlab.nlp.sparse_solution import Status
from gaitlab.transcription.mechanical_layout import Boundary
from gaitlab.walking.what_if import SweepStatus, WhatIf, gait_curves, with_weight

CENTRE, OTHER = np.full(3, 1.0 / 3.0), np.array([0.7, 0.0, 0.3])
STIFFNESS = np.array([[1.0, 2.0, 0.5, 3.0], [2.0, 1.0, 1.0, 0.3], [0.4, 1.0, 4.0, 1.0]])
POINTS = np.array([[1.0, 0.0, -1.0, 2.0], [0.0, 2.0, 1.0, -1.0], [-1.0, 1.0, 0.5, 0.0]])


class KnownResponse(WeightedResponse):
    @property
    def sensitivity(self):
        return Sensitivity(self.program, self.solution)


class KnownLevel(WeightedLevel):
    def respond(self, theta, start):
        return KnownResponse(self, theta, start)


class DoubleWell:
    """Minimise theta_0 (x^4 / 4 - x^2 / 2) + theta_1 x: the right well ends at theta_1 / theta_0 = 2 / (3 sqrt 3)."""

    n_theta = 2

    def respond(self, theta, start):
        return WellResponse(theta, start)


class WellResponse:
    def __init__(self, theta, start):
        x = ca.SX.sym("x")
        self.program = SymbolicProgram(x, theta[0] * (x**4 / 4 - x**2 / 2) + theta[1] * x)
        self.solution = SOLVER.solve(self.program, start)
        self.slope = np.array([[self.solution.w[0] ** 3 - self.solution.w[0], 1.0]])

    @property
    def sensitivity(self):
        return Sensitivity(self.program, self.solution)

    def predict(self, step):
        return self.sensitivity.predict(self.sensitivity.of_objective(self.slope) @ step)


class PlanarLevel:
    """A body that steps down from its rear foot to both, between given states; three criteria."""

    n_theta = 3
    solver = InteriorPoint(mu_initial=1e-7, mu_final=1e-7, max_iter=60)

    def __init__(self):
        angles = np.array([0.3, 0.0])
        first, last = (np.append(self._on_the_rear_foot(a), np.zeros(3)) for a in angles)
        stages = (
            planar_body.stage(0.4, 4, 0, clear=(3,)),
            planar_body.stage(0.2, 2, 0, 1, landing=(3,), grounded=(3,)),
        )
        everything = tuple(range(6))
        self.layout = planar_body.layout(stages, boundary=Boundary(((0, everything),)), limited=(2,))
        self.given = np.vstack([np.tile(first, (6, 1)), last])
        self.normalisers = np.ones(3)
        start = np.concatenate([np.tile(first, 7), np.full(self.problem(CENTRE).structure.n_w - 42, 5.0)])
        solution = InteriorPoint(mu_final=1e-7).solve(self.problem(CENTRE), start)
        self.normalisers = 1e-6 + self.problem(CENTRE).criteria(solution.w)
        self.first = self.respond(CENTRE, solution)

    def _on_the_rear_foot(self, angle):
        c, s = np.cos(angle), np.sin(angle)
        return np.array([*(-np.array([[c, -s], [s, c]]) @ planar_body.FEET[0]), angle])

    def problem(self, theta):
        options = {"force_weight": 1e-3, "acceleration_weights": np.full(3, 1e-2), "upper": np.full(3, 0.35)}
        return planar_body.problem(self.layout, theta=theta / self.normalisers, given=self.given, **options)

    def respond(self, theta, start):
        return PlanarResponse(self, self.problem(theta), start)


class PlanarResponse:
    def __init__(self, level, problem, start):
        self.level, self.problem, self.solution = level, problem, level.solver.solve(problem, start)

    @property
    def sensitivity(self):
        return Sensitivity(self.problem, self.solution)

    def predict(self, step):
        gradients = self.problem.criterion_gradients(self.solution.w) / self.level.normalisers
        return self.sensitivity.predict(self.sensitivity.of_objective(gradients) @ step)


def known_sweep(method=None, **options):
    level = KnownLevel(POINTS, STIFFNESS, np.zeros(4))
    start = (CENTRE, level.respond(CENTRE, np.zeros(4)))
    return level, (method or WhatIf()).sweep(level, start, OTHER, **options)


def test_every_step_is_the_optimum_of_its_weights():
    level, sweep = known_sweep()
    assert sweep.is_complete
    for step in sweep.steps:
        np.testing.assert_allclose(step.theta, CENTRE + step.share * (OTHER - CENTRE), atol=1e-14)
        np.testing.assert_allclose(step.response.solution.w, level.exact(step.theta), atol=1e-8)


def test_asked_shares_are_met():
    shares = [step.share for step in known_sweep(shares=(0.07, 0.5, 0.93))[1].steps]
    assert {0.0, 0.07, 0.5, 0.93, 1.0} <= set(shares)
    assert np.all(np.diff(shares) > 0.0)


def test_prediction_error_falls_with_the_step():
    """Relative to the move it is of first order."""
    coarse, fine = (known_sweep(WhatIf(first_step=h, max_step=h))[1].steps[1].prediction_error for h in (0.1, 0.05))
    assert coarse / fine == pytest.approx(2.0, abs=0.2)


def test_where_the_optimum_ends_the_sweep_says_so():
    level = DoubleWell()
    first = np.array([1.0, 0.0])
    sweep = WhatIf().sweep(level, (first, level.respond(first, np.ones(1))), np.array([0.5, 0.5]))
    last = sweep.steps[-1]
    assert sweep.status in (SweepStatus.JUMP, SweepStatus.NO_MINIMUM, SweepStatus.UNSOLVED)
    assert last.theta[1] / last.theta[0] == pytest.approx(2.0 / (3.0 * np.sqrt(3.0)), abs=2e-3)
    assert last.response.solution.w[0] > 0.5
    assert "of the way" in sweep.reason
    assert sweep.rejected > 0


def test_the_deeper_well_is_followed_all_the_way():
    level = DoubleWell()
    first = np.array([1.0, 0.0])
    sweep = WhatIf().sweep(level, (first, level.respond(first, -np.ones(1))), np.array([0.5, 0.5]))
    assert sweep.is_complete
    x = sweep.steps[-1].response.solution.w[0]
    assert x**3 - x + 1.0 == pytest.approx(0.0, abs=1e-8)


@pytest.fixture(scope="module")
def planar():
    return PlanarLevel()


@pytest.mark.parametrize("index", range(3))
def test_a_mechanical_walk_is_followed_to_every_weight(planar, index):
    assert planar.first.solution.status is Status.SOLVED
    sweep = WhatIf().sweep(planar, (CENTRE, planar.first), with_weight(CENTRE, index, 0.9), shares=(0.5,))
    assert sweep.is_complete, sweep.reason
    assert all(step.response.solution.is_optimal(1e-6) for step in sweep.steps)
    # The optimal cost is a minimum of functions linear in the weights: concave, its slope along the way falls.
    way = sweep.steps[-1].theta - CENTRE
    slopes = [
        way @ (step.response.problem.criteria(step.response.solution.w) / planar.normalisers) for step in sweep.steps
    ]
    assert np.all(np.diff(slopes) <= 1e-6)


def test_curves_of_a_mechanical_walk(planar):
    sweep = WhatIf().sweep(planar, (CENTRE, planar.first), with_weight(CENTRE, 0, 0.9))
    curves = gait_curves(sweep)
    assert curves.shape == (len(sweep.steps), 7, 3)
    np.testing.assert_allclose(curves[:, 0], np.tile(planar.given[0, :3], (len(curves), 1)), atol=1e-6)
    assert np.ptp(curves, axis=0).max() > 1e-4


def test_no_way_to_go():
    level = KnownLevel(POINTS, STIFFNESS, np.zeros(4))
    sweep = WhatIf().sweep(level, (CENTRE, level.respond(CENTRE, np.zeros(4))), CENTRE)
    assert sweep.is_complete
    assert len(sweep.steps) == 1


def test_progress_cancels():
    def progress(share):
        if share > 0.3:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        known_sweep(progress=progress)


@pytest.mark.parametrize("theta", [(0.5, 0.5), (0.7, 0.7, -0.4), (0.5, 0.4, 0.0)])
def test_weights_must_lie_on_the_simplex(theta):
    level = KnownLevel(POINTS, STIFFNESS, np.zeros(4))
    start = (CENTRE, level.respond(CENTRE, np.zeros(4)))
    with pytest.raises(ProblemError, match="sum 1"):
        WhatIf().sweep(level, start, np.array(theta))


def test_shares_must_lie_on_the_way():
    with pytest.raises(ProblemError, match="between 0 and 1"):
        known_sweep(shares=(1.2,))


def test_one_weight_set_the_others_in_proportion():
    np.testing.assert_allclose(with_weight(np.array([0.2, 0.6, 0.2]), 0, 0.6), [0.6, 0.3, 0.1])
    np.testing.assert_allclose(with_weight(np.array([1.0, 0.0, 0.0]), 0, 0.4), [0.4, 0.3, 0.3])
    with pytest.raises(ProblemError, match="between 0 and 1"):
        with_weight(CENTRE, 0, 1.5)
