import hashlib

import ezc3d
import numpy as np
import pytest
from sqlalchemy import select
from web_world import DEMO

from gaitlab.storage.models import Job, JobKind, JobStatus, Role, UploadChunk

UPLOADS = "/api/v1/uploads"


@pytest.fixture
def clinician(world):
    return world.as_role(Role.CLINICIAN)


@pytest.fixture
def content():
    return (DEMO / "walk1.c3d").read_bytes()


def announce(world, clinician, case, content, name="walk.c3d", **more):
    body = {"session_id": case.session_id, "name": name, "size": len(content), **more}
    return world.client.post(UPLOADS, headers=clinician, json=body)


def send(world, clinician, upload_id, offset, chunk):
    return world.client.put(f"{UPLOADS}/{upload_id}/chunks/{offset}", headers=clinician, content=chunk)


def test_a_broken_upload_goes_on_where_it_stopped(world, clinician, case, content):
    upload = announce(world, clinician, case, content, sha256=hashlib.sha256(content).hexdigest()).json()
    half = len(content) // 2
    send(world, clinician, upload["id"], 0, content[:half])
    again = send(world, clinician, upload["id"], 0, content[:half])
    assert again.status_code == 200 and again.json()["received"] == half
    wrong = send(world, clinician, upload["id"], half + 1, content[half:])
    assert wrong.status_code == 409 and wrong.json()["current_version"] == half
    assert world.client.get(f"{UPLOADS}/{upload['id']}", headers=clinician).json()["received"] == half
    send(world, clinician, upload["id"], half, content[half:])
    done = world.client.post(f"{UPLOADS}/{upload['id']}/finish", headers=clinician)
    assert done.status_code == 201 and done.json()["state"] == "finished"
    recording = done.json()["recording_id"]
    file = world.client.get(f"/api/v1/recordings/{recording}/file", headers=clinician)
    assert file.content == content
    with world.services.database.sessions() as db:
        assert not db.scalars(select(UploadChunk).where(UploadChunk.upload_id == upload["id"])).all()
        job = db.scalars(select(Job).where(Job.inputs[0]["source"].astext == recording)).one()
    assert (job.kind, job.status) == (JobKind.INSPECT, JobStatus.QUEUED)


def test_an_incomplete_upload_is_not_finished(world, clinician, case, content):
    upload = announce(world, clinician, case, content).json()
    answer = world.client.post(f"{UPLOADS}/{upload['id']}/finish", headers=clinician)
    assert answer.status_code == 409 and f"0 of {len(content)} bytes" in answer.json()["detail"]


def test_another_content_than_announced_is_refused(world, clinician, case, content):
    upload = announce(world, clinician, case, content, sha256="0" * 64).json()
    send(world, clinician, upload["id"], 0, content)
    answer = world.client.post(f"{UPLOADS}/{upload['id']}/finish", headers=clinician)
    assert answer.status_code == 422 and "another SHA-256" in answer.json()["detail"]


def test_what_is_no_c3d_file_is_refused_with_the_sentence_of_the_command_line(world, clinician, case):
    upload = announce(world, clinician, case, b"hello").json()
    send(world, clinician, upload["id"], 0, b"hello")
    answer = world.client.post(f"{UPLOADS}/{upload['id']}/finish", headers=clinician)
    assert answer.status_code == 422
    assert answer.json()["detail"].startswith("walk.c3d: this is not a C3D file")


def test_too_much_is_refused_before_it_arrives(world, clinician, case):
    limit = world.services.settings.max_recording_bytes
    body = {"session_id": case.session_id, "name": "walk.c3d", "size": limit + 1}
    assert world.client.post(UPLOADS, headers=clinician, json=body).status_code == 413


def test_a_chunk_beyond_the_limit_is_refused(world, clinician, case):
    upload = announce(world, clinician, case, bytes(20 << 20), name="v.mp4", media_type="video/mp4").json()
    answer = send(world, clinician, upload["id"], 0, bytes(upload["chunk_size"] + 1))
    assert answer.status_code == 413 and "limit" in answer.json()["detail"]


def test_a_video_becomes_an_attachment_that_players_can_seek_in(world, clinician, case):
    video = bytes(range(256)) * 20
    upload = announce(world, clinician, case, video, name="v.mp4", media_type="video/mp4").json()
    send(world, clinician, upload["id"], 0, video)
    done = world.client.post(f"{UPLOADS}/{upload['id']}/finish", headers=clinician).json()
    file = f"/api/v1/attachments/{done['attachment_id']}/file"
    part = world.client.get(file, headers=clinician | {"Range": "bytes=300-399"})
    assert part.status_code == 206 and part.content == video[300:400]
    assert part.headers["content-range"] == "bytes 300-399/5120"


def test_others_neither_see_nor_fill_an_upload(world, clinician, case, content):
    upload = announce(world, clinician, case, content).json()
    admin = world.as_role(Role.ADMIN)
    assert send(world, admin, upload["id"], 0, content).status_code == 404


def test_an_upload_can_be_given_up(world, clinician, case, content):
    upload = announce(world, clinician, case, content).json()
    send(world, clinician, upload["id"], 0, content[:100])
    assert world.client.delete(f"{UPLOADS}/{upload['id']}", headers=clinician).status_code == 204
    assert send(world, clinician, upload["id"], 100, content[100:]).status_code == 409


@pytest.fixture
def named(tmp_path):
    """A C3D file that says in its header who was recorded."""
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = ["LASI"]
    file["data"]["points"] = np.ones((4, 1, 5))
    file.add_parameter("SUBJECTS", "NAMES", ["Jane Doe"])
    file.write(str(tmp_path / "named.c3d"))
    return (tmp_path / "named.c3d").read_bytes()


def test_names_in_a_header_are_blanked_and_the_old_content_is_gone(world, clinician, case, named):
    address = f"/api/v1/sessions/{case.session_id}/recordings?name=Static_1.c3d"
    made = world.client.post(address, headers=clinician, content=named).json()
    assert made["kind"] == "static" and world.services.files.read(made["sha256"]) == named
    stripped = world.client.post(f"/api/v1/recordings/{made['id']}/strip", headers=clinician).json()
    assert stripped["blanked"] == ["SUBJECTS:NAMES"]
    file = world.client.get(f"/api/v1/recordings/{made['id']}/file", headers=clinician).content
    assert hashlib.sha256(file).hexdigest() == stripped["recording"]["sha256"] != made["sha256"]
    assert b"Jane" in named and b"Jane" not in file and not world.services.files.exists(made["sha256"])
    again = world.client.post(f"/api/v1/recordings/{made['id']}/strip", headers=clinician).json()
    assert again["blanked"] == []
