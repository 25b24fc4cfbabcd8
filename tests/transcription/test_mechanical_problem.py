"""Values by hand and derivatives by finite differences, of a planar body that pushes off, flies and lands."""

from dataclasses import replace

import numpy as np
import planar_body
import pytest

from gaitlab.nlp.interior_point import InteriorPoint
from gaitlab.transcription.hermite import GAUSS_POINTS
from gaitlab.transcription.mechanical_layout import Boundary

STEP = 1e-6
BOUNDARY = Boundary(((0, (0, 1, 2, 3, 4, 5)), (5, (0, 4))))


@pytest.fixture(scope="module")
def generator():
    return np.random.default_rng(3)


@pytest.fixture(scope="module")
def problem(generator):
    layout = planar_body.layout(planar_body.steps(), boundary=BOUNDARY, limited=(1, 2))
    return planar_body.problem(
        layout,
        theta=np.array([0.7, 1.3, 0.2]),
        reference=generator.normal(size=(6, 6)),
        tracking=generator.uniform(size=(6, 6)),
        given=generator.normal(size=(6, 6)),
        acceleration_weights=np.array([0.3, 0.0, 0.9]),
        force_weight=0.4,
        allowance=0.01,
    )


@pytest.fixture(scope="module")
def point(problem, generator):
    s = problem.structure
    return 0.3 * generator.normal(size=s.n_w), generator.normal(size=s.n_g), generator.uniform(0.1, 2, size=s.n_c)


def dense(pattern, entries, shape):
    matrix = np.zeros(shape)
    np.add.at(matrix, pattern, entries)
    return matrix


def differences(function, w):
    """Jacobian of a function of w by central differences."""
    columns = [(function(w + e) - function(w - e)) / (2 * STEP) for e in STEP * np.eye(len(w))]
    return np.stack(columns, axis=-1)


def lagrangian_gradient(problem, w, lam_g, lam_c):
    s, d = problem.structure, problem.derivatives(w, lam_g, lam_c)
    jac_g, jac_c = dense(s.jac_g, d.jac_g, (s.n_g, s.n_w)), dense(s.jac_c, d.jac_c, (s.n_c, s.n_w))
    return d.grad + jac_g.T @ lam_g - jac_c.T @ lam_c


def test_sizes(problem, point):
    s, values = problem.structure, problem.values(point[0])
    assert (len(values.g), len(values.c)) == (s.n_g, s.n_c)
    n_forces = 2 * (2 * 2 + 0 + 2 * 3)
    assert s.n_w == 6 * 6 + n_forces
    assert s.blocks.sum() == s.n_w + s.n_g


def test_gradient(problem, point):
    expected = differences(lambda w: problem.values(w).f, point[0])
    np.testing.assert_allclose(problem.derivatives(*point).grad, expected, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("name", ["g", "c"])
def test_jacobians(problem, point, name):
    s = problem.structure
    expected = differences(lambda w: getattr(problem.values(w), name), point[0])
    pattern, entries = getattr(s, f"jac_{name}"), getattr(problem.derivatives(*point), f"jac_{name}")
    np.testing.assert_allclose(dense(pattern, entries, expected.shape), expected, rtol=1e-6, atol=1e-6)


def test_hessian_of_the_lagrangian(problem, point):
    w, lam_g, lam_c = point
    expected = differences(lambda w: lagrangian_gradient(problem, w, lam_g, lam_c), w)
    found = dense(problem.structure.hess, problem.derivatives(*point).hess, expected.shape)
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(found, found.T, atol=1e-12)


def test_gradients_of_the_criteria(problem, point):
    expected = differences(problem.criteria, point[0]).T
    np.testing.assert_allclose(problem.criterion_gradients(point[0]), expected, rtol=1e-6, atol=1e-6)


def test_only_neighbouring_blocks_are_coupled(problem):
    """What the block elimination of the inertia relies on."""
    s = problem.structure
    place = np.empty(s.n_w + s.n_g, dtype=int)
    place[s.order] = np.repeat(np.arange(len(s.blocks)), s.blocks)
    c_of = [place[s.jac_c.cols[s.jac_c.rows == row]] for row in range(s.n_c)]
    assert np.abs(place[s.hess.rows] - place[s.hess.cols]).max() <= 1
    assert np.abs(place[s.n_w + s.jac_g.rows] - place[s.jac_g.cols]).max() <= 1
    assert max(np.ptp(blocks) for blocks in c_of) <= 1


def test_objective_by_hand(problem, point):
    """Gauss quadrature of the criteria, the accelerations and the forces on top of the tracking errors."""
    w, d = point[0], problem.data
    layout = problem.shared.layout
    lengths, stages = np.repeat(layout.interval_lengths(), 2), np.repeat(layout.stage_of_interval(), 2)
    x = problem.states(w)
    f = 0.5 * np.sum(d.tracking * (x - d.reference) ** 2)
    for z, h, index in zip(problem.points(w), lengths, stages, strict=True):
        q, v, a, force = z[:3], z[3:6], z[6:9], z[9:]
        c, s = np.cos(q[2]), np.sin(q[2])
        levers = planar_body.FEET @ np.array([[c, s], [-s, c]])
        torque = 0.3 * a[2] - sum(r[0] * g[1] - r[1] * g[0] for r, g in zip(levers, force.reshape(2, 2), strict=True))
        weight = layout.stages[index].data[0]
        criteria = [torque**2, weight * (q[0] * c) ** 2 * np.exp(v[0]), (torque * v[2]) ** 2 + 2.0 * v[1] ** 4]
        f += h / 2 * (d.theta @ criteria + 0.5 * d.acceleration_weights @ a**2 + 0.5 * d.force_weight * force @ force)
    assert problem.values(w).f == pytest.approx(f, rel=1e-12)


def test_points_lie_on_the_cubic_through_the_states(problem):
    """States and forces sampled from cubics in time are met exactly."""
    layout = problem.shared.layout
    t = layout.node_times()
    cubics = [np.polynomial.Polynomial(c) for c in np.random.default_rng(0).normal(size=(3, 4))]
    states = np.array([[c(t) for c in cubics], [c.deriv()(t) for c in cubics]]).reshape(6, -1).T
    w = np.concatenate([states.ravel(), np.zeros(problem.structure.n_w - states.size)])
    inside = (t[:-1, None] + layout.interval_lengths()[:, None] * GAUSS_POINTS).ravel()
    expected = np.array([c.deriv(order)(inside) for order in range(3) for c in cubics]).T
    np.testing.assert_allclose(problem.points(w)[:, :9], expected, atol=1e-11)


def test_inactive_forces_vanish(problem, point):
    forces = problem.points(point[0])[:, 9:].reshape(5, 2, 4)
    assert not forces[:2, :, 2:].any()
    assert not forces[2].any()
    assert not forces[3:, :, 2].any()
    assert forces[:2, :, :2].all()


def test_standing_on_both_feet_carries_the_weight():
    """At rest without torque, the law of the lever distributes the weight over the feet."""
    posture = np.array([0.0, 0.5, 0.0, 0.0, 0.0, 0.0])
    layout = planar_body.layout((planar_body.stage(0.5, 3, 0, 1),), boundary=Boundary(((0, tuple(range(6))),)))
    standing = planar_body.problem(layout, given=np.tile(posture, (4, 1)))
    start = np.concatenate([np.tile(posture, 4), np.ones(standing.structure.n_w - 24)])
    solution = InteriorPoint().solve(standing, start)
    assert solution.is_optimal(1e-7)
    forces = standing.points(solution.w)[:, 9:]
    weight, (rear, front) = 2.0 * 9.81, planar_body.FEET[:, 0]
    expected = np.array([0.0, weight * front / (front - rear), 0.0, -weight * rear / (front - rear)])
    np.testing.assert_allclose(forces, np.tile(expected, (6, 1)), atol=1e-5)
    np.testing.assert_allclose(standing.states(solution.w), np.tile(posture, (4, 1)), atol=1e-8)


def balancing_on_the_rear_foot(angle):
    """State at rest with the rear foot at the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([*(-np.array([[c, -s], [s, c]]) @ planar_body.FEET[0]), angle, 0.0, 0.0, 0.0])


def test_stepping_down_meets_every_condition():
    """From balance on the rear foot to a soft landing of the front foot: contacts, clearance, limits, friction."""
    first = balancing_on_the_rear_foot(0.3)
    stages = (
        planar_body.stage(0.4, 4, 0, clear=(3,)),
        planar_body.stage(0.2, 2, 0, 1, landing=(3,), grounded=(3,)),
    )
    layout = planar_body.layout(stages, boundary=Boundary(((0, tuple(range(6))),)), limited=(2,))
    step = planar_body.problem(layout, given=np.tile(first, (7, 1)), force_weight=1e-3, upper=np.full(3, 0.35))
    start = np.concatenate([np.tile(first, 7), np.full(step.structure.n_w - 42, 5.0)])
    solution = InteriorPoint().solve(step, start)
    assert solution.is_optimal(1e-6), solution
    states, z = step.states(solution.w), step.points(solution.w)
    forces = z[:, 9:].reshape(-1, 2, 2)
    np.testing.assert_allclose(2.0 * (z[:, 6:8] + [0, 9.81]), forces.sum(axis=1), atol=1e-6)
    assert np.all(forces[:, :, 1] > -1e-7)
    assert np.all(np.abs(forces[:, 0, 0]) <= planar_body.FRICTION * forces[:, 0, 1] + 1e-6)
    assert np.all(states[:, 2] <= 0.35 + 1e-7)
    np.testing.assert_allclose(states[0], first, atol=1e-7)
    for node, state in enumerate(states):
        balanced = balancing_on_the_rear_foot(state[2])
        np.testing.assert_allclose(state[:3], balanced[:3], atol=1e-6)
        assert node == 0 or node >= 4 or state[2] > 0.0
    np.testing.assert_allclose(states[4:], [balancing_on_the_rear_foot(0.0)] * 3, atol=1e-6)


def test_the_gauss_newton_hessian_of_convex_criteria_is_positive_semidefinite(problem, point):
    w, lam_g, lam_c = point
    s = problem.structure
    # The first criterion is a square.
    squares = replace(problem, data=replace(problem.data, theta=np.array([0.7, 0.0, 0.0])))
    d = squares.derivatives(w, lam_g, lam_c)
    first_term, whole = (dense(s.hess, entries, (s.n_w, s.n_w)) for entries in (d.gauss_newton(), d.hess))
    np.testing.assert_allclose(first_term, first_term.T, atol=1e-12)
    size = np.linalg.eigvalsh(first_term)[-1]
    assert np.linalg.eigvalsh(first_term)[0] >= -1e-12 * size
    assert np.linalg.eigvalsh(whole)[0] < -1e-6 * size
    again = squares.derivatives(w, 2.0 * lam_g, lam_c)
    np.testing.assert_allclose(again.gauss_newton(), d.gauss_newton(), atol=1e-12)
