"""Damaged recordings sent to a web process of its own, which must neither fail nor keep anything open."""

import io
import os
import random
import subprocess
import sys
import time
import zipfile
from collections import Counter
from dataclasses import dataclass, field

import psutil
from sqlalchemy import func, select, update
from web_world import DEMO

from gaitlab.storage.models import FINAL, Job, JobKind, JobStatus, Role

ANSWERS = frozenset({201, 413, 422})
NAMES = ("../../etc/passwd.c3d", "a\x00b.c3d", "x" * 300 + ".c3d", "C:\\w.c3d", "\u202ew.c3d", "con.c3d")
WARM_UP = 20
"""Uploads after which connections and threads are there."""


@dataclass
class Report:
    """What became of the uploads."""

    statuses: Counter = field(default_factory=Counter)
    unexpected: list = field(default_factory=list)
    """Number and text of answers that are none of `ANSWERS`."""
    handles: int = 0
    """Open files and sockets at the end beyond those after the warm-up."""
    spooled: int = 0
    """Half-written files that were left."""
    alive: bool = True

    @property
    def taken(self):
        return self.statuses[201]

    @property
    def refused(self):
        return self.statuses.total() - self.taken


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
        name = luck.choice(NAMES)
    return name, bytes(damaged)


def bomb():
    """Ten megabytes of nothing in ten kilobytes, under a false name."""
    with zipfile.ZipFile(target := io.BytesIO(), "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("walk.c3d", bytes(10_000_000))
    return target.getvalue()


def send_mutated(world, process, count):
    """Send `count` mutated recordings, one after the other, to the web process."""
    clinician, content = world.as_role(Role.CLINICIAN), (DEMO / "walk1.c3d").read_bytes()
    address = f"/api/v1/sessions/{world.case.session_id}/recordings"
    report, web, before = Report(), psutil.Process(process.pid), 0
    for number in range(count):
        if number == WARM_UP:
            before = web.num_fds()
        name, damaged = mutated(content, number)
        answer = world.client.post(address, params={"name": name}, headers=clinician, content=damaged)
        report.statuses[answer.status_code] += 1
        if answer.status_code not in ANSWERS:
            report.unexpected.append((number, answer.text))
    report.alive = process.poll() is None and world.client.get("/health/ready").status_code == 200
    report.handles = web.num_fds() - before
    report.spooled = sum(1 for _ in world.services.settings.data_dir.rglob("part-*"))
    return report


def look_into(world, count, seconds):
    """Let a real worker look into some of what was taken; returns how many of these jobs have no end in that time."""
    database, settings = world.services.database, world.services.settings
    with database.transaction() as db:
        waiting = select(Job.id).where(Job.kind == JobKind.INSPECT, Job.status == JobStatus.QUEUED)
        kept = list(db.scalars(waiting.order_by(func.md5(Job.input_hash)).limit(count)))
        rest = update(Job).where(Job.status == JobStatus.QUEUED, Job.id.not_in(kept))
        db.execute(rest.values(status=JobStatus.CANCELLED))
    command = [os.path.join(os.path.dirname(sys.executable), "gaitlab"), "worker", "--data-dir", str(settings.data_dir)]
    secret = dict(os.environ, GAITLAB_DATABASE_URL=settings.database_url.get_secret_value())
    with subprocess.Popen([*command, "--concurrency", "2"], env=secret, stderr=subprocess.DEVNULL) as worker:
        try:
            deadline = time.monotonic() + seconds
            while (left := unfinished(database, kept)) and time.monotonic() < deadline:
                time.sleep(1.0)
        finally:
            worker.terminate()
    return left


def unfinished(database, jobs):
    with database.sessions() as db:
        return db.scalar(select(func.count()).where(Job.id.in_(jobs), Job.status.not_in(FINAL)))
