"""What people correct, keep and choose in the pages."""

import csv
import json

import pyotp
import pytest

from gaitlab.storage.models import Role

from .conftest import inspected_visit, opened_page, sign_in

pytestmark = pytest.mark.slow


@pytest.fixture
def visit(clinic):
    return inspected_visit(clinic)


def posted(page, path, press):
    """Body of the request that pressing a button sends."""
    with page.expect_request(lambda request: request.url.endswith(path) and request.method != "GET") as sent:
        press()
    return json.loads(sent.value.post_data)


def test_corrected_events_go_with_the_next_analysis(page, visit):
    page.goto(f"/visits/{visit.session_id}")
    page.get_by_role("button", name="What was read").click()
    page.get_by_label("Time [s] 1").fill("0.52")
    run = page.get_by_role("button", name="Run", exact=True)
    events = posted(page, "/analyses", run.click)["settings"]["events"]
    assert events == {
        "Jane_walk": [
            {"side": "left", "kind": "foot_strike", "time_s": 0.52},
            {"side": "left", "kind": "foot_off", "time_s": 1.1},
        ]
    }


@pytest.fixture
def foot_off(page, visit):
    """The mark of the second event on the time line, which is at 1.1 s."""
    page.goto(f"/visits/{visit.session_id}")
    page.get_by_role("button", name="What was read").click()
    return page.get_by_role("slider", name="Foot off left, 2")


def test_an_event_is_dragged_on_the_time_line(page, foot_off):
    foot_off.scroll_into_view_if_needed()
    page.wait_for_timeout(500)  # The details unfold.
    strike, off = (page.get_by_role("slider").nth(index).bounding_box() for index in (0, 1))
    second = (off["x"] - strike["x"]) / (1.1 - 0.5)  # [px]
    x, y = off["x"] + off["width"] / 2, off["y"] + off["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 0.1 * second, y)
    page.mouse.move(x + 0.254 * second, y)
    page.mouse.up()
    page.mouse.move(x, y)
    # Snapped to a frame, in the table and in what is sent.
    assert page.get_by_label("Time [s] 2").input_value() == "1.350"
    run = page.get_by_role("button", name="Run", exact=True)
    sent = posted(page, "/analyses", run.click)["settings"]["events"]["Jane_walk"]
    assert [event["time_s"] for event in sent] == [0.5, 1.35]


def test_an_event_is_moved_by_keys_and_put_back(page, foot_off):
    foot_off.focus()
    for key in ("ArrowRight", "PageDown", "ArrowLeft", "ArrowLeft"):
        page.keyboard.press(key)
    assert foot_off.get_attribute("aria-valuetext") == "0.990 s, frame 99"
    assert page.get_by_label("Time [s] 2").input_value() == "0.990"
    page.get_by_role("button", name="As in the file").click()
    assert page.get_by_label("Time [s] 2").input_value() == "1.100"


def test_an_examination_is_written_down(page, visit, clinic):
    page.goto(f"/visits/{visit.session_id}")
    page.get_by_role("button", name="Edit").click()
    page.get_by_label("Footwear").fill("barefoot")
    page.get_by_role("button", name="Add: Spasticity").click()
    page.get_by_label("Muscle 1").fill("gastrocnemius")
    page.get_by_label("Left 1").fill("1+")
    page.get_by_role("button", name="Save").click()
    page.get_by_role("table", name="Spasticity").get_by_text("gastrocnemius").wait_for()
    answer = clinic.client.get(f"/api/v1/sessions/{visit.session_id}", headers=clinic.as_role(Role.CLINICIAN))
    assert answer.json()["examination"]["spasticity"][0]["left"] == "1+"


def test_a_grade_that_does_not_exist_is_refused_in_words(page, visit):
    page.goto(f"/visits/{visit.session_id}")
    page.get_by_role("button", name="Edit").click()
    page.get_by_role("button", name="Add: Strength").click()
    page.get_by_label("Muscle 1").fill("quadriceps")
    page.get_by_label("Left 1").fill("9")
    page.get_by_role("button", name="Save").click()
    assert "quadriceps is 9" in page.get_by_role("alert").filter(has_text="quadriceps").inner_text()


def test_a_second_factor_is_switched_on_and_asked_for(chromium, clinic):
    account = clinic.account(Role.CLINICIAN)
    with opened_page(chromium, clinic) as page:
        sign_in(page, account.login)
        page.goto("/account")
        page.get_by_role("button", name="Switch on").click()
        page.get_by_role("img", name="QR code").wait_for()
        code = pyotp.TOTP(page.locator("code").inner_text())
        page.get_by_label("Code of the authenticator").fill(code.now())
        page.get_by_role("button", name="Confirm").click()
        page.get_by_role("button", name="Switch off").wait_for()
        page.get_by_role("button", name="Sign out").click()
        page.get_by_label("Login").fill(account.login)
        page.locator("input[type=password]").fill("a long enough password")
        page.get_by_role("button", name="Sign in").click()
        page.get_by_label("Code of the authenticator").wait_for()


@pytest.fixture
def comparison(page, clinic):
    results = [clinic.make_case().result_id for _ in range(3)]
    page.goto(f"/compare?results={','.join(results)}")
    page.get_by_role("columnheader", name="Speed").first.wait_for()
    return page


def test_a_comparison_has_a_row_of_each_result_and_filters_them(comparison):
    numbers = comparison.get_by_role("region", name="Numbers")
    assert numbers.get_by_role("row").count() == 1 + 3
    comparison.get_by_label("Filter").fill("speed_m_per_s>5")
    numbers.get_by_role("row").nth(1).wait_for(state="detached")


def test_a_comparison_is_saved_as_csv(comparison):
    with comparison.expect_download() as download:
        comparison.get_by_role("button", name="csv").click()
    rows = list(csv.reader(download.value.path().read_text().splitlines()))
    assert len(rows) == 1 + 3 and all(len(row) == len(rows[0]) for row in rows)
    assert float(rows[1][rows[0].index("Speed [m/s], Left")]) == 1.1


def test_any_two_quantities_are_drawn_against_each_other(comparison):
    comparison.get_by_label("Upwards").select_option(label="Weight: Joint torque")
    comparison.get_by_role("img", name="Two quantities").locator("canvas").wait_for()
    assert comparison.get_by_test_id("scatter-points").inner_text().count("/ 0.30") == 3


def test_a_cohort_is_kept_and_opened_again(comparison):
    comparison.get_by_label("Save as cohort").fill("before surgery")
    comparison.get_by_role("button", name="Save").click()
    comparison.get_by_text("Saved", exact=True).wait_for()
    comparison.goto("/compare")
    comparison.get_by_label("Saved cohort").select_option(label="before surgery (3)")
    comparison.get_by_text("3 chosen").wait_for()
