"""A clinic with the built pages, and a headless Chromium that looks at them."""

import os
import subprocess
import sys
import zipfile
from contextlib import contextmanager
from pathlib import Path
from uuid import UUID

import pytest
from browser_driver import chromium_path, launched, new_context
from browser_driver import sign_in as type_and_enter
from sqlalchemy import update
from web_world import PASSWORD, running_world

from gaitlab.api.pages import FRONTEND
from gaitlab.jobs.imported import import_result
from gaitlab.jobs.request import JobRequest
from gaitlab.storage.models import JobKind, Recording, Role

WAIT_MS = 40_000
WEIGHTED = Path(__file__).parent / "weights_of_the_demo.zip"
"""What `gaitlab demo` wrote for walk1, without the pages: some minutes of computation."""


FOUND = [
    ["frames", "201 at 100 Hz, 2.01 s, first 1"],
    ["markers", "LASI, RASI"],
    ["event times", "left foot strike 0.5000, left foot off 1.1000"],
    ["events", "1 left foot off, 1 left foot strike"],
]
"""Rows as the job "inspect" writes them."""


@pytest.fixture(scope="session")
def chromium():
    """A browser, where there is one."""
    if chromium_path() is None:
        pytest.skip("no Chromium on this machine: apt-get install chromium")
    if not (FRONTEND / "index.html").is_file():
        pytest.skip("the web pages are not built: make frontend")
    api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
    with launched(api.sync_playwright) as browser:
        yield browser


@pytest.fixture(scope="session")
def clinic(tmp_path_factory):
    with running_world(tmp_path_factory.mktemp("web"), frontend=FRONTEND) as running:
        yield running


@pytest.fixture(scope="session")
def busy_clinic(tmp_path_factory):
    """A clinic with a worker: what is asked for is computed."""
    folder = tmp_path_factory.mktemp("busy")
    with running_world(folder, frontend=FRONTEND) as running, working(running.services.settings):
        yield running


@contextmanager
def working(settings):
    """A worker as an administrator starts it, until the end."""
    url = settings.database_url.get_secret_value()
    gaitlab = Path(sys.executable).parent / "gaitlab"
    # Not on the command line, where everybody on the machine could read it.
    environment = {**os.environ, "GAITLAB_DATABASE_URL": url}
    command = [gaitlab, "worker", "--data-dir", settings.data_dir, "--concurrency", "1"]
    with subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL) as process:
        try:
            yield
        finally:
            process.terminate()


@contextmanager
def opened_page(chromium, world, width=1280, theme="light"):
    """A page on which nobody is signed in; it fails the test when it asks anybody else for anything."""
    context = new_context(chromium, world.client.base_url, width=width, color_scheme=theme)
    context.set_default_timeout(WAIT_MS)
    page = context.new_page()
    foreign, errors = [], []
    page.on("request", lambda request: foreign.append(request.url) if not is_ours(request.url, world) else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    yield page
    context.close()
    assert not foreign
    assert not errors


def is_ours(url, world):
    return url.startswith((str(world.client.base_url), "data:", "blob:"))


@pytest.fixture
def stranger(chromium, clinic):
    """A page on which nobody is signed in."""
    with opened_page(chromium, clinic) as page:
        yield page


@pytest.fixture
def page(stranger, clinic):
    """A page on which the clinician is signed in."""
    sign_in(stranger, clinic.people[Role.CLINICIAN].login)
    return stranger


def make_visit(page, pseudonym):
    """A new patient and a visit of theirs, in the dialogs; the page shows the visit."""
    page.get_by_role("button", name="New patient").click()
    page.get_by_label("Pseudonym").fill(pseudonym)
    page.get_by_role("button", name="Save").click()
    page.get_by_role("button", name="New visit").click()
    page.get_by_label("Condition").fill("barefoot")
    page.get_by_role("button", name="Save").click()


def sign_in(page, login):
    """As anybody of the clinic."""
    type_and_enter(page, login, PASSWORD)


def inspected_visit(world):
    """A visit whose recording has been looked into: two seconds with two events."""
    case = world.make_case()
    with world.services.database.transaction() as db:
        db.execute(update(Recording).where(Recording.id == case.recording_id).values(inspection={"rows": FOUND}))
    return case


def add_weighted_result(world, folder):
    """Id of a result with weights, in a visit of its own."""
    with zipfile.ZipFile(WEIGHTED) as packed:
        packed.extractall(folder)
    case = world.make_case()
    request = JobRequest(
        kind=JobKind.ANALYSE, inputs=(), patients=frozenset({UUID(case.patient_id)}), session_id=UUID(case.session_id)
    )
    with world.services.database.transaction() as session:
        return str(import_result(session, world.services.files, request, folder).id)


@pytest.fixture(scope="session")
def weighted(clinic, tmp_path_factory):
    return add_weighted_result(clinic, tmp_path_factory.mktemp("weighted"))
