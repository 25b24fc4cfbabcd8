"""Every treatment with every solver on small problems with known solutions."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.nlp.complementarity.lifting import LiftingL1, LiftingL2
from gaitlab.nlp.complementarity.method import Schedule
from gaitlab.nlp.complementarity.multi_start import MultiStart, starts
from gaitlab.nlp.complementarity.penalty import Penalty
from gaitlab.nlp.complementarity.relaxation import Relaxation
from gaitlab.nlp.complementarity.slack_form import slack_form
from gaitlab.nlp.complementarity.unlifted import Unlifted
from gaitlab.nlp.ipopt import Ipopt
from gaitlab.nlp.mpcc import MPCC
from gaitlab.nlp.outcome import Outcome
from gaitlab.nlp.uno import Uno

TREATMENTS = (Unlifted, LiftingL1, LiftingL2, Penalty, Relaxation)
SOLVERS = (Ipopt(), Uno(seconds=20.0))
every_method = pytest.mark.parametrize(
    "method",
    [treatment(solver=solver) for treatment in TREATMENTS for solver in SOLVERS],
    ids=lambda method: f"{type(method).__name__}-{type(method.solver).__name__}",
)
every_treatment = pytest.mark.parametrize(
    "method",
    [treatment(solver=Ipopt(max_iter=80)) for treatment in TREATMENTS],
    ids=lambda method: type(method).__name__,
)


def free(n):
    return {"lbw": np.full(n, -np.inf), "ubw": np.full(n, np.inf)}


def hatz_8_31():
    """Hatz (2014), (8.33): MPCC-LICQ fails at the solution zero."""
    x, y, z = ca.SX.sym("x"), ca.SX.sym("y", 2), ca.SX.sym("z", 2)
    g = ca.vertcat(-2 * x + 2 * y[0] - z[0], 2 * y[1] - z[1])
    zero = np.zeros(2)
    return MPCC(w=ca.vertcat(x, y, z), f=-x + 2 * y[0] + y[1], g=g, lbg=zero, ubg=zero, G=y, H=z, **free(5))


def curved_pair():
    """Minimise (x - 2)^2 + (y - 1)^2 with 0 <= 4 - x^2 - y perp y >= 0: either y = 0, x = 2 or y = 4 - x^2."""
    w = ca.SX.sym("w", 2)
    return MPCC(w=w, f=(w[0] - 2) ** 2 + (w[1] - 1) ** 2, G=4 - w[0] ** 2 - w[1], H=w[1], **free(2))


@every_method
def test_example_8_31(method):
    solution = method.solve(hatz_8_31(), np.ones(5))
    np.testing.assert_allclose(solution.w, 0.0, atol=1e-6)
    assert solution.outcome is Outcome.SOLVED
    assert solution.is_stationary() and solution.is_feasible(1e-8, 1e-8)


@every_treatment
def test_a_curved_pair(method):
    solution = method.solve(curved_pair(), np.array([1.0, 1.0]))
    x = max(np.roots([2.0, 0.0, -5.0, -2.0]).real)  # where (x - 2)^2 + (3 - x^2)^2 is stationary
    np.testing.assert_allclose(solution.w, [x, 4 - x**2], atol=1e-5)
    assert solution.complementarity < 1e-7


@every_treatment
def test_infeasible_unbounded_and_undefined_problems_are_named(method):
    w = ca.SX.sym("w", 2)
    pair = {"G": w[0], "H": w[1]}
    limits = {"lbg": np.ones(1), "ubg": np.full(1, np.inf)}
    apart = MPCC(w=w, f=ca.sumsqr(w), g=ca.fmin(w[0], w[1]), **limits, **pair, **free(2))
    falling = MPCC(w=w, f=-w[0] - w[1], **pair, **free(2))
    undefined = MPCC(w=w, f=ca.log(w[0] - 1.0), **pair, **free(2))
    infeasible = method.solve(apart, np.zeros(2))
    assert infeasible.outcome is not Outcome.SOLVED
    assert infeasible.reason
    unbounded = method.solve(falling, np.ones(2))
    assert unbounded.outcome is not Outcome.SOLVED
    invalid = method.solve(undefined, np.zeros(2))
    assert invalid.outcome is Outcome.INVALID_NUMBER
    assert "the objective is" in invalid.reason


def test_wrong_starts_are_refused():
    with pytest.raises(ProblemError, match="w0 must have shape"):
        Relaxation().solve(hatz_8_31(), np.ones(3))
    with pytest.raises(ProblemError, match="p must have shape"):
        Relaxation().solve(hatz_8_31(), np.ones(5), np.ones(1))


def test_without_crossover_the_relaxation_is_only_nearly_complementary():
    loose = Relaxation(schedule=Schedule(first=1.0, factor=0.1, last=1e-4), crossover=False)
    solution = loose.solve(curved_pair(), np.array([1.0, 1.0]))
    assert 1e-9 < solution.complementarity < 1e-3


def test_more_starts_find_the_better_branch():
    """From the branch y = 0 the other one is invisible to first order."""
    w = ca.SX.sym("w", 2)
    limits = {"lbw": np.full(2, -np.inf), "ubw": np.full(2, 3.0)}
    problem = MPCC(w=w, f=(w[0] - 1) ** 2 - 2 * w[1], G=w[0], H=w[1], **limits)
    w0 = np.array([1.0, 0.0])
    assert Unlifted().solve(problem, w0).f == pytest.approx(0.0, abs=1e-6)
    assert MultiStart(method=Unlifted(), n_starts=8).solve(problem, w0).f == pytest.approx(-5.0, abs=1e-6)


def test_starts_repeat_and_keep_the_bounds():
    problem = curved_pair()
    first, again = (starts(problem, np.zeros(2), 4, seed=3) for _ in range(2))
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(first[0], 0.0)


def test_slacks_are_given_to_halves_that_are_no_variables():
    form = slack_form(curved_pair())
    assert form.n_slacks == 1
    np.testing.assert_allclose(form.problem.lbw, [-np.inf, 0.0, 0.0])
    values = ca.Function("start", [form.problem.w[:2], form.problem.p], [form.start])(np.array([1.0, 1.0]), [])
    np.testing.assert_allclose(values.full().ravel(), [1.0, 1.0, 2.0])
