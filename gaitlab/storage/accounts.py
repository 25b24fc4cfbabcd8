"""Who may enter: users, their web sessions and tokens."""

from datetime import datetime
from enum import StrEnum
from uuid import UUID

from sqlalchemy import ForeignKey, Index, LargeBinary
from sqlalchemy.orm import Mapped, mapped_column

from .schema import Digest, Identified, Json, Row, Versioned, enum_column, now


class Role(StrEnum):
    """What a user may do."""

    ADMIN = "admin"
    """Everything, accounts included."""
    CLINICIAN = "clinician"
    """Reads and writes patients shared with them or made by them, names included."""
    RESEARCHER = "researcher"
    """Reads and analyses, sees pseudonyms only."""
    VIEWER = "viewer"
    """Reads what is shared with them."""


class OneTimePurpose(StrEnum):
    """What a one-time link is good for."""

    FIRST_ACCOUNT = "first_account"
    INVITATION = "invitation"
    PASSWORD_RESET = "password_reset"


class User(Identified, Versioned, Row):
    """A person with an account."""

    __tablename__ = "users"

    login: Mapped[str] = mapped_column(unique=True)
    """Lower case."""
    role: Mapped[Role] = mapped_column(enum_column(Role))
    display_name: Mapped[str] = mapped_column(default="")
    password_hash: Mapped[str | None] = mapped_column(default=None)
    """argon2id; None with single sign-on only."""
    totp_secret: Mapped[str | None] = mapped_column(default=None)
    """Secret of the second factor, base32, as `storage.sealing` keeps it; None without one."""
    totp_confirmed: Mapped[bool] = mapped_column(default=False)
    totp_last_step: Mapped[int | None] = mapped_column(default=None)
    """Last time step that was accepted: no code is accepted twice."""
    oidc_subject: Mapped[str | None] = mapped_column(unique=True, default=None)
    """Issuer and subject of single sign-on."""
    active: Mapped[bool] = mapped_column(default=True)


class WebSession(Identified, Row):
    """A browser that is signed in."""

    __tablename__ = "web_sessions"

    user_id: Mapped[UUID] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), index=True)
    token_hash: Mapped[Digest] = mapped_column(unique=True)
    csrf_hash: Mapped[Digest]
    expires_at: Mapped[datetime] = mapped_column(index=True)
    last_seen_at: Mapped[datetime] = mapped_column(default_factory=now)
    second_factor: Mapped[bool] = mapped_column(default=False)
    """Whether the second factor was shown in this session."""
    revoked_at: Mapped[datetime | None] = mapped_column(default=None)


class ApiToken(Identified, Row):
    """A token for scripts; only its hash is kept."""

    __tablename__ = "api_tokens"

    user_id: Mapped[UUID] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), index=True)
    name: Mapped[str]
    token_hash: Mapped[Digest] = mapped_column(unique=True)
    scopes: Mapped[list[str]]
    expires_at: Mapped[datetime | None] = mapped_column(default=None)
    last_used_at: Mapped[datetime | None] = mapped_column(default=None)
    revoked_at: Mapped[datetime | None] = mapped_column(default=None)


class OneTimeToken(Identified, Row):
    """A link that works once: to make the first account, to accept an invitation, to set a new password."""

    __tablename__ = "one_time_tokens"

    purpose: Mapped[OneTimePurpose] = mapped_column(enum_column(OneTimePurpose))
    token_hash: Mapped[Digest] = mapped_column(unique=True)
    expires_at: Mapped[datetime]
    user_id: Mapped[UUID | None] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), default=None)
    role: Mapped[Role | None] = mapped_column(enum_column(Role), default=None)
    used_at: Mapped[datetime | None] = mapped_column(default=None)


class LoginAttempt(Row):
    """One attempt to sign in, for rate limits that hold over all web processes."""

    __tablename__ = "login_attempts"
    __table_args__ = (
        Index("ix_login_attempts_login_at", "login_hash", "at"),
        Index("ix_login_attempts_address_at", "address", "at"),
    )

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    login_hash: Mapped[Digest]
    """Hash of what was typed: people type passwords into the wrong field."""
    address: Mapped[str]
    succeeded: Mapped[bool]
    at: Mapped[datetime] = mapped_column(default_factory=now, index=True)


class IdempotencyKey(Identified, Row):
    """Answer to a request that may be sent twice."""

    __tablename__ = "idempotency_keys"
    __table_args__ = (Index("uq_idempotency_keys_user_id_key", "user_id", "key", unique=True),)

    user_id: Mapped[UUID] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"))
    key: Mapped[str]
    request_hash: Mapped[Digest]
    """Of method, path and body: the same key with another request is an error."""
    status: Mapped[int | None] = mapped_column(default=None)
    """None while the first request still runs."""
    headers: Mapped[Json] = mapped_column(default_factory=dict)
    body: Mapped[bytes] = mapped_column(LargeBinary, default=b"")
