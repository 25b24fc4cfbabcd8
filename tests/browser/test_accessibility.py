"""WCAG 2.2 AA on every page in both themes, as far as a machine can tell; and the keyboard alone."""

import pytest
from axe_playwright_python.sync_playwright import Axe

from gaitlab.storage.models import Role

from .conftest import inspected_visit, opened_page, sign_in

pytestmark = pytest.mark.slow
RULES = ("wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice")
PAGES = {
    "patients": "/patients",
    "patient": "/patients/{patient_id}",
    "visit": "/visits/{session_id}",
    "result": "/results/{result_id}",
    "choice to compare": "/compare",
    "comparison": "/compare?results={result_id},{other_id}",
    "jobs": "/jobs",
    "account": "/account",
}
TABS = ("Weights", "Numbers", "Report")
ADMIN_TABS = ("Users", "Tokens", "Audit log", "System")


@pytest.fixture(scope="module", params=["light", "dark"])
def theme(request):
    return request.param


@pytest.fixture(scope="module")
def address(clinic):
    other = clinic.make_case().result_id
    return lambda path: path.format(other_id=other, **clinic.case.ids)


@pytest.fixture(scope="module")
def stranger(chromium, clinic, theme):
    with opened_page(chromium, clinic, theme=theme) as page:
        yield page


@pytest.fixture(scope="module")
def page(chromium, clinic, theme):
    with opened_page(chromium, clinic, theme=theme) as opened:
        sign_in(opened, clinic.people[Role.CLINICIAN].login)
        yield opened


@pytest.fixture(scope="module")
def admin(chromium, clinic, theme):
    with opened_page(chromium, clinic, theme=theme) as opened:
        sign_in(opened, clinic.people[Role.ADMIN].login)
        yield opened


def faults(page):
    """What axe finds, a line for each element."""
    page.wait_for_load_state("networkidle")
    options = {"runOnly": {"type": "tag", "values": RULES}, "resultTypes": ["violations"]}
    found = Axe().run(page, options=options).response["violations"]
    return "\n".join(
        f"{each['id']}: {n['html'][:300]} {n['failureSummary'][:200]}" for each in found for n in each["nodes"]
    )


def test_sign_in_has_no_faults(stranger):
    stranger.goto("/")
    stranger.get_by_role("button", name="Sign in").wait_for()
    assert faults(stranger) == ""


@pytest.mark.parametrize("name", PAGES)
def test_pages_have_no_faults(page, address, name):
    page.goto(address(PAGES[name]))
    page.get_by_role("heading", level=1).wait_for()
    assert faults(page) == ""


def test_a_recording_with_its_time_line_has_no_faults(page, clinic):
    page.goto(f"/visits/{inspected_visit(clinic).session_id}")
    page.get_by_role("button", name="What was read").click()
    page.get_by_role("slider", name="Foot off").wait_for()
    assert faults(page) == ""


@pytest.mark.parametrize("tab", TABS)
def test_tabs_of_a_result_have_no_faults(page, address, tab):
    page.goto(address("/results/{result_id}"))
    page.get_by_role("tab", name=tab).click()
    assert faults(page) == ""


@pytest.mark.parametrize("tab", ADMIN_TABS)
def test_administration_has_no_faults(admin, tab):
    admin.goto("/admin")
    admin.get_by_role("tab", name=tab).click()
    assert faults(admin) == ""


@pytest.mark.parametrize(("path", "opener"), [("/patients", "New patient"), ("/patients/{patient_id}", "New visit")])
def test_dialogs_have_no_faults(page, address, path, opener):
    page.goto(address(path))
    page.get_by_role("button", name=opener).click()
    page.get_by_role("dialog").get_by_role("button", name="Save").wait_for()
    assert faults(page) == ""


def test_the_keyboard_reaches_a_curve_and_moves_its_cursor(page, address):
    page.goto(address("/results/{result_id}"))
    curve = page.get_by_role("img", name="Knee flexion over the gait cycle")
    curve.focus()
    page.keyboard.press("ArrowRight")
    first = page.get_by_test_id("readout-hip_flexion").inner_text()
    for _ in range(20):
        page.keyboard.press("ArrowRight")
    assert first and page.get_by_test_id("readout-hip_flexion").inner_text() != first
    page.keyboard.press("Enter")
    page.get_by_role("dialog").get_by_role("row").nth(101).wait_for()


def test_the_first_stop_of_the_keyboard_skips_the_menu(page):
    page.goto("/patients")
    page.get_by_role("heading", level=1).wait_for()
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.closest('main') !== null")
