"""OpenID Connect: authorization code flow with PKCE (OpenID Connect Core 1.0, RFC 7636).

The provider's signature, issuer, audience, time and our nonce are checked before a claim is believed.
"""

import base64
import hashlib
import importlib
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlencode

import httpx

from ..errors import AccessDenied, InvalidRequest, NotSignedIn
from ..storage.settings import Settings

SECONDS = 10.0


@dataclass(frozen=True, kw_only=True)
class Attempt:
    """What a browser must bring back from the provider, kept in a cookie meanwhile."""

    state: str
    nonce: str
    verifier: str

    def as_cookie(self) -> str:
        """Text of the cookie."""
        return ".".join((self.state, self.nonce, self.verifier))


def new_attempt() -> Attempt:
    """Random values for one sign-in."""
    state, nonce, verifier = (secrets.token_urlsafe(32) for _ in range(3))
    return Attempt(state=state, nonce=nonce, verifier=verifier)


def attempt_of(cookie: str) -> Attempt:
    """The values of a cookie; raises InvalidRequest."""
    parts = cookie.split(".")
    if len(parts) != 3 or not all(parts):
        raise InvalidRequest("the sign-in was begun in another browser or too long ago: begin again")
    return Attempt(state=parts[0], nonce=parts[1], verifier=parts[2])


@dataclass(frozen=True, kw_only=True)
class Identity:
    """Who the provider says it is."""

    subject: str
    """Issuer and the provider's own number of the person."""
    email: str
    """Lower case; empty unless the provider has verified it."""
    name: str


class Provider:
    """An OpenID Connect provider, as its discovery document describes it."""

    def __init__(self, settings: Settings, client: httpx.Client) -> None:
        self._settings, self._client = settings, client
        address = f"{settings.oidc_issuer.rstrip('/')}/.well-known/openid-configuration"
        self._described = self._json(client.build_request("GET", address))
        if self._described.get("issuer") != settings.oidc_issuer:
            raise AccessDenied(
                "the single sign-on provider calls itself otherwise than the settings: ask the administrator"
            )

    def start(self, attempt: Attempt, redirect: str) -> str:
        """Address to send the browser to."""
        challenge = base64.urlsafe_b64encode(hashlib.sha256(attempt.verifier.encode()).digest()).rstrip(b"=")
        asked = {
            "response_type": "code",
            "client_id": self._settings.oidc_client_id,
            "redirect_uri": redirect,
            "scope": "openid profile email",
            "state": attempt.state,
            "nonce": attempt.nonce,
            "code_challenge": challenge.decode(),
            "code_challenge_method": "S256",
        }
        return f"{self._described['authorization_endpoint']}?{urlencode(asked)}"

    def finish(self, attempt: Attempt, code: str, redirect: str) -> Identity:
        """Exchange the code for the identity; raises NotSignedIn for one that cannot be believed."""
        secret = self._settings.oidc_client_secret
        sent = {
            "grant_type": "authorization_code",
            "code": code,
            "redirect_uri": redirect,
            "client_id": self._settings.oidc_client_id,
            "code_verifier": attempt.verifier,
        }
        if secret is not None:
            sent["client_secret"] = secret.get_secret_value()
        told = self._json(self._client.build_request("POST", self._described["token_endpoint"], data=sent))
        claims = self._claims(str(told.get("id_token", "")), attempt.nonce)
        verified = claims.get("email_verified") is True
        return Identity(
            subject=f"{self._settings.oidc_issuer}#{claims['sub']}",
            email=str(claims.get("email", "")).lower() if verified else "",
            name=str(claims.get("name", ""))[:200],
        )

    def _claims(self, token: str, nonce: str) -> Mapping[str, Any]:
        keys: Any = self._json(self._client.build_request("GET", self._described["jwks_uri"]))
        # Loaded only now: the libraries of signatures would cost every start a tenth of its time.
        id_tokens = importlib.import_module("gaitlab.api.id_tokens")
        return id_tokens.checked_claims(token, keys, nonce, self._settings)

    def _json(self, request: httpx.Request) -> dict[str, Any]:
        try:
            answer = self._client.send(request)
            answer.raise_for_status()
            told = answer.json()
        except (httpx.HTTPError, ValueError) as error:
            raise NotSignedIn("the single sign-on provider refuses or does not answer: try again") from error
        if not isinstance(told, dict):
            raise NotSignedIn("the single sign-on provider's answer is no JSON object")
        return told
