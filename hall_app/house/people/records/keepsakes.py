"""What a person keeps for himself: favourites; and, where he asked for it, which exhibits he looked at on which day."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import date, datetime

from sqlalchemy import delete, insert, select, update
from sqlalchemy.exc import IntegrityError

from hall_app.house.people.database import Ledger, tables
from hall_app.house.people.errors import PeopleError
from survey.store.database import in_utc, now

__all__ = ["MOST_FAVOURITES", "Favourite", "Keepsakes", "Look"]

MOST_FAVOURITES = 500
_EXHIBIT = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")  # as folders of exhibits are called


@dataclass(frozen=True)
class Favourite:
    """exhibit: its id; made: when it was kept (UTC)."""

    exhibit: str
    made: datetime


@dataclass(frozen=True)
class Look:
    """exhibit: its id; day: when it was looked at closely (UTC), the first time of the day alone."""

    exhibit: str
    day: date


class Keepsakes:
    """Favourites and visits of people."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def favourites(self, person: str) -> tuple[Favourite, ...]:
        """The newest first."""
        table = tables.favourite
        query = select(table).where(table.c.user == person).order_by(table.c.made.desc(), table.c.exhibit)
        with self._ledger.read() as connection:
            return tuple(Favourite(row.exhibit, in_utc(row.made)) for row in connection.execute(query))

    def keep(self, person: str, exhibit: str) -> None:
        """Keep an exhibit; one that is kept stays so. Raises PeopleError."""
        table = tables.favourite
        if not _EXHIBIT.fullmatch(exhibit):
            raise PeopleError("no-exhibit")
        with self._ledger.read() as connection:
            kept = set(connection.execute(select(table.c.exhibit).where(table.c.user == person)).scalars())
        if exhibit in kept:
            return
        if len(kept) >= MOST_FAVOURITES:
            raise PeopleError("favourites-full", most=MOST_FAVOURITES)
        try:
            with self._ledger.change(person, "favourites", person) as connection:
                connection.execute(insert(table).values(user=person, exhibit=exhibit, made=now()))
        except IntegrityError:
            return  # kept by another window just now, or the account is gone: neither leaves anything to do

    def drop(self, person: str, exhibit: str) -> None:
        """Keep it no longer."""
        table = tables.favourite
        with self._ledger.change(person, "favourites", person) as connection:
            connection.execute(delete(table).where(table.c.user == person, table.c.exhibit == exhibit))

    def looks(self, person: str) -> tuple[Look, ...]:
        """The newest first."""
        table = tables.look
        query = select(table).where(table.c.user == person).order_by(table.c.day.desc(), table.c.exhibit)
        with self._ledger.read() as connection:
            return tuple(Look(row.exhibit, row.day) for row in connection.execute(query))

    def note_look(self, person: str, exhibit: str) -> None:
        """An exhibit was looked at; kept once a day, only for who asked for it, and in no journal (`Ledger.keep`).

        The day's rows of a person are written anew each time, in the order of exhibits: neither their place in the
        file nor the transaction that PostgreSQL notes of each row tells which was looked at first, or when.
        """
        table, user, today = tables.look, tables.user, now().date()
        mine = (table.c.user == person, table.c.day == today)
        asked = select(user.c.id).where(user.c.id == person, user.c.keeps_looks == 1)
        day = select(table.c.exhibit).where(*mine)
        with self._ledger.read() as connection:
            if connection.execute(asked).one_or_none() is None:
                return
            if exhibit in connection.execute(day).scalars():
                return
        with self._ledger.keep() as connection:
            # Asked again: it may have been turned off since. The row is nobody else's until the commit.
            if connection.execute(asked.with_for_update()).one_or_none() is None:
                return
            kept = sorted({exhibit, *connection.execute(day).scalars()})
            connection.execute(delete(table).where(*mine))
            connection.execute(
                insert(table), [{"user": person, "exhibit": one, "day": today} for one in kept]
            )

    def set_keeping(self, person: str, *, on: bool) -> None:
        """Whether visits are kept; who no longer wants it has none left. Raises PeopleError."""
        user, table = tables.user, tables.look
        with self._ledger.change(person, "visits", f"{person} {'on' if on else 'off'}") as connection:
            row = update(user).where(user.c.id == person).values(keeps_looks=int(on))
            if not connection.execute(row).rowcount:
                raise PeopleError("no-account")
            if not on:
                connection.execute(delete(table).where(table.c.user == person))
        if not on:
            self._ledger.scrub()
