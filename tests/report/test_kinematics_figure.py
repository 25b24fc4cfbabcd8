import numpy as np

from gaitlab.clinical.document import CURVES
from gaitlab.report.colours import SIDE
from gaitlab.report.kinematics_figure import PANELS, Marks, average_figure
from gaitlab.report.result import Curve


def flat(value):
    return Curve(mean=np.full(101, value), sd=None, n_cycles=1)


def panel(markup, name):
    return markup.split(f'data-curve="{name}"')[1].split("</g>")[0]


def test_every_curve_of_the_contract_has_its_place():
    assert [p.name for p in PANELS] == list(CURVES)
    assert len({(p.row, p.column) for p in PANELS}) == 9


def test_columns_are_planes():
    columns = {p.name: p.column for p in PANELS}
    assert [columns[name] for name in ("hip_flexion", "hip_adduction", "hip_rotation")] == [0, 1, 2]
    assert columns["ankle_dorsiflexion"] == 0 and columns["foot_progression"] == 2


def test_scales_do_not_follow_the_data():
    small, large = (average_figure({"knee_flexion": {"left": flat(v)}}, {}) for v in (1.0, 60.0))
    assert small.count('class="tick"') == large.count('class="tick"')


def test_sides_have_their_colours():
    drawn = panel(average_figure({"knee_flexion": {"left": flat(5.0)}}, {}), "knee_flexion")
    assert SIDE["left"] in drawn and SIDE["right"] not in drawn


def test_foot_off_stands_at_its_percent_in_the_side_colour():
    marks = {"right": Marks(foot_off=50.0)}
    drawn = panel(average_figure({"pelvis_tilt": {"right": flat(5.0)}}, marks), "pelvis_tilt")
    axes = PANELS[0].axes
    assert f'x1="{axes.x(50.0):g}"' in drawn and f'stroke="{SIDE["right"]}"' in drawn


def test_a_curve_that_leaves_the_scale_is_told():
    drawn = panel(average_figure({"knee_flexion": {"left": flat(95.0)}}, {}), "knee_flexion")
    assert "leaves scale: 95 to 95" in drawn


def test_a_missing_curve_is_told():
    assert "no data" in panel(average_figure({}, {}), "hip_rotation")
