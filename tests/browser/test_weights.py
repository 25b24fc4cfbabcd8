"""The weights page of a real result, and the 3D view beside its curves."""

import io
import json
import re
import time
import zipfile

import numpy as np
import pytest
from matplotlib.image import imread

from gaitlab.storage.models import Role

from .conftest import WEIGHTED, opened_page, sign_in

pytestmark = pytest.mark.slow
CURVE = "Knee flexion over the gait cycle"
SCENE_MS = 120_000
"""A software renderer on a busy machine takes its time."""


@pytest.fixture(scope="module")
def stored():
    """The document that the page shows."""
    with zipfile.ZipFile(WEIGHTED) as packed:
        return json.loads(packed.read("result.json"))["weights"]


@pytest.fixture
def weights_page(page, weighted):
    page.goto(f"/results/{weighted}")
    page.get_by_role("tab", name="Weights").click()
    page.get_by_test_id("weights").wait_for()
    return page


def test_the_weights_are_those_of_the_result(weights_page, stored):
    shown = weights_page.get_by_test_id("weights").inner_text()
    printed = [float(number) for number in re.findall(r"^(\d+\.\d)", shown, re.MULTILINE)]
    assert printed == [pytest.approx(100 * each["weight"], abs=0.051) for each in stored["criteria"]]


def test_what_the_walk_tells_is_said_in_words(weights_page, stored):
    sentences = weights_page.get_by_test_id("identifiability").inner_text()
    assert sentences.count("this walk tells the weight") == sum(each["identifiable"] for each in stored["criteria"])


def test_share_over_the_cycle_and_optimal_angles_are_drawn(weights_page):
    weights_page.get_by_role("img", name="Share of each criterion over the cycle").locator("canvas").wait_for()
    knee = weights_page.get_by_role("img", name=CURVE)
    knee.locator(".u-over").hover(position={"x": 100, "y": 40})
    values = re.findall(r"-?\d+\.\d", weights_page.get_by_test_id("readout-knee_flexion").inner_text())
    left, left_of_model, right, right_of_model = map(float, values)
    assert left == pytest.approx(left_of_model, abs=8.0) and right == pytest.approx(right_of_model, abs=8.0)


@pytest.fixture(scope="module")
def scene(chromium, clinic, weighted):
    """One page for all that is done in 3D, as its first picture takes the longest."""
    with opened_page(chromium, clinic) as page:
        sign_in(page, clinic.people[Role.CLINICIAN].login)
        page.set_default_timeout(SCENE_MS)
        page.goto(f"/results/{weighted}")
        page.get_by_role("button", name="3D beside the curves").click()
        page.get_by_test_id("frame").get_by_text("frame").wait_for()
        page.frame_locator("iframe").locator("canvas").first.wait_for()
        yield page


def until(condition, page):
    """Wait for it; playwright's own way would evaluate text in the page, which its policy forbids."""
    deadline = time.monotonic() + SCENE_MS / 1000
    while not condition():
        assert time.monotonic() < deadline
        page.wait_for_timeout(100)


def frame_of(page):
    return int(page.get_by_test_id("frame").get_attribute("data-frame"))


def test_the_3d_frame_follows_the_cursor_and_is_drawn(scene):
    # By keys: the software renderer keeps the page too busy for the mouse of playwright.
    scene.get_by_role("img", name=CURVE).focus()
    scene.keyboard.press("ArrowRight")
    scene.wait_for_timeout(500)
    early = frame_of(scene)
    for _ in range(5):
        scene.keyboard.press("PageUp")
    until(lambda: frame_of(scene) > early + 10, scene)
    picture = imread(io.BytesIO(scene.locator("iframe").screenshot()))[..., :3]
    # Neither black nor empty: bones of the left leg are red, the model's orange.
    red = (picture[..., 0] > 0.6) & (picture[..., 1] < 0.35) & (picture[..., 2] < 0.35)
    assert red.sum() > 30 and picture.mean() > 0.3
    assert len(np.unique((picture * 15).astype(int).reshape(-1, 3), axis=0)) > 20


def test_playing_moves_the_cursor_of_the_curves(scene):
    # Not by the mouse: the software renderer keeps the page too busy for playwright's patience.
    scene.get_by_role("button", name="Play").dispatch_event("click")
    readout = scene.get_by_test_id("readout-knee_flexion")
    until(lambda: readout.inner_text() != "", scene)
    first = readout.inner_text()
    until(lambda: readout.inner_text() not in ("", first), scene)
    scene.get_by_role("button", name="Pause").dispatch_event("click")


def test_a_picture_of_the_scene_is_saved(scene):
    with scene.expect_download(timeout=SCENE_MS) as download:
        scene.get_by_role("button", name="Save picture").dispatch_event("click")
    picture = imread(download.value.path())
    assert picture.shape[0] > 100 and picture[..., :3].std() > 0.01
