"""Index tables by hand, on steps of the planar body: 2 intervals on the rear foot, 1 of flight, 2 on both feet."""

import numpy as np
import planar_body
import pytest

from gaitlab.errors import ProblemError
from gaitlab.transcription.mechanical_layout import Boundary, ContactRow


def row(component, node, minus_node=-1):
    return ContactRow(component=component, node=node, minus_node=minus_node)


@pytest.fixture
def layout():
    return planar_body.layout(planar_body.steps(), boundary=Boundary(((0, (0, 1, 2, 3, 4, 5)),)), limited=(2,))


def test_a_layout_needs_a_stage():
    with pytest.raises(ProblemError, match="at least one stage"):
        planar_body.layout(())


def test_times(layout):
    np.testing.assert_allclose(layout.node_times(), [0, 0.15, 0.3, 0.4, 0.5, 0.6])
    assert layout.stage_of_interval().tolist() == [0, 0, 1, 2, 2]


def test_unknowns_are_states_then_active_forces(layout):
    forces = layout.force_index()
    assert forces[0].tolist() == [[36, 37, -1, -1], [38, 39, -1, -1]]
    assert np.all(forces[2] == -1)
    assert forces[3, 0].tolist() == [44, 45, -1, 46]
    assert layout.point_index()[1, 0].tolist() == [*range(6, 18), 40, 41, -1, -1]


def test_contact_conditions(layout):
    """Held from node to node, in place and at rest; landings at rest on the ground; nothing at the given start."""
    held = [row(0, 1, 0), row(1, 1, 0), row(0, 2, 1), row(1, 2, 1)]
    held += [row(i, node, node - 1) for node in (4, 5) for i in (0, 1, 3)]
    at_rest = [row(4 + i, node) for node in (1, 2) for i in (0, 1)]
    at_rest += [row(4 + i, node) for node in (3, 4, 5) for i in (0, 1, 3)]
    expected = [*held, *at_rest, row(1, 3), row(3, 3)]
    found = layout.contact_equalities()
    assert len(found) == len(expected)
    assert set(found) == set(expected)


def test_clearances_end_where_feet_land(layout):
    assert layout.clearances() == [row(3, 1), row(3, 2)]


def test_limits_where_coordinates_are_free(layout):
    assert layout.limit_columns().tolist() == [6 * node + 2 for node in range(1, 6)]


def test_cones_act_on_the_forces_of_every_point(layout):
    rows, columns, values = layout.cone_rows()
    n_rows = 2 * (2 * 3 + 0 + 2 * 4)
    dense = np.zeros((n_rows, 36 + 2 * (2 * 2 + 2 * 3)))
    np.add.at(dense, (rows, columns), values)
    w = np.zeros(dense.shape[1])
    w[40:42] = 2.0, 3.0  # Second interval, first point: (x, z) of the rear foot.
    np.testing.assert_allclose((dense @ w)[6:9], [3.0, 2.0 + 0.8 * 3.0, -2.0 + 0.8 * 3.0])
    assert np.count_nonzero(dense @ w) == 3
