"""A video of the visit beside the curves: it follows their cursor, and moves it while it plays."""

import base64
import io
import time

import pytest
from matplotlib.image import imread

from gaitlab.storage.models import Role

from .conftest import opened_page, sign_in

pytestmark = pytest.mark.slow
CURVE = "Knee flexion over the gait cycle"
SECONDS = 3.0
RECORD = """async (seconds) => {
  const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 48 });
  const pen = canvas.getContext("2d");
  const begin = performance.now();
  const draw = () => {
    const shade = Math.round((255 * (performance.now() - begin)) / (1000 * seconds));
    pen.fillStyle = `rgb(${shade}, ${shade}, ${shade})`;
    pen.fillRect(0, 0, 64, 48);
  };
  draw();
  const recorder = new MediaRecorder(canvas.captureStream(25), { mimeType: "video/webm;codecs=vp8" });
  const parts = [];
  recorder.ondataavailable = (event) => parts.push(event.data);
  const over = new Promise((resolve) => (recorder.onstop = resolve));
  recorder.start();
  const timer = setInterval(draw, 40);
  await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
  clearInterval(timer);
  recorder.stop();
  await over;
  const bytes = new Uint8Array(await new Blob(parts).arrayBuffer());
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
}"""
"""Records a canvas that turns from black to white."""


@pytest.fixture(scope="module")
def case(clinic):
    return clinic.make_case()


@pytest.fixture(scope="module")
def stride(clinic, case):
    """Start and end of the left stride that the curves stand for [s]."""
    headers = clinic.as_role(Role.CLINICIAN)
    document = clinic.client.get(f"/api/v1/results/{case.result_id}/document", headers=headers).json()
    strikes = [e["time_s"] for e in document["events"] if e["side"] == "left" and e["kind"] == "foot_strike"]
    return strikes[0], strikes[1]


@pytest.fixture(scope="module")
def page(chromium, clinic, case):
    """The result's page beside a video that was dropped into the visit."""
    with opened_page(chromium, clinic) as page:
        sign_in(page, clinic.people[Role.CLINICIAN].login)
        page.goto(f"/visits/{case.session_id}")
        video = base64.b64decode(page.evaluate(RECORD, SECONDS))
        film = {"name": "frontal.webm", "mimeType": "video/webm", "buffer": video}
        page.locator("input[type=file]").set_input_files([film])
        page.get_by_role("link", name="frontal.webm").wait_for()
        page.goto(f"/results/{case.result_id}")
        page.get_by_role("button", name="Video beside the curves").click()
        # The visit holds a file of zeros that is called a video.
        page.get_by_role("alert").filter(has_text="cannot play").wait_for()
        page.get_by_label("Video", exact=True).and_(page.locator("select")).select_option(label="frontal.webm")
        until(lambda: player(page).evaluate("video => video.readyState >= 2"), page)
        yield page


def player(page):
    return page.locator("video")


def until(condition, page):
    deadline = time.monotonic() + 40.0
    while not condition():
        assert time.monotonic() < deadline
        page.wait_for_timeout(100)


def go_to(page, percent):
    """Move the curves' cursor to a multiple of ten per cent; the video's time then [s]."""
    page.get_by_role("img", name=CURVE).focus()
    page.keyboard.press("Home")
    for _ in range(percent // 10):
        page.keyboard.press("PageUp")
    until(lambda: not player(page).evaluate("video => video.seeking"), page)
    return player(page).evaluate("video => video.currentTime")


def brightness(page):
    picture = imread(io.BytesIO(player(page).screenshot()))
    rows, columns = picture.shape[:2]
    return picture[rows // 5 : rows // 2, columns // 3 : 2 * columns // 3, :3].mean()


def test_the_video_shows_the_instant_of_the_cursor(page, stride):
    start, end = stride
    assert go_to(page, 20) == pytest.approx(start + 0.2 * (end - start), abs=0.01)
    early = brightness(page)
    assert go_to(page, 80) == pytest.approx(start + 0.8 * (end - start), abs=0.01)
    assert brightness(page) - early == pytest.approx(0.6 * (end - start) / SECONDS, abs=0.08)


def test_a_video_that_began_earlier_is_shown_as_much_later(page, stride):
    start, end = stride
    page.get_by_label("Recording begins in the video at [s]").fill("0.5")
    assert go_to(page, 50) == pytest.approx(start + 0.5 * (end - start) + 0.5, abs=0.01)
    page.get_by_label("Recording begins in the video at [s]").fill("0")


def test_the_video_moves_the_cursor_while_it_plays(page):
    go_to(page, 0)
    readout = page.get_by_test_id("readout-knee_flexion")
    first = readout.inner_text()
    player(page).evaluate("video => video.play()")
    until(lambda: readout.inner_text() not in ("", first), page)
    player(page).evaluate("video => video.pause()")
