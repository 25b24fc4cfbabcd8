import numpy as np
import pytest

from gaitlab.errors import OutputError
from gaitlab.pipelines.output import angle_columns, make_folder, write_table


def test_unknown_values_become_empty_cells(tmp_path):
    write_table(tmp_path / "t.csv", np.array([0.0, 0.01]), {"a": np.array([1.0, np.nan])}, 3)
    assert (tmp_path / "t.csv").read_text() == "time,a\n0.000000,1.000\n0.010000,\n"


def test_angles_are_written_in_degrees():
    names = angle_columns(dict.fromkeys(_all_curves(), np.array([np.pi])))
    assert names["left_hip_flexion"] == pytest.approx([180.0])


def test_a_folder_is_made_with_its_parents(tmp_path):
    make_folder(tmp_path / "a" / "b")
    assert not list((tmp_path / "a" / "b").iterdir())


def test_a_file_in_the_way_is_refused(tmp_path):
    (tmp_path / "a").touch()
    with pytest.raises(OutputError, match="choose a folder"):
        make_folder(tmp_path / "a")


def _all_curves():
    joints = "pelvis_tilt pelvis_obliquity pelvis_rotation hip_flexion hip_adduction hip_rotation"
    rest = "knee_flexion ankle_dorsiflexion foot_progression"
    return [f"{side}_{curve}" for side in ("left", "right") for curve in (joints + " " + rest).split()]
