"""Damaged recordings and very large files, sent to a web process of its own."""

import psutil
import pytest
from hostile_uploads import look_into, send_mutated
from web_world import world_in_a_process

from gaitlab.storage.models import Role

pytestmark = pytest.mark.slow
MUTATED, LOOKED_INTO = 500, 30
BIG, CHUNK = 500_000_000, 8 << 20
MOST_MEMORY = 100e6  # bytes
STUCK = 600.0  # s
MORE_HANDLES = 5


@pytest.fixture(scope="module")
def clinic(tmp_path_factory):
    with world_in_a_process(tmp_path_factory.mktemp("hostile")) as running:
        yield running


def test_damaged_recordings_neither_crash_the_web_process_nor_leave_anything_behind(clinic):
    world, process = clinic
    report = send_mutated(world, process, MUTATED)
    assert report.unexpected == [] and min(report.taken, report.refused) > 0
    assert report.alive and report.handles <= MORE_HANDLES and report.spooled == 0
    assert look_into(world, LOOKED_INTO, STUCK) == 0


@pytest.mark.parametrize("way", ["chunks", "one request"])
def test_a_large_upload_needs_little_memory(clinic, way):
    world, process = clinic
    clinician, web = world.as_role(Role.CLINICIAN), psutil.Process(process.pid)
    before, most = web.memory_info().rss, [0]

    def pieces():
        for number in range(BIG // 1_000_000):
            if number % 10 == 0:
                most[0] = max(most[0], web.memory_info().rss)
            yield number.to_bytes(4, "big") * 250_000

    if way == "chunks":
        body = {"session_id": world.case.session_id, "name": "v.mp4", "media_type": "video/mp4", "size": BIG}
        upload = world.client.post("/api/v1/uploads", headers=clinician, json=body).json()["id"]
        send_chunks(world, clinician, upload, pieces())
        done = world.client.post(f"/api/v1/uploads/{upload}/finish", headers=clinician)
        assert done.status_code == 201
    else:
        address = f"/api/v1/sessions/{world.case.session_id}/recordings?name=big.c3d"
        answer = world.client.post(address, headers=clinician, content=pieces())
        assert answer.status_code == 422 and "not a C3D file" in answer.json()["detail"]
    assert max(most[0], web.memory_info().rss) - before <= MOST_MEMORY


def send_chunks(world, clinician, upload, pieces):
    offset, waiting = 0, b""
    for piece in pieces:
        waiting += piece
        if len(waiting) >= CHUNK or offset + len(waiting) == BIG:
            part, waiting = waiting[:CHUNK], waiting[CHUNK:]
            address = f"/api/v1/uploads/{upload}/chunks/{offset}"
            assert world.client.put(address, headers=clinician, content=part).status_code == 200
            offset += len(part)
    while waiting:
        part, waiting = waiting[:CHUNK], waiting[CHUNK:]
        world.client.put(f"/api/v1/uploads/{upload}/chunks/{offset}", headers=clinician, content=part)
        offset += len(part)
