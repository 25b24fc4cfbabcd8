"""Opaque random tokens: the caller holds the text, the database holds its SHA-256.

256 random bits need no slow hash: nobody can try them all.
"""

import hashlib
import hmac
import secrets

SESSION, API, LINK = "gls", "glt", "gll"
"""What a token is for; secret scanners find leaked tokens by these letters."""
_BYTES = 32


def new_token(kind: str) -> tuple[str, str]:
    """Text to hand out once, and hash to store."""
    text = f"{kind}_{secrets.token_urlsafe(_BYTES)}"
    return text, token_hash(text)


def token_hash(text: str) -> str:
    """Hash under which a token is found, hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()


def csrf_token(session_token: str) -> str:
    """Token that scripts of our own pages send along with every change.

    HMAC of the session's token, which no script can read: a page of another origin can cause requests with the
    session's cookie but cannot know this value.
    """
    return hmac.new(session_token.encode(), b"csrf", hashlib.sha256).hexdigest()


def same(given: str, expected: str) -> bool:
    """Comparison that takes equally long whatever differs."""
    return hmac.compare_digest(given.encode(), expected.encode())
