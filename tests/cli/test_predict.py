"""`gaitlab predict` on the folder of an analysed demo walk."""

import json

import numpy as np
import pytest
from identified_demo import EQUAL, identified_demo

from gaitlab.cli.app import run
from gaitlab.pipelines.analyse import Sources, analyse_files
from gaitlab.pipelines.bundled import demo_folder
from gaitlab.pipelines.options import AnalysisOptions
from gaitlab.pipelines.output import write_analysis
from gaitlab.pipelines.prediction_source import trials_of, write_source

CHILD = "demo_able_bodied_child"


@pytest.fixture(scope="module")
def analysed(tmp_path_factory):
    """A result with the identified gait for equal weights."""
    folder, data = tmp_path_factory.mktemp("analysed"), demo_folder(CHILD)
    sources = Sources(static=data / "static.c3d", walks=(data / "walk1.c3d",))
    analysis = analyse_files(sources, AnalysisOptions(weights=False))
    write_analysis(analysis, folder)
    write_source(identified_demo(CHILD), analysis.trials[0].constants, folder)
    return folder


def assert_refused(result, *words):
    code, _, err = result
    message = err.strip().splitlines()[-1]
    assert code == 2, err
    assert message.startswith("gaitlab: ")
    assert "Traceback" not in err
    assert all(word in message for word in words), message


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ("happiness=1", "available"),
        ("left_shank_length=3", "from"),
        ("speed=0", "from 0.05"),
        ("left_ankle_plantarflexor_limit=-5", "from 0"),
    ],
)
def test_wrong_requests_end_with_a_sentence(gaitlab, analysed, tmp_path, change, word):
    result = gaitlab("predict", analysed, "--set", change, "--out", tmp_path / "out")
    assert_refused(result, change.partition("=")[0], word)


def test_a_folder_without_an_identified_gait(gaitlab, tmp_path):
    (tmp_path / "empty").mkdir()
    assert_refused(gaitlab("predict", tmp_path / "empty", "--out", tmp_path / "out"), "identified gait", "analyse")


def test_a_folder_that_is_not_there(gaitlab, tmp_path):
    assert_refused(gaitlab("predict", tmp_path / "absent", "--out", tmp_path / "out"), "absent")


def test_a_trial_that_is_not_there(gaitlab, analysed, tmp_path):
    result = gaitlab("predict", analysed, "--trial", "walk9", "--out", tmp_path / "out")
    assert_refused(result, "walk9", "available")


def test_the_only_trial_is_called_after_its_walk(analysed):
    assert trials_of(analysed) == {"walk1": analysed}


def test_quantities_are_listed(gaitlab):
    code, out, _ = gaitlab("predict", "--quantities")
    assert code == 0
    assert "left_tibial_torsion" in out
    assert "steps/min" in out


@pytest.fixture(scope="module")
def faster(analysed, tmp_path_factory):
    """Result of a walk 20 % faster."""
    out = tmp_path_factory.mktemp("faster")
    assert run(["predict", str(analysed), "--set", "speed=+20%", "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def entry(faster):
    """The prediction in its document."""
    return json.loads((faster / "result.json").read_text())["prediction"]


@pytest.mark.slow
class TestFaster:
    """Speed +20 %."""

    def test_every_step_is_certified(self, entry):
        assert entry["status"] == "solved"
        assert all(step["kkt_residual"] < 1e-6 for step in entry["path"])
        assert {step["reduced_hessian"] for step in entry["path"]} == {"positive definite"}

    def test_cadence_step_length_and_hip_moment_rise(self, entry):
        """As in Schwartz et al. (2008) and Fukuchi et al. (2019), see docs/prediction.md."""
        old, new = entry["identified"], entry["predicted"]
        assert new["speed_m_per_s"] == pytest.approx(1.2 * old["speed_m_per_s"], rel=1e-6)
        for name in ("cadence_steps_per_min", "step_length_m"):
            assert new[name] > 1.02 * old[name]
        for side in ("left", "right"):
            name = f"{side}_hip_extensor_peak_nm_per_kg"
            assert new[name] > 1.02 * old[name]

    def test_the_result_has_the_form_of_an_analysis(self, faster, analysed):
        before = {path.name for path in analysed.iterdir()} - {"identified.npz", "calibration.json"}
        assert before | {"report.html"} <= {path.name for path in faster.iterdir()}
        document = json.loads((faster / "result.json").read_text())
        speeds = [document["spatiotemporal"][side]["mean"]["speed_m_per_s"] for side in ("left", "right")]
        assert speeds == pytest.approx([document["prediction"]["predicted"]["speed_m_per_s"]] * 2, rel=0.02)
        assert document["kinetics"]["curves"]["hip_extensor_moment"]["left"]["n_cycles"] == 1

    def test_measured_and_predicted_gait_lie_beside_each_other(self, faster):
        with np.load(faster / "walk.npz") as walk:
            measured, predicted = walk["segment_positions_measured"], walk["segment_positions_optimal"]
        inside = np.isfinite(predicted[:, 0, 0])
        apart = np.linalg.norm((measured - predicted)[inside, 0, :2], axis=1)
        assert inside.sum() > 50
        assert apart.max() < 0.1

    def test_it_can_be_compared(self, gaitlab, faster, analysed, tmp_path):
        code, out, err = gaitlab("compare", analysed, faster, "--out", tmp_path / "both")
        assert code == 0, err
        assert "speed_m_per_s" in out


@pytest.mark.slow
def test_an_infeasible_torque_limit_ends_with_a_sentence(gaitlab, analysed, tmp_path):
    change = "right_ankle_plantarflexor_limit=0"
    code, _, err = gaitlab("predict", analysed, "--set", change, "--out", tmp_path / "out")
    assert code == 3
    assert "no gait was found beyond" in err.strip().splitlines()[-1]
    assert (tmp_path / "out" / "result.json").is_file()


def test_equal_weights_are_kept_with_the_gait(analysed):
    with np.load(analysed / "identified.npz") as archive:
        assert np.array_equal(archive["weights"], EQUAL)
