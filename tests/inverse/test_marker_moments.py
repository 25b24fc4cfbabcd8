"""Gradient and Gauss-Newton matrix against finite differences of the markers' residuals."""

from dataclasses import replace

import numpy as np
import pytest

from gaitlab.inverse.marker_moments import gauss_newton_matrix, marker_moments, marker_slope
from gaitlab.multibody.kinematics import point_positions
from gaitlab.multibody.presets import thesis_cp_child
from gaitlab.multibody.subject import PointOnSegment

WEIGHTS = {"m4": 3.0}


@pytest.fixture(scope="module")
def case():
    """27 coordinates, 30 markers at random places with one gap, 4 frames."""
    generator = np.random.default_rng(0)
    points = {f"m{i}": PointOnSegment(segment=i % 8, position=generator.normal(size=3)) for i in range(30)}
    measured = {name: generator.normal(size=(4, 3)) for name in points}
    measured["m3"][2] = np.nan
    return replace(thesis_cp_child(trunk_joint=True), markers=points), measured, generator.normal(size=(4, 27))


def residuals(subject, measured, q):
    model = point_positions(subject, subject.markers, q)
    rows = [np.sqrt(WEIGHTS.get(name, 1.0)) * np.nan_to_num(model[name] - measured[name]) for name in measured]
    return np.concatenate(rows, axis=1)


def test_slope_and_matrix(case):
    subject, measured, q = case
    moments = marker_moments(subject, subject.markers, measured, WEIGHTS)
    slope, r = marker_slope(subject, moments, q), residuals(subject, measured, q)
    steps = 1e-6 * np.eye(subject.n_q)
    columns = [(residuals(subject, measured, q + h) - residuals(subject, measured, q - h)) / 2e-6 for h in steps]
    J = np.stack(columns, axis=2)
    np.testing.assert_allclose(slope.cost, (r**2).sum(axis=1), atol=1e-11)
    np.testing.assert_allclose(slope.gradient, np.einsum("nri,nr->ni", J, r), atol=1e-6)
    matrix = gauss_newton_matrix(subject, moments, slope)
    np.testing.assert_allclose(matrix, np.einsum("nri,nrj->nij", J, J), atol=1e-6)
