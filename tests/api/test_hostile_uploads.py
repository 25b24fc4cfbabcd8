"""Damaged recordings and very large files, sent to a web process of its own."""

import io
import os
import random
import subprocess
import sys
import time
import zipfile

import psutil
import pytest
from sqlalchemy import func, select, update
from web_world import DEMO, world_in_a_process

from gaitlab.storage.models import FINAL, Job, JobKind, JobStatus, Role

pytestmark = pytest.mark.slow
MUTATED, LOOKED_INTO = 500, 30
BIG, CHUNK = 500_000_000, 8 << 20
MOST_MEMORY = 100e6  # bytes
STUCK = 600.0  # s
NAMES = ("../../etc/passwd.c3d", "a\x00b.c3d", "x" * 300 + ".c3d", "C:\\w.c3d", "\u202ew.c3d", "con.c3d")


@pytest.fixture(scope="module")
def clinic(tmp_path_factory):
    with world_in_a_process(tmp_path_factory.mktemp("hostile")) as running:
        yield running


def mutated(content, number):
    """A C3D file with something wrong: bits, length, counts, no C3D at all, a compressed bomb, a strange name."""
    luck = random.Random(number)
    damaged, name = bytearray(content), f"walk{number}.c3d"
    kind = number % 6
    if kind == 0:
        for place in luck.sample(range(len(damaged)), 20):
            damaged[place] ^= 1 << luck.randrange(8)
    elif kind == 1:
        del damaged[luck.randrange(len(damaged)) :]
    elif kind == 2:
        for place in (2, 4, 6, 8, 10, 16, 18):
            damaged[place : place + 2] = luck.choice((b"\xff\xff", b"\x00\x00", b"\xff\x7f"))
    elif kind == 3:
        for place in luck.sample(range(512, 5000), 30):
            damaged[place] = luck.randrange(256)
    elif kind == 4:
        damaged = bytearray(bomb())
    else:
        name = luck.choice(
            ("../../etc/passwd.c3d", "a\x00b.c3d", "x" * 300 + ".c3d", "C:\\w.c3d", "\u202ew.c3d", "con.c3d")
        )
    return name, bytes(damaged)


def bomb():
    """Ten megabytes of nothing in ten kilobytes, under a false name."""
    with zipfile.ZipFile(target := io.BytesIO(), "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("walk.c3d", bytes(10_000_000))
    return target.getvalue()


def test_damaged_recordings_neither_crash_the_web_process_nor_leave_a_stuck_job(clinic):
    world, process = clinic
    clinician, content = world.as_role(Role.CLINICIAN), (DEMO / "walk1.c3d").read_bytes()
    answers = dict.fromkeys(("taken", "refused"), 0)
    for number in range(MUTATED):
        name, damaged = mutated(content, number)
        address = f"/api/v1/sessions/{world.case.session_id}/recordings"
        answer = world.client.post(address, params={"name": name}, headers=clinician, content=damaged)
        assert answer.status_code in (201, 413, 422), (number, answer.text)
        answers["taken" if answer.is_success else "refused"] += 1
    assert min(answers.values()) > 0 and process.poll() is None
    assert world.client.get("/health/ready").status_code == 200
    wait_for_jobs(world)


def wait_for_jobs(world):
    """A real worker looks into some of what was taken; each of its jobs comes to an end, whatever it meets."""
    database, settings = world.services.database, world.services.settings
    with database.transaction() as db:
        waiting = select(Job.id).where(Job.kind == JobKind.INSPECT, Job.status == JobStatus.QUEUED)
        kept = list(db.scalars(waiting.order_by(func.md5(Job.input_hash)).limit(LOOKED_INTO)))
        rest = update(Job).where(Job.status == JobStatus.QUEUED, Job.id.not_in(kept))
        db.execute(rest.values(status=JobStatus.CANCELLED))
    command = [os.path.join(os.path.dirname(sys.executable), "gaitlab"), "worker", "--data-dir", str(settings.data_dir)]
    secret = dict(os.environ, GAITLAB_DATABASE_URL=settings.database_url.get_secret_value())
    with subprocess.Popen([*command, "--concurrency", "2"], env=secret, stderr=subprocess.DEVNULL) as worker:
        try:
            deadline = time.monotonic() + STUCK
            while (left := unfinished(database, kept)) and time.monotonic() < deadline:
                time.sleep(1.0)
        finally:
            worker.terminate()
    assert left == 0


def unfinished(database, jobs):
    with database.sessions() as db:
        return db.scalar(select(func.count()).where(Job.id.in_(jobs), Job.status.not_in(FINAL)))


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
