"""What one signs in with, at the visitors' counter and at the office's, and the tries that are counted for both."""

from __future__ import annotations

from dataclasses import dataclass

from hall_app.house.people import Person
from hall_app.web.platform.counter.asking import Asking
from hall_app.web.platform.counter.counter import Counter
from hall_app.web.platform.counter.fields import Field

__all__ = ["Entered", "address_field", "sign_in_fields", "signed_in"]


@dataclass(frozen=True)
class Entered:
    """token: of the session that begins; mark: by which this browser is known at the account from now on."""

    person: Person
    token: str
    mark: str


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


def signed_in(counter: Counter, asking: Asking) -> Entered:
    """Who gave these fields, and what begins with it. Raises PeopleError, also for too many tries.

    A browser that was let in to this account before is counted by itself, so that no stranger uses up its tries.
    """
    from hall_app.house.people.records import checked_address

    given, sessions = asking.form, counter.people.sessions
    address = checked_address(given.get("address", ""))
    counter.pace.take("try from here", asking.network)
    with counter.pace.failures(*_counts(address, asking, known=sessions.knows(address, asking.mark))):
        person, token = sessions.sign_in(
            address, given.get("password", ""), given.get("code", ""), office=counter.kind.office
        )
    return Entered(person, token, sessions.mark(person.id))


def _counts(address: str, asking: Asking, *, known: bool) -> tuple[tuple[str, ...], ...]:
    """What a try that fails is counted by."""
    if known:
        browser = f"browser {asking.mark}"
        return ("account from here", address, browser), ("account", address, browser)
    here = (address, asking.network)
    return ("account from here", *here), ("account share", *here), ("account", address)
