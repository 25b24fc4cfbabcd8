"""A clinic with the built pages, and a headless Chromium that looks at them."""

import shutil

import pytest
from web_world import PASSWORD, running_world

from gaitlab.api.pages import FRONTEND
from gaitlab.storage.models import Role

WAIT_MS = 20_000


@pytest.fixture(scope="session")
def chromium():
    """A browser; playwright's own is not downloaded, the distribution's is used."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        pytest.skip("no Chromium on this machine: apt-get install chromium")
    if not (FRONTEND / "index.html").is_file():
        pytest.skip("the web pages are not built: make frontend")
    api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
    with api.sync_playwright() as driver:
        # Without its sandbox, because continuous integration is root.
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--use-gl=swiftshader"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def clinic(tmp_path_factory):
    with running_world(tmp_path_factory.mktemp("web"), frontend=FRONTEND) as running:
        yield running


@pytest.fixture
def stranger(chromium, clinic):
    """A page on which nobody is signed in; it fails the test when it asks anybody else for anything."""
    context = chromium.new_context(
        base_url=str(clinic.client.base_url), viewport={"width": 1280, "height": 900}, locale="en-GB"
    )
    context.set_default_timeout(WAIT_MS)
    page = context.new_page()
    foreign, errors = [], []
    page.on("request", lambda request: foreign.append(request.url) if not is_ours(request.url, clinic) else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    yield page
    context.close()
    assert not foreign
    assert not errors


def is_ours(url, clinic):
    return url.startswith((str(clinic.client.base_url), "data:", "blob:"))


@pytest.fixture
def page(stranger, clinic):
    """A page on which the clinician is signed in."""
    sign_in(stranger, clinic.people[Role.CLINICIAN].login)
    return stranger


def sign_in(page, login):
    """Type name and password."""
    page.goto("/")
    page.get_by_label("Login").fill(login)
    page.locator("input[type=password]").fill(PASSWORD)
    page.get_by_role("button", name="Sign in").click()
    page.get_by_role("heading", name="Patients").wait_for()
