"""A slider of a criterion's weight, a real prediction, and the walk that comes out."""

import tempfile
from pathlib import Path

import pytest

from gaitlab.storage.models import Role

from .conftest import add_weighted_result, opened_page, sign_in

pytestmark = pytest.mark.slow
PREDICTED_MS = 240_000


@pytest.fixture(scope="module")
def weights_page(chromium, busy_clinic):
    result = add_weighted_result(busy_clinic, Path(tempfile.mkdtemp(dir=busy_clinic.services.settings.data_dir)))
    with opened_page(chromium, busy_clinic) as page:
        sign_in(page, busy_clinic.people[Role.CLINICIAN].login)
        page.goto(f"/results/{result}")
        page.get_by_role("tab", name="Weights").click()
        yield page


def test_another_weight_is_predicted_and_compared(weights_page):
    page = weights_page
    predict = page.get_by_role("button", name="Predict")
    assert predict.is_disabled()
    slider = page.get_by_role("slider", name="Joint torque", exact=True)
    before = int(slider.get_attribute("aria-valuenow"))
    slider.focus()
    for _ in range(3):
        slider.press("ArrowRight")
    with page.expect_request(lambda request: request.method == "POST" and "/analyses" in request.url) as asked:
        predict.click()
    assert asked.value.post_data_json["changes"] == [f"torque_weight={(before + 3) / 100}"]
    overlay = page.locator("a[href^='/compare?results=']")
    overlay.wait_for(timeout=PREDICTED_MS)
    overlay.click()
    page.get_by_text("Knee flexion").first.wait_for()
