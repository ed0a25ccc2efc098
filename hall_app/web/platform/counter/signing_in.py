"""What one signs in with, at the visitors' counter and at the office's, and the tries that are counted for both."""

from __future__ import annotations

from hall_app.house.people import Person
from hall_app.web.platform.counter.asking import Asking
from hall_app.web.platform.counter.counter import Counter
from hall_app.web.platform.counter.fields import Field

__all__ = ["address_field", "sign_in_fields", "signed_in"]


def address_field(asking: Asking) -> Field:
    label = asking.word("电子邮箱", "E-mail address")
    return Field("address", label, "email", given={"autocomplete": "username", "maxlength": "254"})


def sign_in_fields(asking: Asking, *, code_hint: str = "") -> tuple[Field, Field, Field]:
    """Address, password, and the code of a second factor."""
    word = asking.word
    return (
        address_field(asking),
        Field("password", word("密码", "Password"), "password", given={"autocomplete": "current-password"}),
        Field(
            "code",
            word("验证码（如已开启两步验证）", "Authenticator code (where one is set up)"),
            needed=False,
            hint=code_hint,
            given={"autocomplete": "one-time-code", "maxlength": "40"},
        ),
    )


def signed_in(counter: Counter, asking: Asking) -> tuple[Person, str]:
    """Who gave these fields, and the token of the session that begins. Raises PeopleError, also for too many tries."""
    from hall_app.house.people.records import checked_address

    given = asking.form
    address = checked_address(given.get("address", ""))
    counter.pace.take("try from here", asking.network)
    counter.pace.take("account from here", address, asking.network)
    counter.pace.take("account", address)
    return counter.people.sessions.sign_in(
        address, given.get("password", ""), given.get("code", ""), office=counter.kind.office
    )
