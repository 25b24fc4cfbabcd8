from dataclasses import replace

import pyotp
import pytest
from sqlalchemy import delete, select, update
from web_world import PASSWORD

from gaitlab.api.authentication import ATTEMPTS
from gaitlab.api.tokens import LINK, new_token, token_hash
from gaitlab.storage.encryption import FileKey
from gaitlab.storage.models import LoginAttempt, OneTimePurpose, OneTimeToken, Role, User, WebSession
from gaitlab.storage.schema import now
from gaitlab.storage.sealing import Sealing

BASE = "/api/v1/auth"
WRONG = "login, password or code is wrong"


@pytest.fixture
def account(world):
    return world.account(Role.CLINICIAN)


@pytest.fixture(autouse=True)
def forget_attempts(world):
    yield
    with world.services.database.transaction() as db:
        db.execute(delete(LoginAttempt))


def sign_in(browser, account, password=PASSWORD, **more):
    return browser.post(f"{BASE}/sign-in", json={"login": account.login, "password": password, **more})


def test_the_cookie_is_out_of_reach_of_scripts_and_other_sites(world, account):
    cookie = sign_in(world.browser(), account).headers["set-cookie"]
    assert cookie.startswith("gaitlab_session=gls_") and "HttpOnly" in cookie and "SameSite=lax" in cookie
    with world.services.database.sessions() as db:
        stored = db.scalars(select(WebSession.token_hash).where(WebSession.user_id == account.id)).one()
    assert stored == token_hash(cookie.split("=", 1)[1].split(";")[0])


def test_a_wrong_password_and_an_unknown_login_sound_alike(world, account):
    known = sign_in(world.browser(), account, "wrong")
    account.login = "nobody"
    unknown = sign_in(world.browser(), account)
    assert known.status_code == unknown.status_code == 401
    assert known.json()["detail"] == unknown.json()["detail"] == WRONG


def test_failures_are_limited_and_a_success_forgives(world, account):
    for _ in range(ATTEMPTS - 1):
        sign_in(world.browser(), account, "wrong")
    assert sign_in(world.browser(), account).status_code == 200
    answers = [sign_in(world.browser(), account, "wrong").status_code for _ in range(ATTEMPTS + 1)]
    assert answers == [401] * ATTEMPTS + [429]
    refused = sign_in(world.browser(), account)
    assert refused.status_code == 429 and int(refused.headers["retry-after"]) > 0


def test_a_signed_out_browser_is_refused(world, account):
    browser = world.sign_in(account)
    assert browser.get("/api/v1/patients").status_code == 200
    stolen = world.browser()
    stolen.cookies.update(browser.cookies)
    assert stolen.get("/api/v1/patients").status_code == 200
    assert browser.post(f"{BASE}/sign-out").status_code == 204
    assert stolen.get("/api/v1/patients").status_code == 401


@pytest.mark.parametrize("change", [{"expires_at": now()}, {"last_seen_at": now().replace(year=2020)}])
def test_old_and_idle_sessions_end(world, account, change):
    browser = world.sign_in(account)
    with world.services.database.transaction() as db:
        db.execute(update(WebSession).where(WebSession.user_id == account.id).values(**change))
    assert browser.get(f"{BASE}/session").json()["detail"] == "the session has ended: sign in again"


def test_a_second_factor_is_asked_for_and_each_code_counts_once(world, account):
    browser = world.sign_in(account)
    secret = browser.post(f"{BASE}/second-factor").json()["secret"]
    clock = pyotp.TOTP(secret)
    last = clock.timecode(now())
    assert browser.post(f"{BASE}/second-factor/confirm", json={"code": clock.generate_otp(last - 1)}).status_code == 204
    missing = sign_in(world.browser(), account)
    assert missing.status_code == 401 and missing.json()["type"] == "urn:gaitlab:second-factor-missing"
    code = clock.generate_otp(last)
    assert sign_in(world.browser(), account, code=code).status_code == 200
    assert sign_in(world.browser(), account, code=code).json()["detail"] == WRONG


@pytest.fixture
def sealing(world):
    """Makes the installation one with a key."""
    made = Sealing(key=FileKey(bytes(32)))

    def use():
        world.app.state.services = replace(world.services, sealing=made)
        return made

    yield use
    world.app.state.services = world.services


def test_the_secret_of_a_second_factor_is_sealed_where_there_is_a_key(world, account, sealing):
    def stored():
        with world.services.database.sessions() as db:
            return db.get(User, account.id).totp_secret

    browser = world.sign_in(account)
    clear = browser.post(f"{BASE}/second-factor").json()["secret"]
    assert stored() == clear
    key, clock = sealing(), pyotp.TOTP(clear)
    last = clock.timecode(now())
    assert browser.post(f"{BASE}/second-factor/confirm", json={"code": clock.generate_otp(last - 1)}).status_code == 204
    assert key.open(stored(), account.id) == clear != stored()
    assert sign_in(world.browser(), account, code=clock.generate_otp(last)).status_code == 200


def test_a_new_password_signs_the_other_browsers_out(world, account):
    here, there = world.sign_in(account), world.sign_in(account)
    change = {"old": PASSWORD, "new": "another long password"}
    assert here.put(f"{BASE}/password", json=change).status_code == 204
    assert here.get(f"{BASE}/session").status_code == 200
    assert there.get(f"{BASE}/session").status_code == 401
    assert sign_in(world.browser(), account).status_code == 401


@pytest.mark.parametrize(("password", "why"), [("short", "use 12 to 256"), ("aaaaaaaaaaaaaaaa", "repeats few")])
def test_plain_passwords_are_refused(world, account, password, why):
    answer = world.sign_in(account).put(f"{BASE}/password", json={"old": PASSWORD, "new": password})
    assert answer.status_code == 422 and why in answer.json()["detail"]


def test_an_invitation_works_once(world):
    admin = world.as_role(Role.ADMIN)
    made = world.client.post("/api/v1/users", headers=admin, json={"login": "Invited@X.example", "role": "viewer"})
    token = made.json()["link"]["url"].partition("#")[2]
    browser = world.browser()
    assert browser.post(f"{BASE}/link", json={"token": token}).json()["login"] == "invited@x.example"
    accepted = browser.post(f"{BASE}/link/accept", json={"token": token, "password": PASSWORD})
    assert accepted.status_code == 201 and accepted.json()["user"]["role"] == "viewer"
    assert browser.post(f"{BASE}/link/accept", json={"token": token, "password": PASSWORD}).status_code == 401


def test_there_is_no_second_first_account(world):
    text, digest = new_token(LINK)
    with world.services.database.transaction() as db:
        link = OneTimeToken(
            purpose=OneTimePurpose.FIRST_ACCOUNT, token_hash=digest, expires_at=now().replace(year=2100)
        )
        db.add(link)
    body = {"token": text, "login": "second", "password": PASSWORD}
    assert world.browser().post(f"{BASE}/link/accept", json=body).status_code == 409


def test_the_last_administrator_stays(world):
    admin = world.people[Role.ADMIN]
    with world.services.database.transaction() as db:
        others = update(User).where(User.role == Role.ADMIN, User.id != admin.id)
        db.execute(others.values(active=False))
    answer = world.client.patch(f"/api/v1/users/{admin.id}", headers=admin.headers, json={"role": "viewer"})
    assert answer.status_code == 409 and "last administrator" in answer.json()["detail"]


def test_a_token_does_no_more_than_its_scopes_and_ends_when_revoked(world, account):
    made = world.client.post(
        "/api/v1/tokens", headers=account.headers, json={"name": "reader", "scopes": ["patients:read"]}
    ).json()
    reader = {"Authorization": f"Bearer {made['text']}"}
    assert world.client.get("/api/v1/patients", headers=reader).status_code == 200
    assert world.client.post("/api/v1/patients", headers=reader, json={"pseudonym": "x"}).status_code == 403
    world.client.delete(f"/api/v1/tokens/{made['token']['id']}", headers=account.headers)
    assert world.client.get("/api/v1/patients", headers=reader).status_code == 401


def test_a_token_does_no_more_than_its_owner(world):
    viewer = world.as_role(Role.VIEWER)
    answer = world.client.post("/api/v1/tokens", headers=viewer, json={"name": "t", "scopes": ["users:manage"]})
    assert answer.status_code == 403


def test_pages_of_other_sites_change_nothing(world, account):
    browser = world.sign_in(account)
    answer = browser.post("/api/v1/patients", json={"pseudonym": "csrf"}, headers={"Origin": "http://evil.example"})
    assert answer.status_code == 403 and "another site" in answer.json()["detail"]
