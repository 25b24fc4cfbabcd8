import numpy as np
from raw_file import raw_recording

from gaitlab.mocap.raw import load_raw, save_raw


def test_what_is_saved_is_loaded(tmp_path):
    save_raw(tmp_path / "raw.npz", raw_recording())
    loaded = load_raw(tmp_path / "raw.npz")
    np.testing.assert_array_equal(loaded.points, raw_recording().points)
    np.testing.assert_array_equal(loaded.analog, raw_recording().analog)
    assert (loaded.labels, loaded.rate, loaded.first_frame, loaded.analog_rate) == (("A", "Bé"), 100.0, 7, 200.0)
    assert loaded.numbers("POINT", "X").shape == (3, 4, 2)


def test_numbered_parameters_are_joined():
    assert raw_recording().numbered_texts("POINT", "LABELS") == ("A", "B", "C")


def test_missing_parameters_are_empty():
    assert raw_recording().texts("NO", "NAME") == ()
    assert raw_recording().texts("POINT", "X") == ()
    assert raw_recording().numbers("POINT", "LABELS").size == 0
