"""What is ordered through the API is what the computation reads: from the request to the last call of each job."""

import json
from types import SimpleNamespace
from uuid import UUID

import pytest

from gaitlab.jobs.computations import analysis, comparison, prediction, report
from gaitlab.jobs.request import Work
from gaitlab.report.source import EXAMINATION
from gaitlab.storage.models import Job, Role

ANALYSES = "/api/v1/analyses"


@pytest.fixture
def ordered(world, tmp_path):
    """The work of a job that a clinician orders, its files in a folder."""

    def order(path=ANALYSES, **body):
        answer = world.client.post(path, headers=world.as_role(Role.CLINICIAN), json=body)
        assert answer.status_code == 201, answer.text
        made = answer.json()
        with world.services.database.sessions() as db:
            job = db.get(Job, UUID(made["id"] if path == ANALYSES else made["content"]["job_id"]))
        work = Work(kind=job.kind.value, settings=job.settings, inputs=tuple(job.inputs), folder=tmp_path)
        for each in work.inputs:
            file = tmp_path / "inputs" / each["name"]
            file.parent.mkdir(parents=True, exist_ok=True)
            world.services.files.copy_to(each["sha256"], file)
        work.out.mkdir()
        return work

    return order


@pytest.fixture
def heard(monkeypatch):
    """Arguments of the last call of each computation, which does nothing more."""
    calls = {}

    def last_call(module, name, answer=None):
        def instead(*arguments):
            calls[name] = arguments
            return answer

        monkeypatch.setattr(module, name, instead)

    found = SimpleNamespace(trial=None, document=None, prediction=SimpleNamespace(reason=""))
    last_call(prediction, "read_source", "source")
    last_call(prediction, "predict_walk", found)
    for name in ("write_trial", "write_preview"):
        last_call(prediction, name)
    last_call(report, "build_report", {"pdf": b"%PDF", "html": b"<p>"})
    done = SimpleNamespace(document=SimpleNamespace(warnings=(), weights=None), trials=(), not_converged="")
    last_call(analysis, "analyse_files", done)
    last_call(analysis, "write_analysis", ())
    last_call(comparison, "figures", {})
    return calls


def silent(step):
    del step


def test_a_prediction_gets_its_changes_and_the_files_of_its_analysis(ordered, heard, case):
    changes = ["speed=+10%", "left_ankle_orthosis=1"]
    work = ordered(kind="predict", result_id=case.result_id, trial="walk1", changes=changes)
    assert prediction.run(work, silent).summary == {"changes": changes}
    folder, trial = heard["read_source"]
    assert trial == "walk1" and (folder / "result.json").is_file() and (folder / "walk.npz").is_file()
    assert heard["predict_walk"][:2] == ("source", tuple(changes))


def test_a_report_gets_pages_colours_and_notes(ordered, heard, case):
    content = {"pages": ["front", "kinetics"], "colours": "safe", "notes": ["before the operation"]}
    work = ordered("/api/v1/reports", kind="report", result_id=case.result_id, content=content)
    assert report.run(work, silent).summary == {"formats": ["html", "pdf"]}
    source, options, _ = heard["build_report"]
    assert (options.pages, options.colours) == (("front", "kinetics"), "safe")
    assert source.examination.notes == ["before the operation"] and source.name.startswith("P-")
    written = json.loads((work.folder / "inputs" / "result" / EXAMINATION).read_bytes())
    assert written["session"]["date"] == "2026-11-20" and "Jane" not in json.dumps(written)


def test_an_analysis_gets_its_options(ordered, heard, case):
    chosen = {"criteria": ["torque"], "weights": False, "seed": 4, "longest_gap": 0.2, "match_speed": True, "age": 9}
    body = {"kind": "analyse", "session_id": case.session_id, "subject_id": case.subject_id}
    analysis.run(ordered(**body, settings=chosen), silent)
    sources, options, _ = heard["analyse_files"]
    assert [path.name for path in sources.walks] == ["Jane_walk.c3d"]
    assert (options.criteria, options.weights, options.seed, options.longest_gap) == (("torque",), False, 4, 0.2)
    assert (options.references.speed, options.references.age) == ("matched", 9.0)
    assert options.parameters == {"mass": 30.0}


def test_corrected_events_reach_the_analysis(ordered, heard, case):
    strike = {"side": "left", "kind": "foot_strike", "time_s": 0.5}
    body = {"kind": "analyse", "session_id": case.session_id, "settings": {"events": {"Jane_walk": [strike]}}}
    analysis.run(ordered(**body), silent)
    (event,) = heard["analyse_files"][1].events["Jane_walk"]
    assert (event.side, event.kind, event.time_s) == ("left", "foot_strike", 0.5)


def test_a_comparison_gets_its_groups(ordered, heard, case):
    members = [{"result_id": case.result_id, "group": "before"}]
    outcome = comparison.run(ordered(kind="compare", members=members), silent)
    assert outcome.summary == {"members": 1, "baseline": case.result_id}
    assert [each.group for each in heard["figures"][0].members] == ["before"]


def test_a_quantity_that_does_not_exist_is_refused(world, case):
    about = world.client.get("/api/v1/about", headers=world.as_role(Role.CLINICIAN)).json()
    assert about["prediction_quantities"]["mass"]["unit"] == "kg"
    body = {"kind": "predict", "result_id": case.result_id, "changes": ["happiness=1"]}
    answer = world.client.post(ANALYSES, headers=world.as_role(Role.CLINICIAN), json=body)
    assert answer.status_code == 422
    assert "quantity 'happiness' does not exist; available: cadence" in answer.json()["errors"][0]["why"]


def test_the_body_of_another_patient_is_refused(world, case):
    other = world.make_case()
    body = {"kind": "analyse", "session_id": case.session_id, "subject_id": other.subject_id}
    answer = world.client.post(ANALYSES, headers=world.as_role(Role.CLINICIAN), json=body)
    assert answer.status_code == 404 and "subject of this patient" in answer.json()["detail"]
