import numpy as np

from gaitlab.report.kinematics_figure import Norms
from gaitlab.report.kinetics_figure import PANELS, kinetics_figure
from gaitlab.report.result import Curve

BAND = Curve(mean=np.zeros(101), sd=np.full(101, 0.1), n_cycles=82)


def test_bands_are_drawn_where_the_cohort_has_them():
    norms = Norms(description="Cohort, n = 82, speed: free", curves={"hip_power": BAND, "knee_flexion": BAND})
    markup = kinetics_figure({}, {}, norms)
    parts = {p.name: markup.split(f'data-curve="{p.name}"')[1].split("</g>")[0] for p in PANELS}
    drawn = {name for name, part in parts.items() if "<polygon" in part}
    assert drawn == {"hip_power"}
    assert (
        "grey: mean ± 1 SD of Cohort, n = 82," in markup
        and "no norms of: hip moment, sagittal, internal; knee" in markup
    )


def test_a_cohort_of_angles_alone_has_no_band_here():
    markup = kinetics_figure({}, {}, Norms(description="Cohort", curves={"knee_flexion": BAND}))
    assert "no normative band" in markup and "<polygon" not in markup


def test_moments_stand_in_rows_of_one_plane():
    rows = {p.name: p.axes.top for p in PANELS}
    assert rows["hip_extensor_moment"] == rows["knee_extensor_moment"] < rows["hip_abductor_moment"]
    assert rows["hip_abductor_moment"] == rows["knee_abductor_moment"] == rows["ankle_evertor_moment"]
    assert [p.x_label for p in PANELS] == [False] * 9 + [True] * 3
