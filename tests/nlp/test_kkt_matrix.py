"""Assembly, factorisation and inertia of block tridiagonal KKT systems against dense linear algebra."""

import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.nlp.kkt_matrix import KKTAssembly
from gaitlab.nlp.sparse_problem import Pattern, SparseStructure, multiply, multiply_transposed, pairs_in_rows

N_STAGES, N_X, N_G, N_C = 7, 4, 2, 3
DENSE = np.array([N_X, N_G, N_C])


class Chain:
    """Random problem of stages of which only neighbours are coupled."""

    def __init__(self, seed):
        self.generator = np.random.default_rng(seed)
        n_w, n_g, n_c = N_STAGES * DENSE
        stage = np.arange(N_STAGES)
        unknowns = [np.repeat(stage, N_X), np.repeat(stage, N_G)]
        rows, cols = np.indices((n_w, n_w)).reshape(2, -1)
        near = np.abs(rows // N_X - cols // N_X) <= 1
        self.structure = SparseStructure(
            n_w=n_w,
            n_g=n_g,
            n_c=n_c,
            jac_g=self.jacobian(N_G, coupled=True),
            jac_c=self.jacobian(N_C, coupled=False),
            hess=Pattern(rows[near], cols[near]),
            order=np.argsort(np.concatenate(unknowns), kind="stable"),
            blocks=np.full(N_STAGES, N_X + N_G),
        )
        symmetric = self.generator.normal(size=(n_w, n_w))
        self.hess = (symmetric + symmetric.T)[rows[near], cols[near]]
        self.jac_g = self.generator.normal(size=len(self.structure.jac_g.rows))
        self.jac_c = self.generator.normal(size=len(self.structure.jac_c.rows))
        self.sigma = self.generator.uniform(0.1, 10.0, size=n_c)

    def jacobian(self, height, coupled):
        """Rows see their own stage and, where coupled, the one before; some entries stand twice."""
        rows, cols = np.indices((N_STAGES * height, N_STAGES * N_X)).reshape(2, -1)
        gap = rows // height - cols // N_X
        used = np.flatnonzero((gap == 0) | (coupled & (gap == 1)))
        used = np.concatenate([used, used[::5]])
        return Pattern(rows[used], cols[used])

    def entries(self):
        return self.hess, self.jac_g, self.jac_c

    def dense(self, delta):
        s = self.structure
        h, j_g, j_c = np.zeros((s.n_w, s.n_w)), np.zeros((s.n_g, s.n_w)), np.zeros((s.n_c, s.n_w))
        for matrix, pattern, entries in (
            (h, s.hess, self.hess),
            (j_g, s.jac_g, self.jac_g),
            (j_c, s.jac_c, self.jac_c),
        ):
            np.add.at(matrix, pattern, entries)
        top = h + j_c.T @ np.diag(self.sigma) @ j_c + delta[0] * np.eye(s.n_w)
        return np.block([[top, j_g.T], [j_g, -delta[1] * np.eye(s.n_g)]])


@pytest.fixture(params=range(5))
def chain(request):
    return Chain(request.param)


@pytest.mark.parametrize("delta", [(0.0, 0.0), (2.0, 1e-2)])
def test_solve(chain, delta):
    assembly = KKTAssembly(chain.structure)
    factors = assembly.factorise(assembly.shifted(assembly.matrix(chain.entries(), chain.sigma), delta))
    dense = chain.dense(delta)
    for shape in [(len(dense),), (len(dense), 3)]:
        rhs = chain.generator.normal(size=shape)
        np.testing.assert_allclose(factors.solve(rhs), np.linalg.solve(dense, rhs), rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("delta", [(0.0, 0.0), (1.0, 0.0), (4.0, 1e-3), (100.0, 0.0)])
def test_negative_eigenvalues(chain, delta):
    assembly = KKTAssembly(chain.structure)
    expected = int(np.sum(np.linalg.eigvalsh(chain.dense(delta)) < 0.0))
    factors = assembly.factorise(assembly.shifted(assembly.matrix(chain.entries(), chain.sigma), delta))
    assert factors.negative_eigenvalues == expected
    if delta[0] == 100.0:
        assert expected == chain.structure.n_g


def test_the_order_along_time_makes_the_band_narrow(chain):
    assert KKTAssembly(chain.structure).bandwidth < 2 * (N_X + N_G)


@pytest.mark.parametrize("value", [0.0, np.nan, np.inf])
def test_singular_and_infinite_matrices_have_no_factors(chain, value):
    assembly = KKTAssembly(chain.structure)
    matrix = assembly.matrix((0 * chain.hess, 0 * chain.jac_g, 0 * chain.jac_c), chain.sigma)
    assert assembly.factorise(matrix + value) is None


def test_products_with_sparse_matrices(chain):
    s = chain.structure
    dense = np.zeros((s.n_g, s.n_w))
    np.add.at(dense, s.jac_g, chain.jac_g)
    x, y = chain.generator.normal(size=s.n_w), chain.generator.normal(size=s.n_g)
    np.testing.assert_allclose(multiply(s.jac_g, chain.jac_g, x, s.n_g), dense @ x, atol=1e-12)
    np.testing.assert_allclose(multiply_transposed(s.jac_g, chain.jac_g, y, s.n_w), dense.T @ y, atol=1e-12)


def test_diagonal_matrices():
    """A separable problem in one block: its band is the diagonal."""
    none, i, nothing = Pattern(np.zeros(0, int), np.zeros(0, int)), np.arange(3), np.zeros(0)
    settings = {"n_w": 3, "n_g": 0, "n_c": 0, "jac_g": none, "jac_c": none, "order": i, "blocks": np.array([3])}
    assembly = KKTAssembly(SparseStructure(hess=Pattern(i, i), **settings))
    for diagonal, expected in [([4.0, 1.0, 1.0], 0), ([4.0, -1.0, -1.0], 2)]:
        factors = assembly.factorise(assembly.matrix((np.array(diagonal), nothing, nothing), nothing))
        assert factors.negative_eigenvalues == expected


def test_orders_that_are_no_permutations_are_refused(chain):
    wrong = SparseStructure(**(vars(chain.structure) | {"order": np.zeros_like(chain.structure.order)}))
    with pytest.raises(ProblemError, match="permutation of 42"):
        _ = KKTAssembly(wrong).position


def test_pairs_in_rows():
    rows, entries = np.array([2, 0, 2, 3]), np.array([10, 11, 12, 13])
    pairs = set(zip(*(column.tolist() for column in pairs_in_rows(rows, entries)), strict=True))
    assert pairs == {(0, 11, 11), (2, 10, 10), (2, 10, 12), (2, 12, 10), (2, 12, 12), (3, 13, 13)}
    assert all(len(column) == 0 for column in pairs_in_rows(rows[:0], entries[:0]))


def test_a_block_that_is_singular_alone_has_no_elimination(chain):
    assembly = KKTAssembly(chain.structure)
    # The first variable of the first block is in nothing.
    first = (chain.structure.hess.rows == 0) | (chain.structure.hess.cols == 0)
    entries = np.where(first, 0.0, chain.hess), np.where(chain.structure.jac_g.cols == 0, 0.0, chain.jac_g)
    jac_c = np.where(chain.structure.jac_c.cols == 0, 0.0, chain.jac_c)
    assert assembly.factorise(assembly.matrix((*entries, jac_c), chain.sigma)) is None


def test_pivoting_across_blocks_takes_over_where_elimination_loses_digits(chain):
    """A tiny first pivot: elimination alone is off, the answer is not."""
    none, i = Pattern(np.zeros(0, int), np.zeros(0, int)), np.array([0, 0, 1])
    structure = SparseStructure(
        n_w=2, n_g=0, n_c=0, jac_g=none, jac_c=none, order=np.arange(2), blocks=np.array([1, 1]),
        hess=Pattern(np.append(i, 1), np.array([0, 1, 0, 1])),
    )  # fmt: skip
    assembly, nothing = KKTAssembly(structure), np.zeros(0)
    factors = assembly.factorise(assembly.matrix((np.array([1e-30, 1.0, 1.0, 1.0]), nothing, nothing), nothing))
    np.testing.assert_allclose(factors.solve(np.array([1.0, 2.0])), [1.0, 1.0], atol=1e-12)


def test_a_matrix_that_is_singular_to_rounding_solves_nothing():
    none = Pattern(np.zeros(0, int), np.zeros(0, int))
    structure = SparseStructure(
        n_w=2, n_g=0, n_c=0, jac_g=none, jac_c=none, order=np.arange(2), blocks=np.array([2]),
        hess=Pattern(np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])),
    )  # fmt: skip
    assembly, nothing = KKTAssembly(structure), np.zeros(0)
    factors = assembly.factorise(assembly.matrix((np.array([1.0, 1.0, 1.0, 1.0 + 1e-16]), nothing, nothing), nothing))
    assert factors is None or factors.solve(np.array([1.0, 2.0])) is None


def test_far_couplings_are_refused(chain):
    s = chain.structure
    far = Pattern(np.append(s.hess.rows, s.n_w - 1), np.append(s.hess.cols, 0))
    assembly = KKTAssembly(SparseStructure(**(vars(s) | {"hess": far})))
    with pytest.raises(ProblemError, match="neighbouring blocks"):
        _ = assembly.blocks


def test_bad_scaling_is_not_taken_for_a_singular_matrix():
    """A barrier weight of 1e18 beside a curvature of one."""
    none, i = Pattern(np.zeros(0, int), np.zeros(0, int)), np.arange(2)
    structure = SparseStructure(
        n_w=2, n_g=0, n_c=0, jac_g=none, jac_c=none, order=i, blocks=np.array([1, 1]), hess=Pattern(i, i)
    )
    assembly, nothing = KKTAssembly(structure), np.zeros(0)
    factors = assembly.factorise(assembly.matrix((np.array([1e18, 1.0]), nothing, nothing), nothing))
    np.testing.assert_allclose(factors.solve(np.array([[0.0, 1e18], [1.0, 0.0]])), [[0.0, 1.0], [1.0, 0.0]])
