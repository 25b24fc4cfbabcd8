import json
import threading

import pytest

from gaitlab.jobs.claims import beat, claim, end
from gaitlab.storage.models import JobStatus, Role

ANALYSES = "/api/v1/analyses"


@pytest.fixture
def clinician(world):
    return world.as_role(Role.CLINICIAN)


def order(world, clinician, case, **more):
    body = {"kind": "analyse", "session_id": case.session_id, **more}
    return world.client.post(ANALYSES, headers=clinician, json=body)


def test_an_analysis_reads_the_walks_of_the_visit(world, clinician, case):
    job = order(world, clinician, case, subject_id=case.subject_id).json()
    assert (job["kind"], job["status"], job["session_id"]) == ("analyse", "queued", case.session_id)
    assert [(each["role"], each["source"]) for each in job["inputs"]] == [("walk", case.recording_id)]
    assert job["settings"]["parameters"] == {"mass": 30.0} and job["settings"]["criteria"]


def test_the_same_request_is_computed_once(world, clinician, case):
    first, second = (order(world, clinician, case).json() for _ in range(2))
    other = order(world, clinician, case, settings={"weights": False}).json()
    assert first["id"] == second["id"] != other["id"]


def test_unknown_settings_are_refused(world, clinician, case):
    answer = order(world, clinician, case, settings={"parameters": {"shoe_size": 30}})
    assert answer.status_code == 422 and "body parameter 'shoe_size' does not exist" in answer.json()["detail"]


def test_recordings_of_others_cannot_be_read(world, clinician, case):
    answer = order(world, clinician, case, walks=[world.case.recording_id])
    assert answer.status_code == 404


def test_a_waiting_job_is_cancelled_and_tried_again(world, clinician, case):
    job = order(world, clinician, case).json()
    assert world.client.post(f"{ANALYSES}/{job['id']}/cancel", headers=clinician).json()["status"] == "cancelled"
    assert world.client.post(f"{ANALYSES}/{job['id']}/cancel", headers=clinician).status_code == 409
    again = world.client.post(f"{ANALYSES}/{job['id']}/retry", headers=clinician).json()
    assert again["status"] == "queued" and again["id"] != job["id"]


def test_events_tell_progress_and_the_end(world, clinician, case):
    job = order(world, clinician, case).json()["id"]
    database = world.services.database
    heard = []

    def listen():
        with world.client.stream("GET", f"{ANALYSES}/{job}/events", headers=clinician) as stream:
            ready.set()
            for line in stream.iter_lines():
                if line.startswith("event: "):
                    name = line.removeprefix("event: ")
                if line.startswith("data: "):
                    heard.append((name, json.loads(line.removeprefix("data: "))))
                    told.set()

    ready, told = threading.Event(), threading.Event()
    listener = threading.Thread(target=listen)
    listener.start()
    assert told.wait(30)
    with database.transaction() as db:
        claimed = claim(db, job, "test")
    with database.transaction() as db:
        beat(db, claimed, {"stage": "tracking", "trial": "walk", "done": 0.5, "iteration": 3, "residual": 0.1})
    with database.transaction() as db:
        end(db, claimed, JobStatus.FAILED, error="no convergence")
    listener.join(30)
    assert [name for name, _ in heard] == ["job", "job", "progress", "job"] and heard[-1][1][
        "error"
    ] == "no convergence"
    assert heard[2][1]["stage"] == "tracking"


def test_a_report_is_ordered_and_signed_in_a_browser_with_the_password(world, clinician, case):
    made = world.client.post("/api/v1/reports", headers=clinician, json={"kind": "report", "result_id": case.result_id})
    assert made.status_code == 201 and (made.json()["number"], made.json()["has_pdf"]) == (2, False)
    browser = world.sign_in(world.people[Role.CLINICIAN])
    sign = f"/api/v1/reports/{case.report_id}/signatures"
    assert browser.post(sign, json={"password": "wrong"}).status_code == 422
    signed = browser.post(sign, json={"password": "a long enough password"})
    assert signed.status_code == 201 and len(signed.json()["signatures"]) == 1
    assert browser.delete(f"/api/v1/reports/{case.report_id}").status_code == 409


def test_results_stand_side_by_side(world, clinician, case):
    other = world.make_case()
    body = {"members": [{"result_id": case.result_id, "group": "a"}, {"result_id": other.result_id, "group": "b"}]}
    made = world.client.post("/api/v1/comparisons", headers=clinician, json=body).json()
    assert made["baseline"] == case.result_id
    assert {row[0] for row in made["tables"]["quantities"]["rows"]} == {case.result_id, other.result_id}


@pytest.mark.parametrize(
    ("kind", "begin"), [("json", b"{"), ("csv", b"result,"), ("parquet", b"PAR1"), ("npz", b"PK"), ("fhir", b"{")]
)
def test_results_are_exported(world, clinician, case, kind, begin):
    answer = world.client.get(f"/api/v1/results/{case.result_id}/exports/{kind}", headers=clinician)
    assert answer.status_code == 200 and answer.content.startswith(begin), answer.text[:200]
