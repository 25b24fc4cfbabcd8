"""Issue 6, lines 3 and 4: memory of a large upload, browsing under load beside a solve, ten 3D sessions."""

import asyncio
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import psutil
from light_client import Person
from registry import Row, measurement
from theft import Theft
from web_world import World, world_in_a_process
from websockets.asyncio.client import connect

from gaitlab.storage.models import Role

USERS, RATE, SECONDS = 50, 100.0, 60.0
"""People browsing, requests per second of all together, duration [s]."""
STARTS_WITHIN = 300.0
"""Longest time until the analysis is in the middle of its optimisation [s]."""
SESSIONS, LOOK = 10, 20.0


def _pages(case: object) -> tuple[str, ...]:
    """What a person who reads results asks for."""
    ids = case.ids  # type: ignore[attr-defined]
    return (
        "/api/v1/patients",
        f"/api/v1/patients/{ids['patient_id']}",
        f"/api/v1/patients/{ids['patient_id']}/sessions",
        f"/api/v1/results?session_id={ids['session_id']}",
        f"/api/v1/results/{ids['result_id']}",
        f"/api/v1/results/{ids['result_id']}/document",
    )


async def _browse(world: World, rate: float, seconds: float) -> tuple[np.ndarray, int]:
    """When each answer was due and the seconds it took since, shape (n, 2), and how many were no answers.

    Each person wants a page at fixed times, whatever comes back; who still waits asks late, which counts.
    """
    address, pages = world.client.base_url, _pages(world.case)
    arriving = (Person.arrive(address.host, address.port or 80, world.as_role(Role.CLINICIAN)) for _ in range(USERS))
    people = await asyncio.gather(*arriving)
    took: list[tuple[float, float]] = []
    failed = 0

    async def browse(number: int, person: Person, start: float) -> None:
        nonlocal failed
        for turn in range(number, int(rate * seconds), USERS):
            due = start + turn / rate
            await asyncio.sleep(max(due - time.perf_counter(), 0.0))
            failed += await person.get(pages[turn % len(pages)]) != 200
            took.append((due, time.perf_counter() - due))

    start = time.perf_counter() + 0.5
    await asyncio.gather(*(browse(number, person, start) for number, person in enumerate(people)))
    for person in people:
        person.leave()
    return np.array(took), failed


@contextmanager
def _solving(world: World, folder: Path) -> Generator[Callable[[], bool]]:
    """A worker that computes a whole analysis; tells whether it still does."""
    clinician = world.as_role(Role.CLINICIAN)
    order = {"kind": "analyse", "session_id": world.case.session_id}
    job_id = world.client.post("/api/v1/analyses", headers=clinician, json=order).raise_for_status().json()["id"]
    settings = world.services.settings
    command = [str(Path(sys.executable).parent / "gaitlab"), "worker", "--data-dir", str(folder / "worker")]
    secret = dict(os.environ, GAITLAB_DATABASE_URL=settings.database_url.get_secret_value())
    command += ["--files", str(settings.data_dir / "files")]

    def told() -> Any:
        return world.client.get(f"/api/v1/analyses/{job_id}", headers=clinician).json()

    with subprocess.Popen(command, env=secret, stderr=subprocess.DEVNULL) as worker:
        try:
            # Not while it reads the recording, but in the middle of its optimisation.
            world.wait_until(lambda: told()["progress"]["stage"].startswith("tracking"), STARTS_WITHIN)
            yield lambda: told()["status"] == "running"
        finally:
            worker.terminate()


@measurement(issue=6, line=4)
def browsing_beside_a_solve() -> Iterator[Row]:
    folder = Path(tempfile.mkdtemp(prefix="gaitlab-load-"))
    with world_in_a_process(folder) as (world, process):
        asyncio.run(_browse(world, 20.0, 5.0))  # caches and connections, as after the first minute of a day
        web, others = psutil.Process(process.pid), os.getloadavg()[0]
        with _solving(world, folder) as runs:
            before = sum(web.cpu_times()[:2])
            with Theft() as theft:
                answers, failed = asyncio.run(_browse(world, RATE, SECONDS))
            spent = sum(web.cpu_times()[:2]) - before
            running = runs()
    took, calm = answers[:, 1], theft.was_calm(answers[:, 0])
    subject = f"{USERS} connections, {RATE:g} requests/s, {SECONDS:g} s"
    yield Row(
        quantity="answers, 50 %", value=float(np.percentile(took, 50) * 1e3), limit="", unit="ms", subject=subject
    )
    yield Row(
        quantity="answers, 99 %", value=float(np.percentile(took, 99) * 1e3), limit="<= 100", unit="ms", subject=subject
    )
    yield Row(
        quantity="processor time of the web process per answer", value=spent / len(took) * 1e3, limit="", unit="ms",
        subject=subject,
    )  # fmt: skip
    if np.any(calm):
        value, of = float(np.percentile(took[calm], 99) * 1e3), f"{subject}, {100 * calm.mean():.0f} % of the answers"
        yield Row(quantity="99 % while nothing was stolen", value=value, limit="<= 100", unit="ms", subject=of)
    yield Row(quantity="processor time stolen", value=100 * theft.mean, limit="", unit="%", subject=subject)
    yield Row(quantity="load average of the machine before", value=others, limit="", unit="", subject=subject)
    yield Row(quantity="requests without an answer", value=failed, limit="<= 0", unit="", subject=subject)
    yield Row(quantity="solve still running at the end", value=float(running), limit=">= 1", unit="", subject=subject)


async def _updates(address: str, token: dict[str, str]) -> float:
    """Messages per second that one playing 3D session sends through the proxy."""
    async with httpx.AsyncClient(base_url=address, headers=token, timeout=120.0) as client:
        opened = (await client.post(f"/api/v1/results/{token['result']}/viewer")).json()
    socket = address.replace("http", "ws")
    headers = {"Authorization": token["Authorization"]}
    async with (
        connect(socket + opened["control"], additional_headers=headers) as control,
        connect(
            socket + opened["url"].rstrip("/"), additional_headers=headers, subprotocols=["viser-v1.1.1"], max_size=None
        ) as scene,
    ):
        await control.send('{"play": true}')
        await asyncio.sleep(3.0)
        end, count = time.perf_counter() + LOOK, 0
        while time.perf_counter() < end:
            await scene.recv()
            count += 1
    return count / LOOK


@measurement(issue=6, line=4)
def ten_viewer_sessions() -> Iterator[Row]:
    with world_in_a_process(Path(tempfile.mkdtemp(prefix="gaitlab-viewers-"))) as (world, _):
        token = {**world.as_role(Role.CLINICIAN), "result": world.case.ids["result_id"]}

        async def all_of_them() -> list[float]:
            address = str(world.client.base_url).rstrip("/")
            return await asyncio.gather(*(_updates(address, token) for _ in range(SESSIONS)))

        rates = asyncio.run(all_of_them())
    subject = f"{SESSIONS} sessions, {LOOK:g} s"
    yield Row(quantity="updates/s of the slowest session", value=min(rates), limit=">= 30", unit="1/s", subject=subject)
