import numpy as np
import pytest
from synthetic_output import document, walk_arrays, write_output

from gaitlab.errors import OutputError
from gaitlab.report.walk_file import read_curves, read_walk


def test_arrays_of_the_wrong_shape_read_as_missing(tmp_path):
    arrays = walk_arrays() | {"markers": np.zeros((241, 5)), "forces_optimal": np.zeros((3, 4, 3))}
    walk = read_walk(write_output(tmp_path, document(), arrays))
    assert walk.vectors("markers") is None and walk.vectors("forces_optimal") is None
    assert walk.vectors("grf_plates").shape == (241, 2, 3)


@pytest.mark.parametrize("time", [np.zeros(0), np.array([0.0, np.nan]), np.array(["a"]), np.zeros((2, 2))])
def test_a_walk_without_time_is_refused(tmp_path, time):
    with pytest.raises(OutputError, match="no usable 'time'"):
        read_walk(write_output(tmp_path, document(), {"time": time}))


def test_pickled_objects_are_refused(tmp_path):
    with pytest.raises(OutputError, match="not a readable archive"):
        read_walk(write_output(tmp_path, document(), {"time": np.array([{}], dtype=object)}))


def test_empty_cells_of_the_angles_are_gaps(tmp_path):
    (tmp_path / "angles.csv").write_text("time,left_hip_flexion\n0.0,1.5\n0.01,\n")
    angles = read_curves(tmp_path / "angles.csv")
    assert angles.curves["left_hip_flexion"][0] == 1.5 and np.isnan(angles.curves["left_hip_flexion"][1])


@pytest.mark.parametrize("content", ["", "time,a\n0.0,b\n", "a,b\n1,2\n", "time,a\n1\n1,2\n"])
def test_angles_that_are_no_table_are_refused(tmp_path, content):
    (tmp_path / "angles.csv").write_text(content)
    with pytest.raises(OutputError, match="run 'gaitlab analyse' again"):
        read_curves(tmp_path / "angles.csv")
