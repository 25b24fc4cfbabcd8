"""Signing in by the hospital's own accounts."""

from typing import Annotated, Any

import httpx
from fastapi import Query, Request
from sqlalchemy import select
from sqlalchemy.orm import Session
from starlette.responses import RedirectResponse, Response

from ...errors import AccessDenied, InvalidRequest, NotSignedIn
from ...storage.models import Role, User
from ..dependencies import Transaction, services_of
from ..problems import Absent
from ..routing import api_router
from ..single_sign_on import SECONDS, Identity, Provider, attempt_of, new_attempt
from ..tokens import same
from .sign_in import enter

COOKIE = "gaitlab_oidc"
CALLBACK = "/api/v1/auth/oidc/callback"
WAIT = 600
"""Time that the browser may spend at the provider [s]."""
router = api_router("/auth/oidc", tag="sign-in")
REDIRECT: dict[int | str, dict[str, Any]] = {302: {"description": "To the provider, or back to the application."}}


def _redirect_address(request: Request) -> str:
    base = services_of(request).settings.public_url.rstrip("/") or str(request.base_url).rstrip("/")
    return base + CALLBACK


def _client(request: Request) -> httpx.Client:
    if not services_of(request).settings.oidc_issuer:
        raise Absent("sign-in method", "single sign-on")
    return httpx.Client(timeout=SECONDS)


@router.get("/start", response_class=RedirectResponse, status_code=302, responses=REDIRECT)
def start_single_sign_on(request: Request) -> Response:
    """Send the browser to the provider."""
    attempt = new_attempt()
    with _client(request) as client:
        address = Provider(services_of(request).settings, client).start(attempt, _redirect_address(request))
    response = RedirectResponse(address, status_code=302)
    secure = services_of(request).settings.secure_cookies
    response.set_cookie(
        COOKIE, attempt.as_cookie(), max_age=WAIT, httponly=True, secure=secure, samesite="lax", path=CALLBACK
    )
    return response


@router.get("/callback", response_class=RedirectResponse, status_code=302, responses=REDIRECT)
def finish_single_sign_on(
    request: Request,
    db: Transaction,
    state: Annotated[str, Query(max_length=500)] = "",
    code: Annotated[str, Query(max_length=4000)] = "",
    error: Annotated[str, Query(max_length=200)] = "",
) -> Response:
    """Where the provider sends the browser back to."""
    with _client(request) as client:
        attempt = attempt_of(request.cookies.get(COOKIE, ""))
        if not same(state, attempt.state):
            raise InvalidRequest("the sign-in was begun in another browser: begin again")
        if error or not code:
            raise NotSignedIn("the single sign-on provider did not sign you in: begin again, or ask its administrator")
        identity = Provider(services_of(request).settings, client).finish(attempt, code, _redirect_address(request))
    user = _account(db, identity, services_of(request).settings.oidc_default_role)
    response = RedirectResponse("/", status_code=302)
    enter(request, db, user, response)
    response.delete_cookie(COOKIE, path=CALLBACK)
    return response


def _account(db: Session, identity: Identity, default_role: str) -> User:
    """The account of a person: linked before, invited under the verified address, or new with the default role."""
    user = db.scalars(select(User).where(User.oidc_subject == identity.subject)).one_or_none()
    if user is None and identity.email:
        invited = select(User).where(User.login == identity.email, User.oidc_subject.is_(None))
        user = db.scalars(invited).one_or_none()
        if user is not None:
            user.oidc_subject = identity.subject
    if user is None:
        user = _new_account(db, identity, default_role)
    if not user.active:
        raise AccessDenied("the account is switched off: ask the administrator")
    return user


def _new_account(db: Session, identity: Identity, default_role: str) -> User:
    if default_role not in set(Role):
        raise AccessDenied("there is no account for you: ask the administrator to make one")
    login = identity.email or f"sso-{identity.subject[-80:]}".lower()
    user = User(login=login, display_name=identity.name, role=Role(default_role), oidc_subject=identity.subject)
    db.add(user)
    db.flush()
    return user
