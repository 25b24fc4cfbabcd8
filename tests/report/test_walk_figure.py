import numpy as np
import pytest
from synthetic_output import MASS, walk_arrays

from gaitlab.report.walk_figure import Trace, forces_figure, heading, joints_figure, modelled_part, phase_spans
from gaitlab.report.walk_file import Walk


def walk(**changes):
    arrays = walk_arrays() | changes
    return Walk(time=arrays.pop("time"), arrays=arrays)


def test_forward_is_the_way_of_the_pelvis():
    assert heading(walk()) == pytest.approx([0.0, -1.0, 0.0], abs=0.02)


def test_phases_are_spans():
    assert phase_spans(walk())[:2] == [("right single support", 0.0, 0.4), ("double support", 0.4, 0.8)]


def test_only_modelled_frames_are_drawn():
    q = np.full((241, 24), np.nan)
    q[50:161] = 0.1
    part = modelled_part(walk(q_optimal=q))
    assert (part.time[0], part.time[-1]) == (0.5, 1.6)
    assert len(part.arrays["phase"]) == 111 and len(part.names("contact_names")) == 4


@pytest.mark.parametrize(("mass", "unit"), [(MASS, "% body weight"), (None, "[N]")])
def test_forces_have_a_unit(mass, unit):
    assert unit in forces_figure(walk(), mass)


def test_joints_are_named_after_their_segments():
    drawn = joints_figure(walk())
    assert all(f">{joint} about y (sagittal) [deg]<" in drawn for joint in ("Pelvis", "Hip", "Knee", "Ankle"))


def test_scales_do_not_follow_the_data():
    small, large = (joints_figure(walk(q_measured=np.full((241, 24), v), q_optimal=np.zeros(0))) for v in (0.01, 2.0))
    assert small.count('class="tick"') == large.count('class="tick"')
    assert "leaves scale: 115 to 115" in large and "leaves scale" not in small


def test_side_and_kind_of_a_curve_are_told_without_colour():
    styles = {
        (side, model): Trace(values=np.zeros(0), side=side, modelled=model).style["stroke_dasharray"]
        for side in ("left", "right")
        for model in (False, True)
    }
    assert len(set(styles.values())) == 4


def test_without_forces_there_is_no_picture():
    none = walk(forces_optimal=np.zeros((0,)), grf_plates=np.zeros((241, 0, 3)))
    assert forces_figure(none, MASS) is None
