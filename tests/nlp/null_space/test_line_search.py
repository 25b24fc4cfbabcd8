import numpy as np

from gaitlab.nlp.null_space.line_search import StepLengths, doubling_search


def test_ends_within_the_first_step_of_the_minimum():
    x = doubling_search(lambda x: (x[0] - 1.2345) ** 2, np.zeros(1), np.ones(1), StepLengths())
    assert abs(x[0] - 1.2345) < 1e-6


def test_stays_where_nothing_helps():
    start = np.ones(2)
    assert doubling_search(lambda x: float(x @ x), start, start, StepLengths()) is start


def test_values_that_are_not_numbers_are_walls():
    x = doubling_search(lambda x: -x[0] if x[0] < 2.0 else np.nan, np.zeros(1), np.ones(1), StepLengths())
    assert 2.0 - 2e-6 < x[0] < 2.0


def test_ends_though_there_is_no_bottom():
    x = doubling_search(lambda x: -x[0], np.zeros(1), np.ones(1), StepLengths())
    assert x[0] > 1e12
