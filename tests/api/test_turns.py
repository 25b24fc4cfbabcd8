"""Answers that are made in one turn of one thread, and in which order a request is judged."""

from typing import Annotated

import pytest
from fastapi import Response

from gaitlab.api.caller import Call
from gaitlab.api.dependencies import Asking, allowed
from gaitlab.api.permissions import Permission
from gaitlab.api.schemas.forms import Output
from gaitlab.api.turns import in_one_turn
from gaitlab.storage.models import Role

Reader = Annotated[Call, allowed(Permission.PATIENTS_READ)]


class Told(Output):
    text: str


class Opened(Asking):
    """Stands for a request: notes what happens."""

    def __init__(self, steps):
        object.__setattr__(self, "steps", steps)

    def begin(self):
        return self

    def __enter__(self):
        self.steps.append("begin")
        return "call"

    def __exit__(self, kind, *rest):
        self.steps.append("undo" if kind else "commit")


def get_told(call: Reader, response: Response) -> Told:
    response.headers["ETag"] = '"3"'
    return Told(text=call)


def forget(call: Reader) -> None:
    return None


def fail(call: Reader) -> Told:
    raise KeyError(call)


def test_an_answer_is_made_inside_its_transaction():
    steps = []
    answer = in_one_turn(get_told, 201)(call=Opened(steps), response=Response())
    assert (answer.status_code, answer.body, answer.headers["etag"]) == (201, b'{"text":"call"}', '"3"')
    assert steps == ["begin", "commit"]


def test_an_error_undoes_the_transaction():
    steps = []
    with pytest.raises(KeyError):
        in_one_turn(fail, None)(call=Opened(steps))
    assert steps == ["begin", "undo"]


def test_no_content_is_none_at_all():
    assert in_one_turn(forget, 204)(call=Opened([])).body == b""


def test_an_endpoint_without_a_call_stays_as_it_is():
    def plain(name: str) -> str:
        return name

    assert in_one_turn(plain, None) is plain


@pytest.mark.parametrize("body", ['{"pseudonym": 3}', '{"pseudonym": '])
def test_only_those_who_may_ask_learn_what_is_malformed(world, body):
    def status(headers):
        sent = {"content-type": "application/json", **headers}
        return world.client.post("/api/v1/patients", content=body, headers=sent).status_code

    roles = (Role.VIEWER, Role.CLINICIAN)
    assert [status({}), *(status(world.as_role(role)) for role in roles)] == [401, 403, 422]


def test_a_damaged_file_is_a_problem_before_the_answer_begins(world, case):
    path = f"/api/v1/results/{case.result_id}/files/angles.csv"
    asker = world.as_role(Role.CLINICIAN) | {"Accept-Encoding": "identity"}
    whole = world.client.get(path, headers=asker)
    folder = world.services.settings.data_dir / "files"
    digest = whole.headers["etag"].strip('"')
    file = folder / digest[:2] / digest[2:]
    file.chmod(0o600)
    try:
        file.write_bytes(whole.content[:-1] + b"?")
        answer = world.client.get(path, headers=asker)
    finally:
        file.write_bytes(whole.content)
    assert int(whole.headers["content-length"]) == len(whole.content)
    assert answer.status_code == 503 and "is damaged" in answer.json()["detail"]
