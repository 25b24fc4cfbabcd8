"""Every route for every role, generated from the OpenAPI document: no route can be forgotten."""

import itertools

import pytest
from api_operations import MAY, ROLES, address, body_of, operations_of
from sqlalchemy import func, select

from gaitlab.api.app import create_app
from gaitlab.storage.models import AuditEntry, Role
from gaitlab.storage.settings import Settings

OPERATIONS = [(o["operationId"], method, path) for method, path, o in operations_of(create_app(Settings()).openapi())]
CLOSED = [each for each in OPERATIONS if MAY.get(each[0]) != "*"]
IDS = [operation for operation, *_ in OPERATIONS]
CLOSED_IDS = [operation for operation, *_ in CLOSED]
SAFE = ("GET", "HEAD")
BINARY = ("sendChunk", "createRecording")
UNREACHED = frozenset({"getViewer", "showViewer", "getUpload"})
"""Belong to one browser, or to the sender alone."""
_numbers = itertools.count()


def ask(world, operation, method, path, case, headers):
    body = body_of(operation, case, next(_numbers))
    content = {"content": b"abcd"} if operation in BINARY else {"json": body}
    return world.client.request(method, address(method, path, case, next(_numbers)), headers=headers, **content)


def audited(world, patient_id):
    with world.services.database.sessions() as db:
        return db.scalar(select(func.count()).where(AuditEntry.patient_id == patient_id))


def test_the_table_of_roles_names_every_operation_and_no_other():
    assert sorted(MAY) == sorted(IDS)


@pytest.mark.parametrize(("operation", "method", "path"), CLOSED, ids=CLOSED_IDS)
def test_a_stranger_gets_401(world, operation, method, path):
    answer = ask(world, operation, method, path, world.case, {})
    assert answer.status_code == 401
    assert answer.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(("operation", "method", "path"), CLOSED, ids=CLOSED_IDS)
def test_roles_without_the_permission_get_403(world, operation, method, path):
    for letter, role in ROLES.items():
        if letter not in MAY[operation]:
            answer = ask(world, operation, method, path, world.case, world.as_role(role))
            assert answer.status_code == 403, (role, answer.text)


@pytest.mark.parametrize(("operation", "method", "path"), CLOSED, ids=CLOSED_IDS)
def test_roles_with_the_permission_get_in_and_leave_a_trace(world, operation, method, path):
    for letter in MAY[operation]:
        case = world.case if method in SAFE else world.make_case()
        before = audited(world, case.patient_id)
        answer = ask(world, operation, method, path, case, world.as_role(ROLES[letter]))
        if operation == "watchAnalysis":
            answer.close()
        assert answer.status_code not in (401, 403) or _refused_for_another_reason(operation, answer), answer.text
        assert answer.status_code < 500
        if method in SAFE and operation not in UNREACHED:
            assert answer.status_code == 200, answer.text
        if answer.is_success and _is_about_a_patient(path):
            assert audited(world, case.patient_id) > before


def _refused_for_another_reason(operation, answer):
    """Reports are signed in a browser, and cohorts are changed by their makers only."""
    return operation in ("signReport", "changeCohort", "deleteCohort") and answer.status_code == 403


def _is_about_a_patient(path):
    names = ("patient_id", "session_id", "recording_id", "subject_id", "attachment_id", "analysis_id", "result_id")
    return any(f"{{{name}}}" in path for name in (*names, "report_id"))


@pytest.mark.parametrize(("operation", "method", "path"), CLOSED, ids=CLOSED_IDS)
def test_a_colleague_without_a_share_sees_nothing_of_the_patient(world, operation, method, path):
    if not _is_about_a_patient(path) or "c" not in MAY[operation]:
        return
    answer = ask(world, operation, method, path, world.case, world.stranger.headers)
    assert answer.status_code == 404, answer.text
    assert "is not shared with you" in answer.json()["detail"]


@pytest.mark.parametrize(("operation", "method", "path"), CLOSED, ids=CLOSED_IDS)
def test_a_cookie_alone_changes_nothing(world, browser, operation, method, path):
    if method in SAFE:
        return
    answer = browser.request(
        method, address(method, path, world.case, 0), json=body_of(operation, world.case, next(_numbers))
    )
    assert answer.status_code == 403 and "X-CSRF-Token" in answer.json()["detail"]


@pytest.fixture(scope="module")
def browser(world):
    """Signed in as an administrator, but without the CSRF token."""
    browser = world.sign_in(world.people[Role.ADMIN])
    del browser.headers["X-CSRF-Token"]
    return browser
