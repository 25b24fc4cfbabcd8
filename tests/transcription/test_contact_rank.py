"""Exactly the contact conditions that follow from others are left out."""

import numpy as np
import planar_body
import pytest

from gaitlab.transcription.contact_rank import without_redundant_contacts
from gaitlab.transcription.mechanical_layout import Boundary

POSTURE = (0, 1, 2)
STANDING = np.array([0.1, 0.5, 0.0, 0.0, 0.0, 0.0])


def position_rows(layout):
    return [row for row in layout.contact_equalities() if row.component < layout.n_f]


def free_rank(layout):
    """Rank of the position conditions together with the given postures, minus that of the latter."""
    problem = planar_body.problem(layout)
    s = problem.structure
    w = np.concatenate([np.tile(STANDING, layout.n_intervals + 1), np.zeros(s.n_w)])[: s.n_w]
    derivatives = problem.derivatives(w, np.zeros(s.n_g), np.zeros(s.n_c))
    jacobian = np.zeros((s.n_g, s.n_w))
    np.add.at(jacobian, s.jac_g, derivatives.jac_g)
    first = 2 * layout.n_intervals * layout.n_r
    rows = layout.contact_equalities()
    positions = [first + i for i, row in enumerate(rows) if row.component < layout.n_f]
    fixed = list(range(first + len(rows), s.n_g))
    rank = np.linalg.matrix_rank(jacobian[positions + fixed]) if positions + fixed else 0
    return rank - len(fixed)


def reduced(stages, given):
    layout = planar_body.layout(stages, boundary=Boundary(tuple((node, POSTURE) for node in given)))
    states = np.tile(STANDING, (layout.n_intervals + 1, 1))
    return layout, without_redundant_contacts(layout, planar_body.FUNCTIONS, planar_body.PARAMETERS, states)


BOTH_FEET = planar_body.stage(0.4, 4, 0, 1)
REAR_THEN_BOTH = (planar_body.stage(0.2, 2, 0), planar_body.stage(0.3, 3, 0, 1, grounded=(3,)))
CASES = {
    "free posture": ((BOTH_FEET,), ()),
    "one given posture": ((BOTH_FEET,), (0,)),
    "both ends given": ((BOTH_FEET,), (0, 4)),
    "given within": ((BOTH_FEET,), (0, 2, 4)),
    "neighbours given": ((BOTH_FEET,), (1, 2)),
    "landing": (REAR_THEN_BOTH, (0, 5)),
    "landing where the end is free": (REAR_THEN_BOTH, (0, 2)),
}


@pytest.mark.parametrize("name", CASES)
def test_the_rest_is_independent_and_as_strong(name):
    layout, smaller = reduced(*CASES[name])
    rank = free_rank(layout)
    assert len(position_rows(smaller)) == rank == free_rank(smaller)
    assert len(position_rows(layout)) - rank == len(smaller.redundant)


def test_how_many_rows_are_redundant():
    """Three conditions per interval; between two given postures one interval's worth follows from the others."""
    assert not reduced((BOTH_FEET,), ())[1].redundant
    assert len(reduced((BOTH_FEET,), (0, 4))[1].redundant) == 3
    assert len(reduced((BOTH_FEET,), (0, 2, 4))[1].redundant) == 6


def test_without_contacts_nothing_happens():
    layout, smaller = reduced((planar_body.stage(0.3, 2),), (0, 2))
    assert smaller is layout
