import io
import json
import zipfile
from uuid import uuid4

import pytest
from sqlalchemy import select

from gaitlab.storage.models import AuditEntry, Patient, Role

PATIENTS = "/api/v1/patients"


@pytest.fixture
def clinician(world):
    return world.as_role(Role.CLINICIAN)


def test_researchers_see_pseudonyms_and_no_names(world, case):
    researcher, client = world.as_role(Role.RESEARCHER), world.client
    for path in (
        f"{PATIENTS}/{case.patient_id}",
        f"{PATIENTS}?search=Jane",
        f"/api/v1/sessions/{case.session_id}",
        f"/api/v1/sessions/{case.session_id}/recordings",
        f"/api/v1/recordings/{case.recording_id}",
        f"/api/v1/analyses/{case.analysis_id}",
        f"/api/v1/results/{case.result_id}",
        f"/api/v1/results/{case.result_id}/document",
        f"/api/v1/results/{case.result_id}/exports/csv",
    ):
        answer = client.get(path, headers=researcher)
        assert answer.status_code == 200 and "Jane" not in answer.text, path
    assert "trial-1" in client.get(f"/api/v1/results/{case.result_id}/document", headers=researcher).text
    assert client.get(f"{PATIENTS}?search=Jane", headers=researcher).json()["total"] == 0


@pytest.mark.parametrize("kind", ["html", "pdf", "c3d", "trc", "fhir"])
def test_researchers_get_no_export_that_may_hold_names(world, case, kind):
    answer = world.client.get(
        f"/api/v1/results/{case.result_id}/exports/{kind}", headers=world.as_role(Role.RESEARCHER)
    )
    assert answer.status_code == 403 and "pseudonyms only" in answer.json()["detail"]


def test_clinicians_find_patients_by_name(world, case, clinician):
    found = world.client.get(f"{PATIENTS}?search=jane&limit=500", headers=clinician).json()
    assert case.patient_id in [each["id"] for each in found["items"]]


def test_old_versions_are_not_overwritten(world, case, clinician):
    address = f"{PATIENTS}/{case.patient_id}"
    tag = world.client.get(address, headers=clinician).headers["etag"]
    first = world.client.patch(address, headers=clinician | {"If-Match": tag}, json={"diagnosis": "a"})
    second = world.client.patch(address, headers=clinician | {"If-Match": tag}, json={"diagnosis": "b"})
    assert first.status_code == 200 and second.status_code == 409
    assert second.json()["current_version"] == first.json()["version"]
    assert second.headers["etag"] == first.headers["etag"]


def test_a_repeated_request_is_answered_as_the_first_time(world, clinician):
    headers = clinician | {"Idempotency-Key": str(uuid4())}
    body = {"pseudonym": f"once-{uuid4()}"}
    first, again = (world.client.post(PATIENTS, headers=headers, json=body) for _ in range(2))
    other = world.client.post(PATIENTS, headers=headers, json={"pseudonym": "other"})
    assert first.status_code == again.status_code == 201 and first.json() == again.json()
    assert other.status_code == 422 and "another request" in other.json()["detail"]


def test_a_pseudonym_is_given_once(world, case, clinician):
    name = world.client.get(f"{PATIENTS}/{case.patient_id}", headers=clinician).json()["pseudonym"]
    answer = world.client.post(PATIENTS, headers=clinician, json={"pseudonym": name})
    assert answer.status_code == 409 and "already" in answer.json()["detail"]


def test_sharing_lets_in_and_out(world, case, clinician):
    stranger, address = world.stranger, f"{PATIENTS}/{case.patient_id}"
    share = f"{address}/shares/{stranger.id}"
    assert world.client.put(share, headers=clinician, json={"access": "read"}).status_code == 200
    assert world.client.get(address, headers=stranger.headers).json()["access"] == "read"
    assert world.client.patch(address, headers=stranger.headers, json={"diagnosis": "x"}).status_code == 403
    world.client.put(share, headers=clinician, json={"access": "write"})
    assert world.client.patch(address, headers=stranger.headers, json={"diagnosis": "x"}).status_code == 200
    world.client.delete(share, headers=clinician)
    assert world.client.get(address, headers=stranger.headers).status_code == 404


def test_deleting_leaves_a_line_in_the_log_and_nothing_else(world, case, clinician):
    assert world.client.delete(f"{PATIENTS}/{case.patient_id}", headers=clinician).status_code == 204
    with world.services.database.sessions() as db:
        assert db.get(Patient, case.patient_id) is None
        lines = db.scalars(select(AuditEntry).where(AuditEntry.object_id == case.patient_id)).all()
    assert "delete" in [line.action for line in lines]
    assert world.client.get(f"/api/v1/results/{case.result_id}", headers=clinician).status_code == 404


def test_everything_about_a_patient_comes_as_a_zip(world, case, clinician):
    answer = world.client.get(f"{PATIENTS}/{case.patient_id}/export", headers=clinician)
    names = zipfile.ZipFile(io.BytesIO(answer.content)).namelist()
    assert answer.headers["content-type"] == "application/zip"
    assert "patient.json" in names and any(name.endswith("Jane_walk.c3d") for name in names)


def test_the_age_comes_from_the_birth_date(world, case, clinician):
    answer = world.client.post(
        f"{PATIENTS}/{case.patient_id}/sessions", headers=clinician, json={"visited_on": "2026-11-01"}
    )
    assert answer.json()["age_years"] == 10.5


def test_an_examination_is_checked(world, case, clinician):
    address = f"/api/v1/sessions/{case.session_id}"
    wrong = {"examination": {"spasticity": [{"muscle": "gastrocnemius", "left": "9"}]}}
    answer = world.client.patch(address, headers=clinician, json=wrong)
    assert answer.status_code == 422 and "spasticity of gastrocnemius is 9" in answer.json()["detail"]


def test_texts_that_cannot_be_stored_are_refused(world, clinician):
    body = json.dumps({"pseudonym": "a\x00b"})
    headers = clinician | {"Content-Type": "application/json"}
    assert world.client.post(PATIENTS, headers=headers, content=body).status_code == 422


def test_errors_repeat_no_values(world, clinician):
    answer = world.client.post(PATIENTS, headers=clinician, json={"pseudonym": "x" * 300, "surname": "Doe-Secret"})
    assert answer.status_code == 422 and "Doe-Secret" not in answer.text
    assert {each["where"] for each in answer.json()["errors"]} == {"body.pseudonym", "body.surname"}


@pytest.mark.parametrize(("limit", "offset", "shown"), [(2, 0, 2), (3, 0, 3), (50, 1, 2), (50, 3, 0), (2, 2, 1)])
def test_the_total_is_that_of_all_parts(world, clinician, case, limit, offset, shown):
    address = f"/api/v1/patients/{case.patient_id}/sessions"
    for day in ("2026-01-02", "2026-01-03"):
        assert world.client.post(address, headers=clinician, json={"visited_on": day}).status_code == 201
    page = world.client.get(f"{address}?limit={limit}&offset={offset}", headers=clinician).json()
    assert (len(page["items"]), page["total"]) == (shown, 3)
