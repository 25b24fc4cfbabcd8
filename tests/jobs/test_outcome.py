from pathlib import Path

import pytest

from gaitlab.errors import ProblemError
from gaitlab.jobs.computations.outcome import settings_of
from gaitlab.jobs.computations.prediction import PredictionOrder
from gaitlab.jobs.request import OWNER, Work


def work_of(settings):
    return Work(kind="predict", settings=settings, inputs=(), folder=Path())


def test_a_setting_that_nobody_reads_is_refused():
    with pytest.raises(ProblemError, match="the job predict has no setting weights; available: changes, trial"):
        settings_of(work_of({"trial": "walk1", "weights": {}}), PredictionOrder)


def test_a_setting_of_a_wrong_type_is_refused():
    with pytest.raises(ProblemError, match="cannot be used"):
        settings_of(work_of({"changes": 3}), PredictionOrder)


def test_whose_the_model_is_is_no_setting_of_the_computation():
    assert settings_of(work_of({"trial": "walk1", OWNER: "body"}), PredictionOrder).trial == "walk1"
