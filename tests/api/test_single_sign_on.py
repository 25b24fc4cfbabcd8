"""Single sign-on against a provider of our own on this machine."""

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from time import time
from urllib.parse import parse_qs, urlsplit

import pytest
from joserfc import jwt
from joserfc.jwk import RSAKey
from web_world import running_world

from gaitlab.storage.models import Role

KEY = RSAKey.generate_key(2048, {"kid": "1", "use": "sig", "alg": "RS256"})
CLIENT = "gaitlab"


class Handler(BaseHTTPRequestHandler):
    """Describes itself, and answers every code with a token of the claims that a test has set."""

    def do_GET(self):
        base = f"http://127.0.0.1:{self.server.server_port}"
        described = {
            "issuer": base,
            "authorization_endpoint": f"{base}/authorize",
            "token_endpoint": f"{base}/token",
            "jwks_uri": f"{base}/keys",
        }
        self.answer({"keys": [KEY.as_dict(private=False)]} if self.path == "/keys" else described)

    def do_POST(self):
        sent = parse_qs(self.rfile.read(int(self.headers["Content-Length"])).decode())
        self.server.sent = {name: values[0] for name, values in sent.items()}
        key = self.server.key or KEY
        token = jwt.encode({"alg": "RS256", "kid": "1"}, self.server.claims, key)
        self.answer({"id_token": token, "access_token": "x", "token_type": "Bearer"})

    def answer(self, told):
        content = json.dumps(told).encode()
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *arguments):
        del arguments


@pytest.fixture(scope="module")
def provider():
    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        server.key = None
        threading.Thread(target=server.serve_forever).start()
        yield server
        server.shutdown()


@pytest.fixture(scope="module")
def clinic(provider, tmp_path_factory):
    issuer = f"http://127.0.0.1:{provider.server_port}"
    chosen = {"oidc_issuer": issuer, "oidc_client_id": CLIENT, "oidc_client_secret": "s", "oidc_default_role": ""}
    with running_world(tmp_path_factory.mktemp("sso"), **chosen) as world:
        yield world


def come_back(clinic, provider, **changes):
    """Begin, let the provider say who it is, and return; the browser and the last answer."""
    browser = clinic.browser()
    sent = browser.get("/api/v1/auth/oidc/start")
    assert sent.status_code == 302
    asked = {name: values[0] for name, values in parse_qs(urlsplit(sent.headers["location"]).query).items()}
    assert asked["code_challenge_method"] == "S256" and asked["client_id"] == CLIENT
    issuer = f"http://127.0.0.1:{provider.server_port}"
    claims = {"iss": issuer, "aud": CLIENT, "sub": "42", "exp": int(time()) + 60, "nonce": asked["nonce"]}
    provider.claims = claims | {"email_verified": True} | changes
    state = changes.get("state", asked["state"])
    return browser, browser.get("/api/v1/auth/oidc/callback", params={"state": state, "code": "c"})


def test_an_invited_person_comes_in_by_the_verified_address(clinic, provider):
    account = clinic.account(Role.CLINICIAN)
    browser, answer = come_back(clinic, provider, email=account.login)
    assert (answer.status_code, answer.headers["location"]) == (302, "/")
    assert browser.get("/api/v1/auth/session").json()["user"]["login"] == account.login
    assert len(provider.sent["code_verifier"]) >= 43
    assert come_back(clinic, provider)[0].get("/api/v1/auth/session").status_code == 200


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"sub": "43", "email": "nobody@clinic.example"}, 403),
        ({"sub": "44", "email": "user1@clinic.example", "email_verified": False}, 403),
        ({"aud": "another"}, 401),
        ({"exp": 1}, 401),
        ({"nonce": "replayed"}, 401),
        ({"iss": "http://evil.example"}, 401),
        ({"state": "another"}, 422),
    ],
)
def test_whatever_does_not_fit_is_refused(clinic, provider, changes, status):
    browser, answer = come_back(clinic, provider, **changes)
    assert answer.status_code == status
    assert browser.get("/api/v1/auth/session").status_code == 401


def test_a_foreign_signature_is_refused(clinic, provider):
    provider.key = RSAKey.generate_key(2048, {"kid": "1"})
    try:
        assert come_back(clinic, provider, email="user1@clinic.example")[1].status_code == 401
    finally:
        provider.key = None
