from dataclasses import replace

import casadi as ca
import numpy as np
import planar_body
import pytest

from gaitlab.errors import ProblemError


@pytest.mark.parametrize("name", ["outputs", "positions", "velocities"])
def test_expressions_of_wrong_shape_are_refused(name):
    with pytest.raises(ProblemError, match="must have the shape"):
        replace(planar_body.planar_body(), **{name: ca.SX.sym("wrong", 7)})


@pytest.mark.parametrize(("duration", "n"), [(0.0, 2), (-1.0, 2), (0.3, 0)])
def test_empty_stages_are_refused(duration, n):
    with pytest.raises(ProblemError, match="stage 'swing' needs a positive duration"):
        planar_body.stage(duration, n, 0, label="swing")


def test_cones_on_inactive_forces_are_refused():
    stage = planar_body.stage(0.1, 1, 0)
    with pytest.raises(ProblemError, match=r"it uses \[2, 3\] too"):
        replace(stage, force_cone=np.ones((1, 4)))
