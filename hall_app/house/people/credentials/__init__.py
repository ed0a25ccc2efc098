"""What a person proves himself with: passwords, an authenticator's codes, secrets that the house made."""

from hall_app.house.people.credentials.codes import (
    browser_mark,
    digest,
    new_code,
    new_id,
    new_password,
    new_token,
    typed_code,
)
from hall_app.house.people.credentials.passwords import checked_password, matches, password_hash, stale
from hall_app.house.people.credentials.second_factor import (
    AUTHENTICATOR,
    authenticator_address,
    code_step,
    new_authenticator,
)

__all__ = [
    "AUTHENTICATOR",
    "authenticator_address",
    "browser_mark",
    "checked_password",
    "code_step",
    "digest",
    "matches",
    "new_authenticator",
    "new_code",
    "new_id",
    "new_password",
    "new_token",
    "password_hash",
    "stale",
    "typed_code",
]
