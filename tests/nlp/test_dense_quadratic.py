"""Small quadratic programs against scipy and against their optimality conditions."""

import numpy as np
import pytest
from scipy.optimize import linprog

from gaitlab.nlp.dense_quadratic import DenseQuadratic


def random_program(seed, rank):
    generator = np.random.default_rng(seed)
    n, n_e, n_c = 12, 3, 30
    root, inside = generator.normal(size=(rank, n)), generator.normal(size=n)
    E, C = generator.normal(size=(n_e, n)), generator.normal(size=(n_c, n))
    box = np.vstack([np.eye(n), -np.eye(n)])
    return DenseQuadratic(
        H=root.T @ root,
        g=generator.normal(size=n),
        E=E,
        e=E @ inside,
        C=np.vstack([C, box]),
        d=np.concatenate([C @ inside + generator.uniform(0, 1, n_c), box @ inside + 3.0]),
    )


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("rank", [0, 4, 12])
def test_optimality_conditions(seed, rank):
    qp = random_program(seed, rank)
    solution = qp.solve()
    slack = qp.d - qp.C @ solution.x
    assert solution.solved
    np.testing.assert_allclose(qp.E @ solution.x, qp.e, atol=1e-8)
    assert slack.min() > -1e-8
    assert solution.lam_c.min() >= 0.0
    np.testing.assert_allclose(slack * solution.lam_c, 0.0, atol=1e-7)
    stationarity = qp.H @ solution.x + qp.g + qp.E.T @ solution.lam_e + qp.C.T @ solution.lam_c
    np.testing.assert_allclose(stationarity, 0.0, atol=1e-7)


def test_without_curvature_it_is_a_linear_program():
    qp = random_program(3, 0)
    oracle = linprog(qp.g, qp.C, qp.d, qp.E, qp.e, bounds=(None, None))
    assert qp.g @ qp.solve().x == pytest.approx(oracle.fun, abs=1e-8)


def test_constraints_that_contradict_each_other_are_not_solved():
    rows = np.array([[1.0], [-1.0]])
    qp = DenseQuadratic(H=np.eye(1), g=np.zeros(1), E=np.zeros((0, 1)), e=np.zeros(0), C=rows, d=np.array([-1.0, -1.0]))
    assert not qp.solve().solved


def test_numbers_that_are_not_finite_are_not_solved():
    qp = DenseQuadratic(H=np.eye(1), g=np.array([np.nan]), E=np.zeros((0, 1)), e=np.zeros(0), C=np.eye(1), d=np.ones(1))
    assert not qp.solve().solved
