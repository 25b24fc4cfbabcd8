import json

import pytest
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.sync.client import connect

from gaitlab.storage.models import Role

VIEWERS = "/api/v1/viewers"


@pytest.fixture(scope="module")
def looker(world):
    return world.sign_in(world.people[Role.CLINICIAN])


@pytest.fixture(scope="module")
def viewer(world, looker):
    opened = looker.post(f"/api/v1/results/{world.case.result_id}/viewer")
    assert opened.status_code == 201, opened.text
    yield opened.json()
    looker.delete(f"{VIEWERS}/{opened.json()['id']}")


def socket_of(world, browser, path, origin=None, **more):
    cookies = "; ".join(f"{name}={value}" for name, value in browser.cookies.items())
    base = str(world.client.base_url).rstrip("/")
    headers = {"Cookie": cookies} | ({"Origin": origin} if origin else {})
    return connect(base.replace("http", "ws") + path, additional_headers=headers, max_size=None, **more)


def test_its_page_has_a_policy_of_its_own(looker, viewer):
    page = looker.get(viewer["url"])
    assert page.status_code == 200 and "<html" in page.text
    policy = page.headers["content-security-policy"]
    assert "connect-src 'self'" in policy and "'unsafe-eval'" in policy and "frame-ancestors 'self'" in policy


def test_the_scene_arrives_through_the_proxy(world, looker, viewer):
    path = viewer["url"].rstrip("/")
    with socket_of(world, looker, path, subprotocols=["viser-v1.1.1"]) as scene:
        assert scene.subprotocol == "viser-v1.1.1" and len(scene.recv(timeout=30)) > 0


def test_time_moves_both_ways(world, looker, viewer):
    with socket_of(world, looker, viewer["control"]) as control:
        control.send('{"seek": 0.5}')
        frames = iter(lambda: json.loads(control.recv(timeout=30))["frame"], None)
        assert next(frame for frame in frames if frame == 50) == 50


def test_nobody_else_gets_in(world, looker, viewer):
    for browser in (world.browser(), world.sign_in(world.people[Role.ADMIN])):
        assert browser.get(viewer["url"]).status_code in (401, 404)
        with pytest.raises(InvalidStatus):
            socket_of(world, browser, viewer["control"])


def test_a_page_of_another_site_gets_no_socket(world, looker, viewer):
    with pytest.raises(InvalidStatus):
        socket_of(world, looker, viewer["control"], origin="http://evil.example")


def test_signing_out_closes_it_at_once(world, viewer):
    clinician = world.people[Role.CLINICIAN]
    before = world.services.viewers.count_of(clinician.id)
    browser = world.sign_in(clinician)
    opened = browser.post(f"/api/v1/results/{world.case.result_id}/viewer").json()
    with socket_of(world, browser, opened["control"]) as control:
        browser.post("/api/v1/auth/sign-out")
        with pytest.raises(ConnectionClosedError):
            while True:
                control.recv(timeout=30)
        assert control.close_code == 4001
    assert world.services.viewers.count_of(clinician.id) == before


def test_there_are_not_too_many(world):
    person = world.people[Role.VIEWER]
    browser = world.sign_in(person)
    room = world.services.settings.viewers_per_user - world.services.viewers.count_of(person.id)
    answers = [browser.post(f"/api/v1/results/{world.case.result_id}/viewer") for _ in range(room + 1)]
    assert [answer.status_code for answer in answers] == [201] * room + [429]
    for answer in answers[:room]:
        assert browser.delete(f"{VIEWERS}/{answer.json()['id']}").status_code == 204


def test_a_scene_is_exported_as_one_page(world, looker):
    page = looker.get(f"/api/v1/results/{world.case.result_id}/exports/scene")
    assert page.status_code == 200 and "__VISER_EMBED_DATA__" in page.text
    assert "sandbox" in page.headers["content-security-policy"]
