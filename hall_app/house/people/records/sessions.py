"""Sessions: who is signed in where. The browser has the token, the store its hash; each can be ended by itself."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta
from hmac import compare_digest

from sqlalchemy import Connection, delete, select, update

from hall_app.house.people.credentials import (
    browser_mark,
    code_step,
    digest,
    matches,
    new_id,
    new_token,
    password_hash,
    stale,
    typed_code,
)
from hall_app.house.people.database import NOBODY, Ledger, tables
from hall_app.house.people.errors import PeopleError
from hall_app.house.people.records.person import Person, found_by, is_as_it_was
from survey.store.database import in_utc, now

__all__ = ["OFFICE_HOURS", "VISITOR_DAYS", "Session", "Sessions", "end_all", "use_second_factor"]

VISITOR_DAYS = 30
OFFICE_HOURS = 12  # a working day: a desk that is left in the evening is locked in the morning


@dataclass(frozen=True)
class Session:
    """id: by which it is ended. Of a browser nothing is kept, only when it signed in (UTC)."""

    id: int
    office: bool
    made: datetime
    expires: datetime


class Sessions:
    """Signing in and out."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def sign_in(
        self, address: str, password: str, code: str = "", *, office: bool = False
    ) -> tuple[Person, str]:
        """The person and a new token. code: of the authenticator, or a recovery code, where one is set up.

        Raises PeopleError: one and the same for a wrong address, password and code.
        """
        table = tables.user
        with self._ledger.read() as connection:
            row = connection.execute(select(table).where(table.c.address == address)).one_or_none()
        right = matches(password, None if row is None else row.password)
        if row is None:
            raise PeopleError("sign-in")
        subject = "office" if office else "visitor"
        step = code_step(row.authenticator, code) if row.authenticator else None
        if not right or row.closed is not None:
            self._ledger.refuse(NOBODY, "sign in", row.id)
            raise PeopleError("sign-in")
        again = password_hash(password) if stale(row.password) else None
        try:
            with self._ledger.change(row.id, "sign in", subject) as connection:
                person = found_by(connection, id=row.id) if is_as_it_was(connection, row) else None
                if person is None or (
                    row.authenticator and not use_second_factor(connection, row.id, step, code)
                ):
                    raise PeopleError("sign-in")
                if office and not person.roles:
                    raise PeopleError("no-office")
                if again is not None:
                    mine = (table.c.id == row.id, table.c.password == row.password)
                    connection.execute(update(table).where(*mine).values(password=again))
                return person, _opened(connection, row.id, office)
        except PeopleError:
            self._ledger.refuse(NOBODY, "sign in", row.id)
            raise

    def open(self, person: Person, *, office: bool = False) -> str:
        """A token for somebody who has just proved himself otherwise: by a code, or by signing up."""
        with self._ledger.change(person.id, "sign in", "office" if office else "visitor") as connection:
            return _opened(connection, person.id, office)

    def mark(self, person: str) -> str:
        """For a browser to keep that was let in to that account: by it `knows` tells it from strangers. No way in."""
        table = tables.user
        with self._ledger.read() as connection:
            kept = connection.execute(
                select(table.c.password).where(table.c.id == person)
            ).scalar_one_or_none()
        return browser_mark(new_id(), person, kept) if kept else ""

    def knows(self, address: str, mark: str) -> bool:
        """Whether a browser that keeps this mark was let in to the account of that address, by its password of now."""
        table, (nonce, _, told) = tables.user, mark.partition(".")
        if not told:
            return False
        with self._ledger.read() as connection:
            row = connection.execute(select(table).where(table.c.address == address)).one_or_none()
        if row is None or row.password is None:
            return False
        return compare_digest(browser_mark(nonce, row.id, row.password).encode(), mark.encode())

    def find(self, token: str, *, office: bool = False) -> tuple[Person, Session] | None:
        """Whose token it is; None for one that is unknown, ended, out of date or of the other kind."""
        table = tables.session
        mine = (table.c.digest == digest(token), table.c.office == int(office), table.c.expires > now())
        with self._ledger.read() as connection:
            row = connection.execute(select(table).where(*mine)).one_or_none()
            person = None if row is None else found_by(connection, id=row.user)
        if row is None or person is None or person.closed is not None or (office and not person.roles):
            return None
        return person, _session(row)

    def of(self, person: str) -> tuple[Session, ...]:
        """Those of one person that are good now, the newest first."""
        table = tables.session
        mine = (table.c.user == person, table.c.expires > now())
        with self._ledger.read() as connection:
            rows = connection.execute(select(table).where(*mine).order_by(table.c.id.desc())).all()
        return tuple(_session(row) for row in rows)

    def end(self, who: str, act: str, person: str, session: int) -> None:
        """End one of a person's. act: "sign out" of one's own, "people" of another's. Raises PeopleError."""
        table = tables.session
        with self._ledger.change(who, act, f"{person} session {session}") as connection:
            mine = (table.c.id == session, table.c.user == person)
            if not connection.execute(delete(table).where(*mine)).rowcount:
                raise PeopleError("no-session")

    def end_all(self, who: str, act: str, person: str, *, but: int | None = None) -> int:
        """End all of a person's but one, and any code that would open another. How many there were."""
        with self._ledger.change(who, act, f"{person} all sessions") as connection:
            return end_all(connection, person, but=but)


def end_all(connection: Connection, person: str, *, but: int | None = None) -> int:
    """As Sessions.end_all, within a change."""
    table, code = tables.session, tables.code
    connection.execute(delete(code).where(code.c.user == person, code.c.purpose == "open"))
    return connection.execute(delete(table).where(table.c.user == person, table.c.id != (but or 0))).rowcount


def _opened(connection: Connection, person: str, office: bool) -> str:
    token, moment, table = new_token(), now(), tables.session
    lasts = timedelta(hours=OFFICE_HOURS) if office else timedelta(days=VISITOR_DAYS)
    connection.execute(delete(table).where(table.c.expires <= moment))
    row = {"digest": digest(token), "user": person, "office": int(office)}
    connection.execute(table.insert().values(made=moment, expires=moment + lasts, **row))
    return token


def use_second_factor(connection: Connection, person: str, step: int | None, code: str) -> bool:
    """Whether the code is good, and now used: two who send the same at once cannot both come in.

    step: of the authenticator's, None where it is none of its codes: it may be a recovery code.
    """
    user, kept = tables.user, tables.code
    if step is not None:
        unused = user.c.step.is_(None) | (user.c.step < step)
        return (
            connection.execute(update(user).where(user.c.id == person, unused).values(step=step)).rowcount
            == 1
        )
    mine = (kept.c.user == person, kept.c.purpose == "recovery", kept.c.digest == digest(typed_code(code)))
    return connection.execute(delete(kept).where(*mine)).rowcount == 1


def _session(row) -> Session:
    return Session(row.id, bool(row.office), in_utc(row.made), in_utc(row.expires))
