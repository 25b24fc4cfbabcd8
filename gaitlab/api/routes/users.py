"""Accounts, for administrators; colleagues to share patients with; tokens for programs."""

from datetime import UTC, datetime, timedelta
from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import Query, Response
from sqlalchemy import func, or_, select, update

from ...errors import AccessDenied, Conflict
from ...storage.editing import assign
from ...storage.models import ApiToken, OneTimePurpose, OneTimeToken, Role
from ...storage.models import User as UserRow
from ..authentication import end_sessions
from ..caller import Call
from ..dependencies import ExpectedVersion, allowed, check_version, tag
from ..listing import containing, page
from ..permissions import Permission
from ..problems import Absent
from ..repetition import RepetitionKey, once
from ..routing import api_router
from ..schemas.accounts import (
    Colleague,
    NewToken,
    NewUser,
    OneTimeLink,
    Token,
    TokenWithText,
    User,
    UserChange,
    UserFilter,
    UserWithLink,
)
from ..schemas.forms import Page
from ..tokens import API, LINK, new_token

LINK_LIFETIME = timedelta(hours=72)
router = api_router()
Manager = Annotated[Call, allowed(Permission.USERS_MANAGE)]
Account = Annotated[Call, allowed(Permission.ACCOUNT)]


def user_answer(user: UserRow) -> User:
    """An account as administrators see it."""
    return User(
        id=user.id,
        created_at=user.created_at,
        version=user.version,
        login=user.login,
        display_name=user.display_name,
        role=user.role,
        active=user.active,
        second_factor=user.totp_confirmed,
        single_sign_on=user.oidc_subject is not None,
    )


def _user(call: Call, user_id: UUID) -> UserRow:
    found = call.db.get(UserRow, user_id)
    if found is None:
        raise Absent("user", user_id)
    return found


@router.get("/users", tags=["users"])
def list_users(call: Manager, which: Annotated[UserFilter, Query()]) -> Page[User]:
    """All accounts, by login."""
    query = select(UserRow).order_by(UserRow.login)
    if which.search:
        pattern = containing(which.search)
        query = query.where(or_(UserRow.login.ilike(pattern), UserRow.display_name.ilike(pattern)))
    return page(call, query, which, lambda row: user_answer(row[0]))


@router.post("/users", tags=["users"], status_code=HTTPStatus.CREATED)
def create_user(call: Manager, body: NewUser, key: RepetitionKey = None) -> UserWithLink:
    """Make an account and a one-time link by which its owner chooses a password."""

    def make() -> UserWithLink:
        user = UserRow(login=body.login, display_name=body.display_name, role=body.role)
        call.db.add(user)
        call.db.flush()
        call.audit("create", "users", user.id, detail={"role": body.role})
        return UserWithLink(user=user_answer(user), link=_make_link(call, user, OneTimePurpose.INVITATION))

    return once(call, key, ("createUser", body), UserWithLink, make)


@router.get("/users/{user_id}", tags=["users"])
def get_user(call: Manager, user_id: UUID, response: Response) -> User:
    """One account."""
    user = _user(call, user_id)
    tag(response, user.version)
    return user_answer(user)


@router.patch("/users/{user_id}", tags=["users"])
def change_user(call: Manager, user_id: UUID, body: UserChange, response: Response, expected: ExpectedVersion) -> User:
    """Change role or name, switch an account off or on, or remove a lost second factor."""
    user = _user(call, user_id)
    check_version(user, expected)
    if user.role is Role.ADMIN and (body.active is False or body.role not in (None, Role.ADMIN)):
        _keep_an_administrator(call, user_id)
    assign(user, body.model_dump(include={"display_name", "role", "active"}))
    if body.remove_second_factor:
        user.totp_confirmed, user.totp_secret = False, None
    if body.active is False or body.role is not None or body.remove_second_factor:
        end_sessions(call.db, user_id, but=call.caller.web_session_id)
    call.db.flush()
    call.audit("update", "users", user_id, detail=body.model_dump(exclude_unset=True, exclude={"display_name"}))
    tag(response, user.version)
    return user_answer(user)


def _keep_an_administrator(call: Call, user_id: UUID) -> None:
    query = select(func.count()).where(UserRow.role == Role.ADMIN, UserRow.active, UserRow.id != user_id)
    if not call.db.scalar(query):
        raise Conflict("this is the last administrator: make another one first")


@router.delete("/users/{user_id}", tags=["users"], status_code=HTTPStatus.NO_CONTENT)
def delete_user(call: Manager, user_id: UUID, expected: ExpectedVersion) -> None:
    """Close an account for good: it cannot sign in; its name stays in what it signed and in the audit log."""
    user = _user(call, user_id)
    check_version(user, expected)
    if user_id == call.caller.user_id:
        raise AccessDenied("nobody closes their own account: ask another administrator")
    if user.role is Role.ADMIN:
        _keep_an_administrator(call, user_id)
    user.active, user.password_hash, user.totp_secret, user.totp_confirmed = False, None, None, False
    user.oidc_subject = None
    end_sessions(call.db, user_id)
    moment = datetime.now(UTC)
    tokens = update(ApiToken).where(ApiToken.user_id == user_id, ApiToken.revoked_at.is_(None))
    call.db.execute(tokens.values(revoked_at=moment))
    links = update(OneTimeToken).where(OneTimeToken.user_id == user_id, OneTimeToken.used_at.is_(None))
    call.db.execute(links.values(used_at=moment))
    call.audit("delete", "users", user_id)


@router.post("/users/{user_id}/link", tags=["users"], status_code=HTTPStatus.CREATED)
def create_password_link(call: Manager, user_id: UUID) -> OneTimeLink:
    """A one-time link for somebody who forgot their password."""
    user = _user(call, user_id)
    if not user.active:
        raise Conflict("the account is closed: switch it on first")
    call.audit("password link", "users", user_id)
    return _make_link(call, user, OneTimePurpose.PASSWORD_RESET)


def _make_link(call: Call, user: UserRow, purpose: OneTimePurpose) -> OneTimeLink:
    text, digest = new_token(LINK)
    link = OneTimeToken(
        purpose=purpose, token_hash=digest, user_id=user.id, expires_at=datetime.now(UTC) + LINK_LIFETIME
    )
    call.db.add(link)
    base = call.services.settings.public_url.rstrip("/")
    # After '#', so that the token is in no server's log.
    return OneTimeLink(purpose=purpose, url=f"{base}/link#{text}", expires_at=link.expires_at)


@router.get("/colleagues", tags=["users"])
def list_colleagues(
    call: Annotated[Call, allowed(Permission.COLLEAGUES_READ)], which: Annotated[UserFilter, Query()]
) -> Page[Colleague]:
    """Accounts to share patients with."""
    query = select(UserRow).where(UserRow.active).order_by(UserRow.display_name, UserRow.login)
    if which.search:
        pattern = containing(which.search)
        query = query.where(or_(UserRow.login.ilike(pattern), UserRow.display_name.ilike(pattern)))
    return page(call, query, which, lambda row: Colleague.model_validate(row[0]))


@router.get("/tokens", tags=["tokens"])
def list_tokens(call: Account) -> list[Token]:
    """One's own tokens."""
    query = select(ApiToken).where(ApiToken.user_id == call.caller.user_id).order_by(ApiToken.created_at.desc())
    return [Token.model_validate(token) for token in call.db.scalars(query)]


@router.post("/tokens", tags=["tokens"], status_code=HTTPStatus.CREATED)
def create_token(call: Account, body: NewToken) -> TokenWithText:
    """A token for a program; it may do what its scopes and its owner's role both allow."""
    beyond = sorted(set(body.scopes) - call.caller.permissions)
    if beyond:
        raise AccessDenied(f"a token may not do more than you: {', '.join(beyond)}")
    text, digest = new_token(API)
    expires = None if body.days is None else datetime.now(UTC) + timedelta(days=body.days)
    token = ApiToken(
        user_id=call.caller.user_id,
        name=body.name,
        token_hash=digest,
        scopes=sorted({str(scope) for scope in body.scopes}),
        expires_at=expires,
    )
    call.db.add(token)
    call.db.flush()
    call.audit("create", "api_tokens", token.id, detail={"scopes": token.scopes})
    return TokenWithText(token=Token.model_validate(token), text=text)


@router.delete("/tokens/{token_id}", tags=["tokens"], status_code=HTTPStatus.NO_CONTENT)
def revoke_token(call: Account, token_id: UUID) -> None:
    """End a token of one's own at once."""
    token = call.db.get(ApiToken, token_id)
    if token is None or token.user_id != call.caller.user_id:
        raise Absent("token", token_id)
    token.revoked_at = token.revoked_at or datetime.now(UTC)
    call.audit("delete", "api_tokens", token_id)
