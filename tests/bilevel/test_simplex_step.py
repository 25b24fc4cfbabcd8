import numpy as np
from scipy.optimize import minimize

from gaitlab.bilevel.simplex_step import simplex_minimiser


def test_it_is_the_minimum_over_the_simplex():
    random = np.random.default_rng(1)
    for _ in range(5):
        theta = random.dirichlet(np.ones(4))
        root, gradient = random.standard_normal((6, 4)), 3.0 * random.standard_normal(4)
        hessian = root.T @ root

        def model(t, theta=theta, gradient=gradient, hessian=hessian):
            return gradient @ (t - theta) + 0.5 * (t - theta) @ hessian @ (t - theta)

        found = simplex_minimiser(theta, gradient, hessian)
        bounds, total = [(0.0, 1.0)] * 4, {"type": "eq", "fun": lambda t: t.sum() - 1.0}
        expected = minimize(model, theta, bounds=bounds, constraints=total, method="SLSQP", options={"ftol": 1e-14})
        np.testing.assert_allclose(found, expected.x, atol=1e-5)


def test_a_direction_of_negative_curvature_does_not_break_it():
    found = simplex_minimiser(np.array([0.5, 0.5]), np.array([-1.0, 1.0]), np.diag([1.0, -0.5]))
    assert found.min() >= 0.0 and found.sum() == 1.0
    assert found[0] > 0.5
