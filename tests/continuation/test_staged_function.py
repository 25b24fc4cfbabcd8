"""Stages: values, and all derivatives against finite differences."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.continuation.staged_function import BlockFunction, PickedUnknown, StagedFunction
from gaitlab.errors import ProblemError

STEP = 1e-6


def block():
    z, d = ca.SX.sym("z", 3), ca.SX.sym("d", 1)
    return BlockFunction(z, ca.vertcat(ca.sin(z[0]) * z[1] + d, z[1] * z[2] ** 2), d)


def stage(**options):
    settings = {
        "name": "s",
        "block": block(),
        "inputs": np.array([[0, 1, 2], [2, 3, 1]]),
        "outputs": np.array([[0, 1], [0, 2]]),
        "data": np.array([[0.5], [2.0]]),
    }
    return StagedFunction(**(settings | options))


STAGES = {"blocks": stage(), "picked": PickedUnknown(name="p", index=2)}


def dense(entries, shape):
    matrix = np.zeros(shape)
    np.add.at(matrix, (entries.rows, entries.cols), entries.values)
    return matrix


def differences(function, u):
    return np.array([(function(u + e) - function(u - e)) / (2 * STEP) for e in STEP * np.eye(len(u))]).T


@pytest.fixture
def u():
    return np.random.default_rng(1).normal(size=4)


def test_outputs_of_one_row_are_summed(u):
    first, second = np.sin(u[0]) * u[1] + 0.5, np.sin(u[2]) * u[3] + 2.0
    expected = [first + second, u[1] * u[2] ** 2, u[3] * u[1] ** 2]
    np.testing.assert_allclose(stage().values(u), expected, rtol=1e-14)


@pytest.mark.parametrize("kind", STAGES)
def test_jacobian(kind, u):
    s = STAGES[kind]
    np.testing.assert_allclose(dense(s.jacobian(u), (s.n_rows, 4)), differences(s.values, u), atol=1e-8)


@pytest.mark.parametrize("kind", STAGES)
def test_adjoint_is_the_transposed_jacobian(kind, u):
    s = STAGES[kind]
    multipliers = np.arange(1.0, 1.0 + s.n_rows)
    expected = dense(s.jacobian(u), (s.n_rows, 4)).T @ multipliers
    np.testing.assert_allclose(s.adjoint(u, multipliers), expected, atol=1e-14)


@pytest.mark.parametrize("kind", STAGES)
def test_derivative_of_the_adjoint(kind, u):
    s = STAGES[kind]
    multipliers = np.arange(1.0, 1.0 + s.n_rows)
    expected = differences(lambda v: s.adjoint(v, multipliers), u)
    np.testing.assert_allclose(dense(s.adjoint_jacobian(u, multipliers), (4, 4)), expected, atol=1e-8)


def test_references_move(u):
    moved = stage(refresh=lambda unknowns: unknowns[:, :1]).refreshed(u)
    np.testing.assert_array_equal(moved.data, u[[[0], [2]]])


@pytest.mark.parametrize("what", ["inputs", "outputs", "data"])
def test_wrong_shapes_are_named(what):
    with pytest.raises(ProblemError, match=f"{what} of stage 's' must have shape"):
        stage(**{what: np.zeros((2, 7), dtype=int)})


def test_foreign_symbols_are_refused():
    with pytest.raises(ProblemError, match="own arguments only"):
        BlockFunction(ca.SX.sym("z"), ca.SX.sym("stranger"))
