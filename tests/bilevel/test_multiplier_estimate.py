import numpy as np
from scipy.sparse import csr_matrix

from gaitlab.benchmarks.ocp_collection import benchmark
from gaitlab.bilevel.multiplier_estimate import estimate_multipliers
from gaitlab.nlp.ipopt import Ipopt
from gaitlab.nlp.solution import kkt_residuals
from gaitlab.transcription.optimal_control import Solve


def local(nlp, w, p):
    gradient = np.asarray(nlp.derivatives.gradient(w, p)[1]).ravel()
    g, jacobian = nlp.derivatives.jacobian(w, p)
    return gradient, np.asarray(g).ravel(), csr_matrix(jacobian.sparse())


def test_multipliers_of_a_solution_are_recovered():
    car = benchmark("reeds-shepp")
    transcribed = car.transcribe()
    solution = Solve(solver=Ipopt(tol=1e-11))(transcribed, car.start, car.truth).solution
    nlp = transcribed.nlp
    found = estimate_multipliers(nlp, solution.w, *local(nlp, solution.w, car.truth))
    np.testing.assert_allclose(found.lam_g, solution.lam_g, atol=1e-5)
    np.testing.assert_allclose(found.lam_w, solution.lam_w, atol=1e-5)
    assert kkt_residuals(nlp, found.w, found.lam_w, found.lam_g, car.truth).max() < 1e-5


def test_an_infeasible_point_and_one_that_is_not_finite_have_none():
    car = benchmark("reeds-shepp")
    transcribed = car.transcribe()
    nlp, w = transcribed.nlp, transcribed.start(car.start)
    gradient, g, jacobian = local(nlp, w, car.truth)
    assert estimate_multipliers(nlp, w, gradient, g, jacobian) is None
    assert estimate_multipliers(nlp, w, np.full_like(gradient, np.nan), g, jacobian) is None
