"""Time-based one-time passwords (RFC 6238): 6 digits, 30 s, one step of clock error either way, each used once."""

import time

from pyotp import random_base32
from pyotp.totp import TOTP
from pyotp.utils import strings_equal

STEP = 30  # [s]
DRIFT = 1
"""Steps of clock error that are accepted, before and after."""


def new_secret() -> str:
    """Secret shared with the user's authenticator, base 32."""
    return random_base32()


def provisioning_uri(secret: str, account: str) -> str:
    """Address that authenticators read as a QR code."""
    return TOTP(secret).provisioning_uri(name=account, issuer_name="gaitlab")


def accepted_step(secret: str, code: str, last_used: int | None, now: float | None = None) -> int | None:
    """Number of the time step that `code` belongs to; None if it is wrong or was used before.

    Args:
        secret: The user's secret, base 32.
        code: What the user typed; spaces are ignored.
        last_used: Step of the last accepted code, which and before which none is accepted again.
        now: Unix time [s]; None: the clock's.
    """
    typed = code.replace(" ", "")
    current = int((time.time() if now is None else now) // STEP)
    generator = TOTP(secret)
    for step in range(current - DRIFT, current + DRIFT + 1):
        if strings_equal(typed, generator.generate_otp(step)):
            return None if last_used is not None and step <= last_used else step
    return None
