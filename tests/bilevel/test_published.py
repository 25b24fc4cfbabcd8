"""Every kind of method on the published problems: one certified minimum, or a plateau that is called so."""

import numpy as np
import pytest

from gaitlab.benchmarks.ocp_collection import benchmark
from gaitlab.bilevel.bundle import Bundle
from gaitlab.bilevel.derivative_free import DerivativeFree
from gaitlab.bilevel.from_measurements import Estimated, inverse_problem
from gaitlab.bilevel.gauss_newton import GaussNewton
from gaitlab.bilevel.kkt_reformulation import KKTReformulation
from gaitlab.nlp.complementarity.lifting import LiftingL1
from gaitlab.nlp.ipopt import Ipopt
from gaitlab.nlp.uno import Uno

METHODS = {
    "gauss-newton": GaussNewton(),
    "derivative-free": DerivativeFree(),
    "bundle": Bundle(),
    "l1-lifted-ipopt": KKTReformulation(method=LiftingL1()),
    "l1-lifted-filtersqp": KKTReformulation(method=LiftingL1(solver=Uno(seconds=60.0))),
}
NAMES = ("rocket-car", "reeds-shepp", "reeds-shepp-controls")


def posed(name):
    """Inverse problem of simulated measurements, the solution of the lower level for the published guess, the guess."""
    chosen = benchmark(name)
    transcribed, solver, unknowns = chosen.transcribe(), Ipopt(tol=1e-9), chosen.unknowns
    optimum = chosen.solve(transcribed, solver)
    estimated = Estimated(names=unknowns.names, lower=unknowns.lower, upper=unknowns.upper)
    problem = inverse_problem(transcribed, chosen.simulate(transcribed, optimum.w), estimated, chosen.truth)
    p0 = chosen.truth.copy()
    p0[problem.free] = unknowns.guess
    return problem, solver.solve(transcribed.nlp, optimum.w, p0).w, p0


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_methods_agree_or_say_why_not(name):
    problem, w0, p0 = posed(name)
    results = {label: method.solve(problem, w0, p0) for label, method in METHODS.items()}
    best = min(result.objective for result in results.values())
    for label, result in results.items():
        assert result.converged, (label, result.reason)
        assert result.residuals.max() < 1e-6
        assert result.complementarity < 1e-5
        on_plateau = not np.all(result.identifiable) and "do not tell" in result.reason
        assert result.objective <= best + 1e-3 or on_plateau, label


@pytest.mark.slow
def test_the_lifted_polar_robot_within_the_noise():
    """Issue 3, line 4 (Hatz 2014, section 13.4): all-at-once and l1-lifted from gamma_1 = 0.2, L = 0.6."""
    problem, w0, p0 = posed("polar-robot-lifted")
    result = METHODS["l1-lifted-ipopt"].solve(problem, w0, p0)
    assert result.converged, result.reason
    error = result.p - benchmark("polar-robot-lifted").truth
    sd = np.sqrt(np.diag(result.covariance))
    assert np.all(np.abs(error[problem.free]) <= 3.0 * sd[problem.free])
