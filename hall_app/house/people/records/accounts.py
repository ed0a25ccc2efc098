"""Accounts: made, opened by a code, changed, handed out and deleted. What is deleted is gone from every table."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta

from sqlalchemy import Connection, Row, delete, select, update
from sqlalchemy.exc import IntegrityError

from hall_app.house.people.credentials import (
    checked_password,
    code_step,
    digest,
    matches,
    new_code,
    new_id,
    new_token,
    password_hash,
    typed_code,
)
from hall_app.house.people.database import NOBODY, Ledger, tables
from hall_app.house.people.errors import PeopleError
from hall_app.house.people.records.bookings import release
from hall_app.house.people.records.person import (
    Person,
    checked_address,
    checked_name,
    everybody,
    found_by,
    how_many,
    is_as_it_was,
    see_that_one_is_left,
    stays,
)
from hall_app.house.people.records.sessions import end_all, use_second_factor
from survey.store.database import now

__all__ = ["CODE_DAYS", "RECOVERY_CODES", "Accounts"]

CODE_DAYS = 3  # a one-time code or link is good for so long
RECOVERY_CODES = 10


class Accounts:
    """Everybody who has an account, visitors and staff alike: staff are people with roles."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def find(self, *, address: str) -> Person:
        """The person of that address. Raises PeopleError."""
        with self._ledger.read() as connection:
            person = found_by(connection, address=checked_address(address))
        if person is None:
            raise PeopleError("no-account")
        return person

    def of(self, person: str) -> Person:
        """The person of that id. Raises PeopleError."""
        with self._ledger.read() as connection:
            found = found_by(connection, id=person)
        if found is None:
            raise PeopleError("no-account")
        return found

    def all(self, wanted: str = "", most: int = 200) -> tuple[Person, ...]:
        """People whose address or name holds `wanted`, staff first; `most` at most."""
        with self._ledger.read() as connection:
            return everybody(connection, wanted, most)

    def count(self, wanted: str = "") -> int:
        """How many people's address or name holds `wanted`."""
        with self._ledger.read() as connection:
            return how_many(connection, wanted)

    def sign_up(self, address: str, password: str, *, name: str = "", language: str = "zh") -> Person:
        """A visitor's account, not verified yet. Raises PeopleError."""
        told = checked_address(address)
        hashed = password_hash(checked_password(password, told))
        return self.make(new_id(), told, name=name, language=language, hashed=hashed)

    def make(
        self, who: str, address: str, *, name: str = "", language: str = "zh", hashed: str | None = None
    ) -> Person:
        """An account; without a password a code opens it. who: the new id itself where one signs up.

        Raises PeopleError.
        """
        own = hashed is not None
        person, told = who if own else new_id(), checked_address(address)
        row = {"address": told, **checked_name(name), "language": language, "password": hashed}
        try:
            with self._ledger.change(who, "sign up" if own else "people", person) as connection:
                connection.execute(tables.user.insert().values(id=person, made=now(), **row))
                found = found_by(connection, id=person)
        except IntegrityError:
            raise PeopleError("address-taken") from None
        assert found is not None
        return found

    def set_profile(self, person: str, *, name: str, language: str) -> None:
        """Raises PeopleError."""
        values = {**checked_name(name), "language": "en" if language == "en" else "zh"}
        with self._ledger.change(person, "profile", person) as connection:
            _set(connection, person, **values)

    def set_password(self, person: Person, old: str, new: str, *, keep: int | None = None) -> None:
        """Change one's own password; all sessions but `keep` end, codes and links are void. Raises PeopleError."""
        proved = self._prove(person.id, "password", old)
        hashed = password_hash(checked_password(new, person.address))
        with self._own_change(proved, "password") as connection:
            _set(connection, person.id, password=hashed)
            end_all(connection, person.id, but=keep)

    def code_for(self, who: str, person: str, *, long: bool = False) -> str:
        """A one-time code that opens the account, or one for a link (`long`); earlier ones are good no more.

        Raises PeopleError, also for a closed account, which no code opens.
        """
        secret, table = new_token() if long else new_code(), tables.code
        kept = digest(secret if long else typed_code(secret))
        row = {"digest": kept, "user": person, "purpose": "open"}
        with self._ledger.change(who, "people", f"{person} code") as connection:
            found = found_by(connection, id=person) if stays(connection, person) else None
            if found is None or found.closed is not None:
                raise PeopleError("no-account" if found is None else "account-closed")
            connection.execute(delete(table).where(table.c.user == person, table.c.purpose == "open"))
            connection.execute(table.insert().values(expires=now() + timedelta(days=CODE_DAYS), **row))
        return secret

    def holder(self, secret: str) -> Person:
        """Whose code or link that is, unused. Raises PeopleError."""
        with self._ledger.read() as connection:
            row = _open_code(connection, secret)
            person = None if row is None else found_by(connection, id=row.user)
        if person is None or person.closed is not None:
            raise PeopleError("code")
        return person

    def use_code(self, secret: str, password: str) -> Person:
        """Verify the account and set its password; all its sessions end, and of one that was not verified before the
        second factor goes. Raises PeopleError, and the code is kept."""
        person = self.holder(secret)
        hashed = password_hash(checked_password(password, person.address))
        # Whoever made an account of an address that he never proved to be his may have left an authenticator as well.
        factor = {} if person.verified else {"authenticator": None, "step": None}
        with self._ledger.change(person.id, "use code", person.id) as connection:
            row = _open_code(connection, secret)
            if (
                row is None
                or not connection.execute(delete(tables.code).where(tables.code.c.id == row.id)).rowcount
            ):
                raise PeopleError("code")
            _set(connection, person.id, password=hashed, verified=now(), **factor)
            if factor:
                _drop_recovery(connection, person.id)
            end_all(connection, person.id)
            opened = found_by(connection, id=person.id)
        assert opened is not None
        return opened

    def begin_second_factor(
        self, person: Person, password: str, secret: str, code: str, present: str = ""
    ) -> tuple[str, ...]:
        """Share a secret with an app that has just shown a right code. The recovery codes. Raises PeopleError.

        present: a code of the factor that is on already, which this one takes the place of.
        """
        proved = self._prove(person.id, "second factor", password)
        step = code_step(secret, code)
        if step is None:
            raise PeopleError("authenticator")
        codes = tuple(new_code() for _ in range(RECOVERY_CODES))
        with self._own_change(proved, "second factor", present=present) as connection:
            _drop_recovery(connection, person.id)
            _set(connection, person.id, authenticator=secret, step=step)
            rows = [
                {"digest": digest(typed_code(code)), "user": person.id, "purpose": "recovery"}
                for code in codes
            ]
            connection.execute(tables.code.insert(), rows)
        return codes

    def end_second_factor(self, person: Person, password: str, present: str = "") -> None:
        """Turn it off. present: one of its codes. Raises PeopleError."""
        proved = self._prove(person.id, "second factor", password)
        with self._own_change(proved, "second factor", " off", present=present) as connection:
            _drop_recovery(connection, person.id)
            _set(connection, person.id, authenticator=None, step=None)

    def drop_second_factor(self, who: str, person: str) -> None:
        """An administrator's way for who lost his phone and the recovery codes."""
        with self._ledger.change(who, "people", f"{person} second factor off") as connection:
            _drop_recovery(connection, person)
            _set(connection, person, authenticator=None, step=None)

    def close(self, who: str, person: str, *, closed: bool) -> None:
        """Shut an account, which ends its sessions, or open it again. Raises PeopleError."""
        with self._ledger.change(who, "people", f"{person} {'closed' if closed else 'opened'}") as connection:
            _set(connection, person, closed=now() if closed else None)
            if closed:
                end_all(connection, person)
                see_that_one_is_left(connection)

    def delete(self, person: Person, password: str) -> None:
        """Delete one's own account; the journal keeps an id that leads to nobody. Raises PeopleError."""
        proved = self._prove(person.id, "delete account", password)
        with self._own_change(proved, "delete account") as connection:
            _delete(connection, person.id)
        self._ledger.scrub()

    def remove(self, who: str, person: str) -> None:
        """Delete another's account, as `delete` does: of one that is closed its owner cannot. Raises PeopleError."""
        with self._ledger.change(who, "people", f"{person} deleted") as connection:
            _delete(connection, person)
        self._ledger.scrub()

    def _prove(self, person: str, act: str, password: str) -> Row:
        """The account's row as it was when the password was found right. Raises PeopleError."""
        table = tables.user
        with self._ledger.read() as connection:
            kept = connection.execute(select(table).where(table.c.id == person)).one_or_none()
        if not matches(password, None if kept is None else kept.password) or kept is None:
            self._ledger.refuse(NOBODY, act, person)
            raise PeopleError("password-wrong")
        return kept

    @contextmanager
    def _own_change(
        self, proved: Row, act: str, more: str = "", *, present: str | None = None
    ) -> Iterator[Connection]:
        """A change of one's own account, which is still the one that was proved. Raises PeopleError.

        present: a code of the second factor, where one is on; None: it is not asked for.
        """
        secret, code = None if present is None else proved.authenticator, present or ""
        step = code_step(secret, code) if secret else None
        try:
            with self._ledger.change(proved.id, act, f"{proved.id}{more}") as connection:
                if not is_as_it_was(connection, proved):
                    raise PeopleError("password-wrong")
                if secret and not use_second_factor(connection, proved.id, step, code):
                    raise PeopleError("present-factor")
                yield connection
        except PeopleError as error:
            if error.key in ("password-wrong", "present-factor"):
                self._ledger.refuse(NOBODY, act, proved.id)
            raise


def _delete(connection: Connection, person: str) -> None:
    """Raises PeopleError where the account is gone, or no administrator would be left."""
    found = found_by(connection, id=person) if stays(connection, person, alone=True) else None
    if found is None:
        raise PeopleError("no-account")
    release(connection, person)
    for table in (
        tables.code,
        tables.session,
        tables.role,
        tables.favourite,
        tables.look,
        tables.answer_code,
        tables.spent_form,
    ):
        connection.execute(delete(table).where(table.c.user == person))
    connection.execute(delete(tables.user).where(tables.user.c.id == person))
    if found.roles:
        see_that_one_is_left(connection)


def _set(connection: Connection, person: str, **values: object) -> None:
    """Raises PeopleError where the account is gone."""
    if not connection.execute(
        update(tables.user).where(tables.user.c.id == person).values(**values)
    ).rowcount:
        raise PeopleError("no-account")


def _drop_recovery(connection: Connection, person: str) -> None:
    table = tables.code
    connection.execute(delete(table).where(table.c.user == person, table.c.purpose == "recovery"))


def _open_code(connection: Connection, secret: str):
    """The row of an unused code or link, typed in any way; None for another."""
    table = tables.code
    known = {digest(secret.strip()[:100]), digest(typed_code(secret))}
    good = (table.c.digest.in_(known), table.c.purpose == "open", table.c.expires > now())
    return connection.execute(select(table).where(*good)).one_or_none()
