"""The thesis's two children at full size: known weights come back from simulated measurements."""

import numpy as np
import pytest

from gaitlab.errors import NotFound
from gaitlab.nlp.workers import Workers
from gaitlab.pipelines.gait_benchmark import COLUMNS, rows, solve_case
from gaitlab.pipelines.gait_cases import CASES, load_case


def test_an_unknown_model_is_named_with_the_known_ones():
    with pytest.raises(NotFound, match="cp-child"):
        load_case("nobody")


@pytest.fixture(scope="module", params=CASES)
def run(request):
    with Workers(2) as workers:
        return solve_case(load_case(request.param), noise=1.0, seed=1, workers=workers)


@pytest.mark.slow
def test_weights_come_back_with_one_degree_of_noise(run):
    assert run.certified
    assert run.error <= 0.01
    assert run.estimate.rms == pytest.approx(1.0, abs=0.1)
    assert np.sqrt(np.diag(run.estimate.covariance)).max() <= 0.05


@pytest.mark.slow
def test_the_table_has_the_thesis_beside_ours(run):
    table = rows(run)
    assert all(len(row) == len(COLUMNS) for row in table)
    assert table[-4][:2] == ("seconds", f"{run.case.thesis.seconds:.6g}")


@pytest.mark.slow
def test_torques_stay_within_the_thesis_limits(run):
    assert run.optimum.largest_torque() <= 500.0
