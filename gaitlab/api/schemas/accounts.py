"""Accounts: signing in, users, tokens."""

from collections.abc import Sequence
from datetime import datetime
from typing import Annotated
from uuid import UUID

from pydantic import Field, StringConstraints

from ...storage.models import OneTimePurpose, Role
from ..permissions import Permission
from .forms import Edited, Input, Line, Output, Paging, Password, Stored, Word

Login = Annotated[
    str,
    StringConstraints(
        strip_whitespace=True, to_lower=True, min_length=2, max_length=120, pattern=r"^[A-Za-z0-9_.@+-]+$"
    ),
    Field(examples=["m.weber@clinic.example"]),
]
Code = Annotated[str, StringConstraints(pattern=r"^[0-9 ]{6,8}$"), Field(examples=["123456"])]
LinkToken = Annotated[str, StringConstraints(min_length=10, max_length=100, pattern=r"^[A-Za-z0-9_-]+$")]


class SignIn(Input):
    """Name and password, and the code of the second factor where the account has one."""

    login: Annotated[str, StringConstraints(strip_whitespace=True, to_lower=True, min_length=1, max_length=120)]
    password: Password
    code: Code | None = None


class Me(Output):
    """The account that is signed in."""

    id: UUID
    login: str
    display_name: str
    role: Role
    second_factor: bool = Field(description="Whether the account has a second factor.")
    password: bool = Field(description="Whether the account has a password of its own.")


class SignedIn(Output):
    """A browser's session."""

    user: Me
    permissions: Sequence[Permission]
    csrf_token: str = Field(description="To be sent as X-CSRF-Token with every change, when signed in by cookie.")
    expires_at: datetime


class SignInMethods(Output):
    """Ways to sign in."""

    password: bool
    single_sign_on: str | None = Field(description="Words on the button; null: there is none.")
    first_account_needed: bool = Field(
        description="Nobody has an account yet: open the one-time link that serve printed."
    )


class AcceptLink(Input):
    """What a one-time link asks for: the first account, an invited one, or a new password."""

    token: LinkToken
    password: Password
    login: Login | None = Field(default=None, description="Needed for a new account.")
    display_name: Line = ""


class LinkPurpose(Output):
    """What a one-time link is for."""

    purpose: OneTimePurpose
    login: str | None = Field(description="Account that it belongs to; null: a new one.")
    role: Role | None


class LinkToCheck(Input):
    """A one-time link that somebody opened."""

    token: LinkToken


class NewPassword(Input):
    """Change of one's own password."""

    old: Password
    new: Password


class SecondFactorSecret(Output):
    """Secret for an authenticator; it counts after one code of it was confirmed."""

    secret: str
    uri: str = Field(description="To be shown as a QR code.")


class SecondFactorCode(Input):
    """A code of the authenticator."""

    code: Code


class NewUser(Input):
    """An account to make; the person chooses a password by a one-time link."""

    login: Login
    display_name: Line = ""
    role: Role


class UserChange(Input):
    """What is given is changed."""

    display_name: Line | None = None
    role: Role | None = None
    active: bool | None = None
    remove_second_factor: bool = Field(default=False, description="For people who lost their authenticator.")


class User(Edited):
    """An account."""

    login: str
    display_name: str
    role: Role
    active: bool
    second_factor: bool
    single_sign_on: bool


class UserFilter(Paging):
    """Which accounts."""

    search: Line = ""


class Colleague(Output):
    """An account as others see it, to share patients with."""

    id: UUID
    display_name: str
    login: str
    role: Role


class OneTimeLink(Output):
    """A link that works once; it is shown once, too."""

    purpose: OneTimePurpose
    url: str = Field(examples=["https://gait.example/link#gll_…"])
    expires_at: datetime


class UserWithLink(Output):
    """A new account and the link for its owner."""

    user: User
    link: OneTimeLink


class NewToken(Input):
    """A token for a program."""

    name: Word
    scopes: Annotated[Sequence[Permission], Field(min_length=1)]
    days: int | None = Field(default=365, ge=1, le=3650, description="Until it expires; null: never.")


class Token(Stored):
    """A token without its text."""

    name: str
    scopes: Sequence[str]
    expires_at: datetime | None
    last_used_at: datetime | None
    revoked_at: datetime | None


class TokenWithText(Output):
    """A token whose text is shown this once."""

    token: Token
    text: str = Field(examples=["glt_…"], description="Send it as 'Authorization: Bearer …'.")
