import numpy as np

from gaitlab.signal.runs import runs, valid_rows


def test_runs_at_the_ends_and_in_the_middle():
    assert runs(np.array([True, True, False, True, False, True])) == [(0, 2), (3, 4), (5, 6)]
    assert runs(np.zeros(3, dtype=bool)) == []


def test_a_row_is_valid_when_all_of_it_is():
    x = np.ones((3, 2, 2))
    x[1, 0, 1] = np.nan
    assert valid_rows(x).tolist() == [True, False, True]
