"""Finding out who asks: a session's cookie or a token; and signing in and out."""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any
from uuid import UUID

from sqlalchemy import Row, bindparam, func, select, update
from sqlalchemy.orm import Session

from ..errors import AccessDenied, NotSignedIn, SecondFactorMissing, TooManyAttempts
from ..storage.models import ApiToken, LoginAttempt, User, WebSession
from ..storage.sealing import Sealing
from ..storage.settings import Settings
from .caller import Caller
from .passwords import hash_password, verify_password
from .permissions import PERMISSIONS, Permission
from .second_factor import accepted_step
from .tokens import SESSION, csrf_token, new_token, same, token_hash

ATTEMPTS = 10
"""Failed attempts to sign in per account within `WINDOW`; ten times as many per address."""
WINDOW = timedelta(minutes=15)
SEEN_EVERY = timedelta(minutes=1)
"""How often the last use of a session or a token is written down."""
KNOWN = {str(permission): permission for permission in Permission}
"""A token may name permissions that a later version has dropped."""
WRONG = "login, password or code is wrong"
NOBODY = "nobody is signed in: sign in, or send a token as 'Authorization: Bearer ...'"

_Found = Row[*tuple[Any, ...]]
# Every request asks one of these: they are made once, and give plain rows.
_U, _T, _W = (kind.__table__.c for kind in (User, ApiToken, WebSession))
_TOKEN = select(_T.id, _T.scopes, _T.last_used_at, _T.expires_at, _T.user_id, _U.login, _U.role).where(
    _T.token_hash == bindparam("hash"), _T.revoked_at.is_(None), _T.user_id == _U.id, _U.active
)
_SESSION = select(_W.id, _W.revoked_at, _W.last_seen_at, _W.expires_at, _W.user_id, _U.login, _U.role).where(
    _W.token_hash == bindparam("hash"), _W.user_id == _U.id, _U.active
)


@dataclass(frozen=True, kw_only=True)
class Credentials:
    """What a request brings along."""

    cookie: str = ""
    bearer: str = ""
    csrf: str = ""
    changes: bool = False
    """Whether the request may change something, which a cookie alone does not suffice for."""


def find_caller(db: Session, credentials: Credentials, settings: Settings) -> Caller:
    """The caller of a request.

    Raises:
        NotSignedIn: No valid session and no valid token.
        AccessDenied: A change without the session's CSRF token.
    """
    if credentials.bearer:
        return _by_token(db, credentials.bearer)
    if not credentials.cookie:
        raise NotSignedIn(NOBODY)
    caller = _by_cookie(db, credentials.cookie, settings)
    if credentials.changes and not same(credentials.csrf, csrf_token(credentials.cookie)):
        raise AccessDenied("the request has no valid X-CSRF-Token: read it from /api/v1/auth/session")
    return caller


def _by_token(db: Session, text: str) -> Caller:
    found = db.execute(_TOKEN, {"hash": token_hash(text)}).one_or_none()
    moment = datetime.now(UTC)
    if found is None or (found.expires_at is not None and found.expires_at <= moment):
        raise NotSignedIn("the token does not exist, was revoked or has expired: make a new one")
    if found.last_used_at is None or moment - found.last_used_at > SEEN_EVERY:
        db.execute(update(ApiToken).where(ApiToken.id == found.id).values(last_used_at=moment))
    scopes = {KNOWN[scope] for scope in found.scopes if scope in KNOWN}
    return _caller(found, PERMISSIONS[found.role] & scopes, token_id=found.id)


def _by_cookie(db: Session, text: str, settings: Settings) -> Caller:
    found = db.execute(_SESSION, {"hash": token_hash(text)}).one_or_none()
    moment = datetime.now(UTC)
    if found is None or not is_alive(found, moment, settings):
        raise NotSignedIn("the session has ended: sign in again")
    if moment - found.last_seen_at > SEEN_EVERY:
        db.execute(update(WebSession).where(WebSession.id == found.id).values(last_seen_at=moment))
    return _caller(found, PERMISSIONS[found.role], web_session_id=found.id)


def is_alive(session: WebSession | _Found, moment: datetime, settings: Settings) -> bool:
    """Whether a browser's session still counts."""
    idle = timedelta(minutes=settings.session_idle_minutes)
    return session.revoked_at is None and session.expires_at > moment and moment - session.last_seen_at < idle


def _caller(found: _Found, permissions: frozenset[Permission], **through: UUID) -> Caller:
    return Caller(user_id=found.user_id, login=found.login, role=found.role, permissions=permissions, **through)


def check_rate(db: Session, login: str, address: str) -> None:
    """Raise TooManyAttempts when an account or an address has failed too often."""
    since = datetime.now(UTC) - WINDOW
    for column, value, most in (
        (LoginAttempt.login_hash, token_hash(login), ATTEMPTS),
        (LoginAttempt.address, address, 10 * ATTEMPTS),
    ):
        query = select(func.count(), func.min(LoginAttempt.at)).where(
            column == value, LoginAttempt.at > since, LoginAttempt.succeeded.is_(False)
        )
        count, first = db.execute(query).one()
        if count >= most:
            seconds = max(1.0, (first - since).total_seconds())
            raise TooManyAttempts(
                f"too many failed attempts to sign in: try again in {seconds / 60.0:.0f} minutes", seconds
            )


def note_attempt(db: Session, login: str, address: str, succeeded: bool) -> None:
    """Remember an attempt; a success forgives the account's failures."""
    if succeeded:
        query = update(LoginAttempt).where(LoginAttempt.login_hash == token_hash(login))
        db.execute(query.values(succeeded=True))
    db.add(LoginAttempt(login_hash=token_hash(login), address=address, succeeded=succeeded))


def check_password(db: Session, sealing: Sealing, login: str, password: str, code: str | None) -> User:
    """The account that the credentials belong to.

    Raises:
        NotSignedIn: Wrong, or a second factor is missing; the sentence tells only the latter, after a right password.
    """
    user = db.scalars(select(User).where(User.login == login, User.active)).one_or_none()
    fits, renewed = verify_password(password, None if user is None else user.password_hash)
    if user is None or not fits:
        raise NotSignedIn(WRONG)
    if renewed is not None:
        user.password_hash = renewed
    if user.totp_confirmed and user.totp_secret is not None:
        if code is None:
            raise SecondFactorMissing("the account has a second factor: send the code of the authenticator, too")
        use_code(sealing, user, code)
    return user


def use_code(sealing: Sealing, user: User, code: str) -> None:
    """Accept a code of the second factor once; raises NotSignedIn."""
    if user.totp_secret is None:
        raise NotSignedIn(WRONG)
    secret = sealing.open(user.totp_secret, user.id)
    step = accepted_step(secret, code, user.totp_last_step)
    if step is None:
        raise NotSignedIn(WRONG)
    # Sealed anew: a secret of before the installation had a key does not stay in clear.
    user.totp_last_step, user.totp_secret = step, sealing.seal(secret, user.id)


def start_session(db: Session, user: User, settings: Settings, second_factor: bool) -> tuple[str, WebSession]:
    """Token of a new browser session, and its row."""
    text, digest = new_token(SESSION)
    session = WebSession(
        user_id=user.id,
        token_hash=digest,
        csrf_hash=token_hash(csrf_token(text)),
        expires_at=datetime.now(UTC) + timedelta(hours=settings.session_hours),
        second_factor=second_factor,
    )
    db.add(session)
    return text, session


def end_sessions(db: Session, user_id: UUID, but: UUID | None = None) -> None:
    """Sign a user out everywhere, except in one session."""
    query = update(WebSession).where(WebSession.user_id == user_id, WebSession.revoked_at.is_(None))
    if but is not None:
        query = query.where(WebSession.id != but)
    db.execute(query.values(revoked_at=datetime.now(UTC)))


def set_password(user: User, password: str) -> None:
    """Store a new password; the caller has checked it."""
    user.password_hash = hash_password(password)
