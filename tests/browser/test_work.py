"""From files to a result with a real worker: drop, correct, run, watch, read; and end a job that runs."""

import base64
import re
from types import SimpleNamespace

import pytest
from web_world import DEMO

from gaitlab.storage.models import Role

from .conftest import make_visit, opened_page, sign_in

pytestmark = pytest.mark.slow
LONG_MS = 180_000
"""A short analysis on a busy machine."""
DROP = """(zone, files) => {
  const dropped = new DataTransfer();
  for (const { name, text } of files)
    dropped.items.add(new File([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))], name));
  zone.dispatchEvent(new DragEvent("drop", { dataTransfer: dropped, bubbles: true, cancelable: true }));
}"""
CORRECTED_MASS = 27.5
MARKER_COUNT = re.compile(r"\d+ markers$")


@pytest.fixture(scope="module")
def page(chromium, busy_clinic):
    """One page for the whole journey."""
    with opened_page(chromium, busy_clinic) as opened:
        sign_in(opened, busy_clinic.people[Role.CLINICIAN].login)
        yield opened


def drop(page, *paths):
    """Drop files on the page as from a folder."""
    files = [{"name": path.name, "text": base64.b64encode(path.read_bytes()).decode()} for path in paths]
    page.get_by_label("Drop a folder").locator("..").evaluate(DROP, files)


@pytest.fixture(scope="module")
def dropped(page, tmp_path_factory):
    """A new visit into which a child's files were dropped, once the worker has read them; its address."""
    make_visit(page, "P-7001")
    note = tmp_path_factory.mktemp("folder") / "notes.txt"
    note.write_text("not for gaitlab")
    drop(page, DEMO / "static.c3d", DEMO / "walk1.c3d", note)
    page.get_by_text("Left aside, because they are no C3D, video or PDF: notes.txt").wait_for()
    page.get_by_text(MARKER_COUNT).nth(1).wait_for(timeout=LONG_MS)
    return page.url


@pytest.fixture(scope="module")
def analysed(page, dropped):
    """An analysis without weights of corrected measurements: what was told of it, and the result's address."""
    page.goto(dropped)
    page.get_by_label("Mass [kg]").fill(str(CORRECTED_MASS))
    page.get_by_role("button", name="Keep corrections").click()
    page.locator("button:disabled", has_text="Keep corrections").wait_for()
    page.get_by_role("switch", name="Find the weights").uncheck()
    page.get_by_role("button", name="Run").click()
    job = page.get_by_test_id("job").first
    job.get_by_text("Running").wait_for(timeout=LONG_MS)
    told = job.get_by_role("progressbar").get_attribute("aria-label", timeout=LONG_MS)
    job.get_by_role("link", name="Show result").click(timeout=LONG_MS)
    page.get_by_role("heading", name="Result").wait_for()
    return SimpleNamespace(stage=told, url=page.url)


def test_what_was_read_is_shown_before_anything_is_computed(page, dropped):
    page.goto(dropped)
    kinds = [page.get_by_label(f"Kind of {name}").input_value() for name in ("static.c3d", "walk1.c3d")]
    assert kinds == ["static", "walk"]
    walk = page.get_by_test_id("recording").filter(has_text="walk1.c3d")
    assert "Force plates" in walk.inner_text() and "Events" in walk.inner_text()
    walk.get_by_role("button", name="What was read").click()
    walk.get_by_text("LASI").wait_for()


def test_a_corrected_measurement_is_what_is_computed_with(analysed, busy_clinic):
    result = analysed.url.rsplit("/", 1)[1]
    answer = busy_clinic.client.get(f"/api/v1/results/{result}/document", headers=busy_clinic.as_role(Role.CLINICIAN))
    assert answer.json()["subject"]["mass_kg"] == CORRECTED_MASS


def test_a_running_job_tells_what_it_does(analysed):
    assert analysed.stage


def test_curves_of_the_walk_are_drawn(page, analysed):
    page.goto(analysed.url)
    page.get_by_role("img", name="Knee flexion over the gait cycle").locator("canvas").wait_for()
    page.get_by_role("img", name="Knee moment").locator("canvas").wait_for()


def test_a_running_job_is_cancelled(page, analysed, dropped, busy_clinic):
    page.goto(dropped)
    page.get_by_role("button", name="Run").click()
    job = page.get_by_test_id("job").first
    job.get_by_text("Running").wait_for(timeout=LONG_MS)
    job.get_by_role("button", name="Cancel").click()
    job.get_by_text("Cancelled").wait_for()
    job.get_by_role("button", name="Try again").wait_for()


def test_a_report_is_built_signed_and_downloaded(page, analysed, busy_clinic):
    page.goto(analysed.url)
    page.get_by_role("tab", name="Report").click()
    page.get_by_label("All cycles").uncheck()
    page.get_by_role("button", name="Build report").click()
    with page.expect_download(timeout=LONG_MS) as download:
        page.get_by_role("link", name="PDF").click(timeout=LONG_MS)
    pdf = download.value.path().read_bytes()
    assert pdf.startswith(b"%PDF") and len(pdf) > 20_000
