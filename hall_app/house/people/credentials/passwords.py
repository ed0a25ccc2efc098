"""Passwords: what makes a good one, and argon2id hashes of them. Neither says anything of the password itself."""

from __future__ import annotations

import unicodedata
from functools import lru_cache
from typing import TYPE_CHECKING

from hall_app.house.people.errors import PeopleError

if TYPE_CHECKING:
    from argon2 import PasswordHasher

__all__ = ["checked_password", "matches", "password_hash", "stale"]

LEAST, MOST, DIFFERENT = 10, 200, 5  # characters
MEMORY = (
    46 << 10
)  # [KiB]; with one pass and one lane, as OWASP advises: a class that signs in shares two cores


def checked_password(password: str, address: str) -> str:
    """The password as it is hashed. Raises PeopleError for one that is short, endless or easily guessed.

    No rule asks for digits or signs: length is what counts, and any manager's password passes.
    """
    told = _normal(password)
    if len(told) < LEAST:
        raise PeopleError("password-short", least=LEAST)
    if len(told) > MOST:
        raise PeopleError("password-long", most=MOST)
    own, plain = address.partition("@")[0], told.casefold()
    if len(set(told)) < DIFFERENT or (len(own) > 3 and own in plain and len(plain) < 2 * len(own) + LEAST):
        raise PeopleError("password-plain", least=DIFFERENT)
    return told


def password_hash(password: str) -> str:
    """argon2id, salted: some 30 ms and 46 MB of work."""
    return _hasher().hash(_normal(password))


def matches(password: str, kept: str | None) -> bool:
    """Whether it is the password of that hash; without one it takes as long, and is not."""
    from argon2.exceptions import InvalidHashError, VerificationError

    try:
        return _hasher().verify(kept or _nobodys(), _normal(password[: 4 * MOST])) and kept is not None
    except (VerificationError, InvalidHashError):
        return False


def stale(kept: str) -> bool:
    """Whether a hash was made with weaker settings than today's."""
    return _hasher().check_needs_rehash(kept)


def _normal(password: str) -> str:
    # Keyboards differ in how they spell one letter: é as one sign or as two, full width or half.
    return unicodedata.normalize("NFKC", password)


@lru_cache(maxsize=1)
def _hasher() -> PasswordHasher:
    from argon2 import PasswordHasher

    return PasswordHasher(time_cost=1, memory_cost=MEMORY, parallelism=1)


@lru_cache(maxsize=1)
def _nobodys() -> str:
    return _hasher().hash("nobody's password")
