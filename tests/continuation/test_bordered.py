"""Sparse linear algebra against dense."""

import numpy as np
import pytest
from scipy import sparse

from gaitlab.continuation.bordered import bordered, determinant_sign, least_norm_step, null_pair, singularity, solve


def matrix(seed, n=7):
    return np.random.default_rng(seed).normal(size=(n, n))


@pytest.mark.parametrize("seed", range(8))
def test_sign_of_the_determinant(seed):
    A = matrix(seed)
    assert determinant_sign(sparse.csc_matrix(A)) == np.sign(np.linalg.det(A))


def test_singular_matrices():
    A = sparse.csc_matrix(np.diag([1.0, 0.0, 2.0]))
    assert determinant_sign(A) == 0
    assert solve(A, np.ones(3)) is None


def test_bordering_appends_a_row():
    J, row = sparse.csr_matrix(matrix(0)[:6]), np.arange(7.0)
    np.testing.assert_array_equal(bordered(J, row).toarray(), np.vstack([J.toarray(), row]))


def test_least_norm_step():
    J, r = matrix(1)[:6], np.arange(6.0)
    np.testing.assert_allclose(least_norm_step(sparse.csr_matrix(J), r), -np.linalg.pinv(J) @ r, atol=1e-10)


@pytest.mark.parametrize("smallest", [1e-3, 1e-9, 0.0])
def test_null_vectors(smallest):
    u, s, vt = np.linalg.svd(matrix(2))
    s[-1] = smallest
    pair = null_pair(sparse.csc_matrix(u @ np.diag(s) @ vt))
    assert abs(pair.right @ vt[-1]) == pytest.approx(1.0, abs=1e-6)
    assert abs(pair.left @ u[:, -1]) == pytest.approx(1.0, abs=1e-6)


def test_singularity_is_the_smallest_singular_value_near_zero():
    u, s, vt = np.linalg.svd(matrix(2))
    s[-1] = 1e-4
    A = sparse.csc_matrix(u @ np.diag(s) @ vt)
    assert abs(singularity(A, null_pair(A))) == pytest.approx(1e-4, rel=1e-6)
