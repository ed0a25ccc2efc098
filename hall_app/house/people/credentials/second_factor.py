"""Time-based codes of an authenticator app (RFC 6238): six digits that change every half minute."""

from __future__ import annotations

import re
import time

__all__ = ["AUTHENTICATOR", "authenticator_address", "code_step", "new_authenticator"]

AUTHENTICATOR = re.compile(r"\s*\d{3}\s?\d{3}\s*")
STEP = 30  # [s]
_NEAR = 1  # steps by which a phone's clock may be off


def new_authenticator() -> str:
    """A new shared secret, 160 random bits in base 32."""
    import pyotp

    return pyotp.random_base32()


def authenticator_address(secret: str, address: str, house: str) -> str:
    """The otpauth:// address that an authenticator app reads."""
    from pyotp.totp import TOTP

    return TOTP(secret).provisioning_uri(name=address, issuer_name=house)


def code_step(secret: str, code: str, now: float | None = None) -> int | None:
    """The half minute that the code belongs to, None for a wrong one. Whoever asks lets no step in twice."""
    from pyotp.totp import TOTP

    moment, given = time.time() if now is None else now, re.sub(r"\s", "", code)
    totp = TOTP(secret)
    for near in range(-_NEAR, _NEAR + 1):
        if totp.verify(given, for_time=int(moment + near * STEP)):
            return int(moment + near * STEP) // STEP
    return None
