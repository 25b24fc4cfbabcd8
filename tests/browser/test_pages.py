"""What people do in the browser, in a real one."""

import pytest
from sqlalchemy import update
from web_world import DEMO

from gaitlab.storage.models import Job, JobStatus, Role

from .conftest import make_visit, sign_in

pytestmark = pytest.mark.slow
CURVE = "Knee flexion over the gait cycle"


@pytest.fixture
def result(clinic):
    return clinic.make_case().result_id


def test_a_stranger_sees_the_sign_in_page_only(stranger, clinic):
    stranger.goto(f"/patients/{clinic.case.patient_id}")
    stranger.get_by_role("button", name="Sign in").wait_for()
    stranger.get_by_label("Login").fill(clinic.people[Role.CLINICIAN].login)
    stranger.locator("input[type=password]").fill("not the password")
    stranger.get_by_role("button", name="Sign in").click()
    assert "password" in stranger.get_by_role("alert").inner_text().lower()


def test_after_signing_out_nothing_is_shown(page, clinic):
    page.get_by_role("button", name="Sign out").click()
    page.get_by_role("button", name="Sign in").wait_for()
    page.goto(f"/results/{clinic.case.result_id}")
    page.get_by_role("button", name="Sign in").wait_for()


def test_new_patient_visit_and_upload(page):
    make_visit(page, "P-9001")
    page.locator("input[type=file]").set_input_files([DEMO / "static.c3d", DEMO / "walk1.c3d"])
    page.get_by_test_id("recording").nth(1).wait_for()
    assert page.get_by_test_id("recording").count() == 2


def test_hovering_one_curve_moves_the_cursor_of_all(page, result):
    page.goto(f"/results/{result}")
    page.get_by_role("img", name=CURVE).locator(".u-over").hover(position={"x": 100, "y": 40})
    texts = [page.get_by_test_id(f"readout-{name}").inner_text() for name in ("knee_flexion", "hip_flexion")]
    assert all("Left" in text and "Right" in text for text in texts)


def test_a_click_shows_the_values_of_a_curve(page, result):
    page.goto(f"/results/{result}")
    page.get_by_role("img", name=CURVE).locator(".u-over").click(position={"x": 100, "y": 40})
    page.get_by_role("dialog").get_by_role("row").nth(101).wait_for()


def test_the_weights_are_read(page, result):
    page.goto(f"/results/{result}")
    page.get_by_role("tab", name="Weights").click()
    assert "%" in page.get_by_test_id("weights").inner_text()


def test_two_results_are_compared(page, clinic, result):
    page.goto(f"/compare?results={result},{clinic.case.result_id}")
    page.get_by_role("img", name=CURVE).wait_for()
    page.get_by_role("columnheader").nth(2).wait_for()


def test_a_waiting_job_is_cancelled(page, clinic):
    case = clinic.make_case()
    page.goto(f"/visits/{case.session_id}")
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("Cancelled").wait_for()
    answer = clinic.client.get(f"/api/v1/analyses/{case.waiting_id}", headers=clinic.as_role(Role.CLINICIAN))
    assert answer.json()["status"] == "cancelled"


def test_a_long_queue_leaves_room_for_other_pages(page, clinic):
    waiting = [clinic.make_case().waiting_id for _ in range(8)]
    with clinic.services.database.transaction() as db:
        db.execute(update(Job).where(Job.id.in_(waiting)).values(status=JobStatus.RUNNING))
    page.goto("/jobs")
    page.get_by_test_id("job").nth(8).wait_for()
    page.goto("/patients")
    page.get_by_role("heading", name="Patients").wait_for()


def test_the_report_is_downloaded(page, result):
    page.goto(f"/results/{result}")
    page.get_by_role("tab", name="Report").click()
    with page.expect_download() as download:
        page.get_by_role("link", name="PDF").click()
    assert download.value.path().read_bytes().startswith(b"%PDF")


def test_german_and_dark_are_kept(page):
    page.get_by_label("Language").select_option("de")
    page.get_by_label("Darstellung").select_option("dark")
    page.reload()
    page.get_by_role("heading", name="Patienten").wait_for()
    assert page.locator("html").get_attribute("data-mantine-color-scheme") == "dark"


def test_an_administrator_sees_users_and_audit_log(stranger, clinic):
    sign_in(stranger, clinic.people[Role.ADMIN].login)
    stranger.get_by_role("link", name="Administration").click()
    stranger.get_by_text(clinic.people[Role.CLINICIAN].login).first.wait_for()
    stranger.get_by_role("tab", name="Audit log").click()
    stranger.get_by_text("login").first.wait_for()


def test_the_audit_log_tells_what_was_done_with_one_patient(stranger, clinic):
    sign_in(stranger, clinic.people[Role.CLINICIAN].login)
    stranger.goto(f"/patients/{clinic.case.patient_id}")
    stranger.get_by_role("heading", level=1).wait_for()
    stranger.get_by_role("button", name="Sign out").click()
    sign_in(stranger, clinic.people[Role.ADMIN].login)
    stranger.goto("/admin")
    stranger.get_by_role("tab", name="Audit log").click()
    stranger.get_by_label("Account").select_option(label=clinic.people[Role.CLINICIAN].login)
    stranger.get_by_role("button", name=f"Only patient {clinic.case.patient_id[:8]}").first.click()
    stranger.get_by_role("button", name="All patients").wait_for()
    stranger.get_by_label("From").fill("2200-01-01")
    stranger.get_by_text("Nothing is logged that fits.").wait_for()
