"""Passwords: argon2id as pwdlib sets it (RFC 9106), and which are acceptable (NIST SP 800-63B, 3.1.1)."""

from pwdlib import PasswordHash
from pwdlib.hashers.argon2 import Argon2Hasher

from ..errors import InvalidRequest

SHORTEST, LONGEST = 12, 256
_HASHER = PasswordHash((Argon2Hasher(),))
_DUMMY = "$argon2id$v=19$m=65536,t=3,p=4$bbn6/bzYuDKOnsDu5GPGGw$amzYkicvjPeI7EtOzxnPbsglSBRxM39Wa9WGkynQl+A"
"""Hash of a password that nobody knows, with our parameters (a test compares): to make one would delay every start."""


def check_acceptable(password: str, *about: str) -> None:
    """Raise InvalidRequest for a password that is too short, too plain, or the same as `about` (name, address)."""
    if not SHORTEST <= len(password) <= LONGEST:
        raise InvalidRequest(f"the password has {len(password)} characters: use {SHORTEST} to {LONGEST}")
    if len(set(password)) < 5:
        raise InvalidRequest("the password repeats few characters: use at least 5 different ones")
    if any(word and password.casefold() == word.casefold() for word in about):
        raise InvalidRequest("the password is the name or the address of the account: choose another")


def hash_password(password: str) -> str:
    """Encoded argon2id hash with its own salt and parameters."""
    return _HASHER.hash(password)


def verify_password(password: str, encoded: str | None) -> tuple[bool, str | None]:
    """Whether the password fits, and a new hash where the stored one has old parameters.

    Without a stored hash the same time is spent, so that an answer does not tell which accounts exist.
    """
    if encoded is None:
        _HASHER.verify(password, _DUMMY)
        return False, None
    return _HASHER.verify_and_update(password, encoded)
