"""What did not converge is written, marked, and ends with exit code 3."""

import json

import numpy as np
import pytest

from gaitlab.clinical.document import CriterionWeight, Fit, Solver, StrideWeights, WeightsEntry
from gaitlab.errors import Cancelled, NotConverged
from gaitlab.pipelines import analyse
from gaitlab.pipelines.progress import Step
from gaitlab.pipelines.weights import TrialWeights

pytestmark = pytest.mark.shared_data
CRITERIA = ("lateral_stability", "torque")


def answer(status):
    """Stands for inverse optimal control: equal weights and the given status."""

    def identify(request, progress):
        progress(Step(stage="weights", trial=request.recording.name, iteration=1, residual=0.1))
        stride = StrideWeights(
            trial=request.recording.name, side="left", start_s=0.0, end_s=1.0, weights=dict.fromkeys(CRITERIA, 0.5)
        )
        entry = WeightsEntry(
            criteria=[CriterionWeight(name=name, weight=0.5, sd=None, identifiable=False) for name in CRITERIA],
            fit=Fit(rms_rad=0.2, per_joint={"left knee": 0.2}),
            solver=Solver(status=status, kkt_residual=0.1, iterations=9, seconds=1.0, message="stuck in stage 2"),
            strides=[stride],
        )
        return TrialWeights(entry=entry, arrays={"q_optimal": np.full_like(request.q, np.nan)})

    return identify


@pytest.fixture
def analysed(gaitlab, reads, recordings, monkeypatch, tmp_path):
    def call(identify, *walks):
        reads(**recordings)
        monkeypatch.setattr(analyse, "identify_weights", identify)
        return gaitlab("analyse", "--static", "static.c3d", *walks, "--out", tmp_path)

    return call


def test_the_results_so_far_are_written_and_marked(analysed, tmp_path):
    code, _, err = analysed(answer("not_converged"), "straight.c3d")
    assert code == 3
    assert "stuck in stage 2" in err.strip().splitlines()[-1]
    assert json.loads((tmp_path / "result.json").read_text())["weights"]["solver"]["status"] == "not_converged"
    assert (tmp_path / "report.html").exists()


def test_weights_are_printed_and_their_arrays_kept(analysed, tmp_path):
    code, out, _ = analysed(answer("solved"), "straight.c3d")
    assert code == 0
    assert all(name in out for name in CRITERIA)
    assert "q_optimal" in np.load(tmp_path / "walk.npz").files


def test_an_exception_on_the_way_keeps_the_rest(analysed, tmp_path):
    def give_up(request, progress):
        raise NotConverged("tracking stopped in stage 3")

    code, _, err = analysed(give_up, "straight.c3d")
    result = json.loads((tmp_path / "result.json").read_text())
    assert (code, result["weights"]) == (3, None)
    assert "tracking stopped in stage 3" in result["warnings"][-1]
    assert "tracking stopped in stage 3" in err


def test_cancelling_writes_nothing(analysed, tmp_path):
    def cancel(request, progress):
        raise Cancelled("enough")

    assert analysed(cancel, "straight.c3d")[0] == 130
    assert not list(tmp_path.iterdir())
