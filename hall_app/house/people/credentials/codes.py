"""Secrets that the house makes: shown once, kept only as a hash."""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets

__all__ = ["browser_mark", "digest", "new_code", "new_id", "new_password", "new_token", "typed_code"]

_LETTERS = "23456789ABCDEFGHJKMNPQRSTVWXYZ"  # none that is taken for another when read from paper
_GROUPS, _GROUP = 3, 4


def new_token() -> str:
    """256 random bits, for a cookie or an address."""
    return secrets.token_urlsafe(32)


def new_id() -> str:
    """Names a person where the address would be too much: 64 random bits."""
    return secrets.token_hex(8)


def new_code() -> str:
    """Printed on paper and typed in again: ABCD-EFGH-JKMN, 58 random bits."""
    groups = ("".join(secrets.choice(_LETTERS) for _ in range(_GROUP)) for _ in range(_GROUPS))
    return "-".join(groups)


def new_password() -> str:
    """A password that a machine makes and a person types once."""
    return "-".join((new_code(), new_code())).lower()


def typed_code(text: str) -> str:
    """A code as it was printed, however it was typed: small letters, spaces, dashes of any kind."""
    return re.sub(r"[\s\-–—－.]", "", text).upper()[:100]


def digest(secret: str) -> str:
    """What is kept of it. The secret is random, so a slow hash would add nothing."""
    return hashlib.sha256(secret.encode("utf-8", "replace")).hexdigest()


def browser_mark(nonce: str, person: str, kept: str) -> str:
    """By what an account knows a browser again: it says nothing of the account, and is void with its password.

    kept: hash of the password, whose salt nobody outside has.
    """
    told = hmac.new(kept.encode(), f"browser {nonce} {person}".encode(), hashlib.sha256)
    return f"{nonce}.{told.hexdigest()[:40]}"
