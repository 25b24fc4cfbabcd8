"""Signing in and out, the first account, one's own password and second factor."""

from datetime import UTC, datetime
from http import HTTPStatus
from typing import Annotated

from fastapi import Request, Response
from sqlalchemy import exists, select, update
from sqlalchemy.orm import Session

from ...errors import Conflict, InvalidRequest, NotSignedIn, SecondFactorMissing
from ...storage.audit import Actor, Deed, record
from ...storage.models import OneTimePurpose, OneTimeToken, Role, User, WebSession
from ..authentication import (
    check_password,
    check_rate,
    end_sessions,
    find_caller,
    note_attempt,
    set_password,
    start_session,
    use_code,
)
from ..caller import Call
from ..dependencies import (
    COOKIE,
    SECURE_COOKIE,
    Transaction,
    allowed,
    credentials_of,
    origin_of,
    services_of,
)
from ..passwords import check_acceptable, verify_password
from ..permissions import PERMISSIONS, Permission
from ..routing import api_router
from ..schemas.accounts import (
    AcceptLink,
    LinkPurpose,
    LinkToCheck,
    Me,
    NewPassword,
    SecondFactorCode,
    SecondFactorSecret,
    SignedIn,
    SignIn,
    SignInMethods,
)
from ..second_factor import new_secret, provisioning_uri
from ..tokens import csrf_token, token_hash

router = api_router("/auth", tag="sign-in")
Account = Annotated[Call, allowed(Permission.ACCOUNT)]
USED = "the link does not exist, was used or has expired: ask for a new one"


def _me(user: User) -> Me:
    return Me(
        id=user.id,
        login=user.login,
        display_name=user.display_name,
        role=user.role,
        second_factor=user.totp_confirmed,
        password=user.password_hash is not None,
    )


def _signed_in(user: User, token: str, session: WebSession) -> SignedIn:
    return SignedIn(
        user=_me(user),
        permissions=sorted(PERMISSIONS[user.role]),
        csrf_token=csrf_token(token),
        expires_at=session.expires_at,
    )


def set_cookie(request: Request, response: Response, token: str) -> None:
    """Give the session's token to the browser, out of reach of scripts and of other sites."""
    settings = services_of(request).settings
    name = SECURE_COOKIE if settings.secure_cookies else COOKIE
    seconds = int(settings.session_hours * 3600.0)
    response.set_cookie(
        name, token, max_age=seconds, secure=settings.secure_cookies, httponly=True, samesite="lax", path="/"
    )


def enter(request: Request, db: Session, user: User, response: Response) -> SignedIn:
    """Sign a user in whose credentials were checked."""
    origin = origin_of(request)
    token, session = start_session(db, user, services_of(request).settings, user.totp_confirmed)
    actor = Actor(user_id=user.id, login=user.login, request_id=origin.request_id, address=origin.address)
    record(db, actor, Deed(action="login", kind="users", object_id=str(user.id)))
    db.flush()
    set_cookie(request, response, token)
    return _signed_in(user, token, session)


@router.get("/methods")
def get_sign_in_methods(request: Request, db: Transaction) -> SignInMethods:
    """Ways to sign in."""
    settings = services_of(request).settings
    return SignInMethods(
        password=True,
        single_sign_on=settings.oidc_name if settings.oidc_issuer else None,
        first_account_needed=not db.scalar(select(exists(User.id))),
    )


@router.post("/sign-in")
def sign_in(request: Request, response: Response, body: SignIn) -> SignedIn:
    """Sign in by login and password, and the code of the second factor where the account has one."""
    services, origin = services_of(request), origin_of(request)
    database = services.database
    with database.transaction() as db:
        check_rate(db, body.login, origin.address)
    try:
        with database.transaction() as db:
            user = check_password(db, services.sealing, body.login, body.password, body.code)
            note_attempt(db, body.login, origin.address, succeeded=True)
            return enter(request, db, user, response)
    except NotSignedIn as error:
        # In a transaction of its own: the failed one is undone.
        with database.transaction() as db:
            if not isinstance(error, SecondFactorMissing):
                note_attempt(db, body.login, origin.address, succeeded=False)
            record(db, origin.actor(None), Deed(action="login refused", kind="users"))
        raise


@router.post("/sign-out", status_code=HTTPStatus.NO_CONTENT)
def sign_out(request: Request, response: Response, call: Account) -> None:
    """End this browser's session; its 3D sessions end at once."""
    session_id = call.caller.web_session_id
    if session_id is None:
        raise InvalidRequest("a token cannot sign out: revoke it under /tokens")
    query = update(WebSession).where(WebSession.id == session_id)
    call.db.execute(query.values(revoked_at=datetime.now(UTC)))
    call.audit("logout", "users", call.caller.user_id)
    services_of(request).viewers.close_session(session_id)
    for name in (COOKIE, SECURE_COOKIE):
        response.delete_cookie(name, path="/", secure=name == SECURE_COOKIE, httponly=True, samesite="lax")
    response.headers["clear-site-data"] = '"cache", "storage"'


@router.get("/session")
def get_session(request: Request, db: Transaction) -> SignedIn:
    """Who is signed in, what they may do, and the CSRF token of their session."""
    credentials = credentials_of(request)
    caller = find_caller(db, credentials, services_of(request).settings)
    if caller.web_session_id is None:
        raise InvalidRequest("a token has no session")
    session = db.get_one(WebSession, caller.web_session_id)
    return _signed_in(db.get_one(User, caller.user_id), credentials.cookie, session)


def _link(db: Session, text: str) -> OneTimeToken:
    """An unused link, locked until the transaction ends."""
    query = select(OneTimeToken).where(OneTimeToken.token_hash == token_hash(text)).with_for_update()
    found = db.scalars(query).one_or_none()
    if found is None or found.used_at is not None or found.expires_at <= datetime.now(UTC):
        raise NotSignedIn(USED)
    return found


@router.post("/link")
def check_link(db: Transaction, body: LinkToCheck) -> LinkPurpose:
    """What a one-time link is for; it stays good."""
    link = _link(db, body.token)
    user = None if link.user_id is None else db.get_one(User, link.user_id)
    return LinkPurpose(
        purpose=link.purpose,
        login=None if user is None else user.login,
        role=link.role if user is None else user.role,
    )


@router.post("/link/accept", status_code=HTTPStatus.CREATED)
def accept_link(request: Request, response: Response, db: Transaction, body: AcceptLink) -> SignedIn:
    """Make the first or an invited account, or set a new password, and sign in."""
    link = _link(db, body.token)
    user = _new_account(db, link, body) if link.user_id is None else db.get_one(User, link.user_id)
    if not user.active:
        raise NotSignedIn(USED)
    check_acceptable(body.password, user.login, user.display_name)
    set_password(user, body.password)
    if body.display_name:
        user.display_name = body.display_name
    link.used_at = datetime.now(UTC)
    db.flush()
    end_sessions(db, user.id)
    return enter(request, db, user, response)


def _new_account(db: Session, link: OneTimeToken, body: AcceptLink) -> User:
    if link.purpose is OneTimePurpose.FIRST_ACCOUNT and db.scalar(select(exists(User.id))):
        raise Conflict("there is an account already: sign in, or ask an administrator for an invitation")
    if body.login is None:
        raise InvalidRequest("the account is new: choose a login, too")
    user = User(login=body.login, display_name=body.display_name, role=link.role or Role.ADMIN)
    db.add(user)
    db.flush()
    return user


@router.put("/password", status_code=HTTPStatus.NO_CONTENT)
def change_password(call: Account, body: NewPassword) -> None:
    """Change one's own password; other browsers are signed out."""
    user = call.db.get_one(User, call.caller.user_id)
    check_rate(call.db, user.login, call.origin.address)
    if not verify_password(body.old, user.password_hash)[0]:
        with call.services.database.transaction() as db:
            note_attempt(db, user.login, call.origin.address, succeeded=False)
        raise InvalidRequest("the old password is wrong")
    check_acceptable(body.new, user.login, user.display_name)
    set_password(user, body.new)
    end_sessions(call.db, user.id, but=call.caller.web_session_id)
    call.audit("password", "users", user.id)


@router.post("/second-factor", status_code=HTTPStatus.CREATED)
def start_second_factor(call: Account) -> SecondFactorSecret:
    """A new secret for an authenticator; it counts once a code was confirmed."""
    user = call.db.get_one(User, call.caller.user_id)
    if user.totp_confirmed:
        raise Conflict("the account has a second factor: remove it first")
    secret = new_secret()
    user.totp_secret, user.totp_last_step = call.services.sealing.seal(secret, user.id), None
    return SecondFactorSecret(secret=secret, uri=provisioning_uri(secret, user.login))


@router.post("/second-factor/confirm", status_code=HTTPStatus.NO_CONTENT)
def confirm_second_factor(call: Account, body: SecondFactorCode) -> None:
    """Switch the second factor on by a first code."""
    user = call.db.get_one(User, call.caller.user_id)
    _use_code(call, user, body.code)
    user.totp_confirmed = True
    call.audit("second factor on", "users", user.id)


@router.post("/second-factor/remove", status_code=HTTPStatus.NO_CONTENT)
def remove_second_factor(call: Account, body: SecondFactorCode) -> None:
    """Switch the second factor off by a last code."""
    user = call.db.get_one(User, call.caller.user_id)
    _use_code(call, user, body.code)
    user.totp_confirmed, user.totp_secret = False, None
    call.audit("second factor off", "users", user.id)


def _use_code(call: Call, user: User, code: str) -> None:
    """Accept a code; 6 digits can be guessed, so failures count as failed attempts to sign in."""
    check_rate(call.db, user.login, call.origin.address)
    try:
        use_code(call.services.sealing, user, code)
    except NotSignedIn as error:
        with call.services.database.transaction() as db:
            note_attempt(db, user.login, call.origin.address, succeeded=False)
        raise InvalidRequest("the code is wrong, too old or was used already") from error
