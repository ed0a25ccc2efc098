"""Places booked, or waited for: never more than there are, in the order of asking, and once however often it is sent.

Whoever changes bookings of an occasion holds its row locked (`_lock`), in SQLite the whole file. What is counted under
the lock holds until the commit, and the table's own check would refuse an overbooking even so. Before it the account is
held whose booking it is (`stays`).
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, Connection, delete, func, select, update

from hall_app.house.people.database import Ledger, tables
from hall_app.house.people.errors import PeopleError
from hall_app.house.people.records.person import stays
from survey.store.database import in_utc, now

__all__ = ["Booking", "Bookings", "promote", "release"]

LONGEST_PARTY = 80
Place = tuple[str, int]  # an occasion and a turn of it, which no other booking ever has; 0 for any turn
ANYWHERE: Place = ("", 0)


@dataclass(frozen=True)
class Booking:
    """size: people; party: name of a class or group; place: on the waiting list from 1, 0: booked. Times in UTC."""

    id: int
    occasion: str
    person: str
    size: int
    party: str
    place: int
    turn: int
    made: datetime
    arrived: datetime | None


class _KnownError(Exception):
    """The form was sent before: what it booked stands, and nothing is changed."""


class Bookings:
    """Who has which places."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def book(self, person: str, occasion: str, size: int, key: str, *, party: str = "") -> Booking:
        """Places, or a place on the waiting list. key: of the form; with the same one it is the same booking.

        Raises PeopleError, also where the account is deleted just now.
        """
        name = " ".join(party.split())[:LONGEST_PARTY]
        try:
            with self._ledger.change(person, "book", occasion) as connection:
                if not stays(connection, person):
                    raise PeopleError("no-account")
                row = _lock(connection, occasion, turn=True)
                if row is None or not _is_to_come(row):
                    raise PeopleError("no-occasion")
                _see_that_it_is_new(connection, person, occasion, key)
                if not 1 <= size <= row.party:
                    raise PeopleError("party-size", most=row.party)
                waits = bool(_waiting(connection, occasion)) or row.taken + size > row.places
                if not waits:
                    _take(connection, occasion, size)
                given = {"occasion": occasion, "user": person, "size": size, "party": name, "key": key}
                new = {"waiting": int(waits), "turn": row.turns, "made": now()}
                connection.execute(tables.booking.insert().values(**given, **new))
        except _KnownError:
            pass
        for booking in self.of(person):
            if booking.occasion == occasion:
                return booking
        raise PeopleError("booking-cancelled")  # meanwhile, by another page of the same person or by the desk

    def of(self, person: str) -> tuple[Booking, ...]:
        """All of one person, the first made first."""
        return self._found(tables.booking.c.user == person)

    def for_occasion(self, occasion: str) -> tuple[Booking, ...]:
        """In the order of asking."""
        return self._found(tables.booking.c.occasion == occasion)

    def cancel(self, who: str, act: str, booking: int, *, person: str = "", place: Place = ANYWHERE) -> None:
        """Give places back, to who waits. act: "cancel booking" of one's own (`person`), "reservations" of another's.

        Raises PeopleError, also for one's own where one was checked in, or once all is over: who was there and who was
        not stays.
        """
        table = tables.booking
        with self._ledger.change(who, act, f"booking {booking}") as connection:
            query = select(table.c.occasion, table.c.user).where(*_named(booking, place))
            query = query.where(table.c.user == person) if person else query
            found = connection.execute(query).one_or_none()
            row = None
            if found is not None and stays(connection, found.user):
                row = _lock(connection, found.occasion)
            if row is None:
                raise PeopleError("no-booking")
            if person and in_utc(row.ends) <= now():
                raise PeopleError("occasion-over")
            if not _give_back(connection, row.id, booking, arrived=not person):
                there = connection.execute(query).one_or_none() is not None
                raise PeopleError("arrived" if there else "no-booking")

    def arrive(self, who: str, booking: int, *, here: bool, place: Place = ANYWHERE) -> None:
        """Check somebody in who has places, or take that back. Raises PeopleError."""
        table = tables.booking
        mine = (*_named(booking, place), table.c.waiting == 0)
        with self._ledger.change(
            who, "check-in", f"booking {booking}{'' if here else ' undone'}"
        ) as connection:
            row = update(table).where(*mine).values(arrived=now() if here else None)
            if not connection.execute(row).rowcount:
                raise PeopleError("no-booking")

    def _found(self, which) -> tuple[Booking, ...]:
        table, before = tables.booking, tables.booking.alias()
        place = (
            select(func.count())
            .select_from(before)
            .where(
                before.c.occasion == table.c.occasion, before.c.waiting == 1, before.c.turn <= table.c.turn
            )
            .scalar_subquery()
        )
        query = select(table, place.label("place")).where(which).order_by(table.c.turn, table.c.id)
        with self._ledger.read() as connection:
            rows = connection.execute(query).all()
        return tuple(
            Booking(
                row.id,
                row.occasion,
                row.user,
                row.size,
                row.party,
                row.place if row.waiting else 0,
                row.turn,
                in_utc(row.made),
                None if row.arrived is None else in_utc(row.arrived),
            )
            for row in rows
        )


def promote(connection: Connection, occasion: str) -> None:
    """Give free places to who waits, strictly in order: a large party at the head is not passed by small ones.

    Of what was called off or has begun nobody gets any: he could not use it, and would be one who did not come.
    """
    table = tables.booking
    row = _lock(connection, occasion)
    if row is None or not _is_to_come(row):
        return
    free = row.places - row.taken
    for first in _waiting(connection, occasion):
        if first.size > free:
            return
        free -= first.size
        connection.execute(update(table).where(table.c.id == first.id).values(waiting=0))
        _take(connection, occasion, first.size)


def release(connection: Connection, person: str) -> None:
    """All bookings of an account that is deleted, in the order of occasions: no two deletions block each other."""
    table = tables.booking
    mine = select(table.c.occasion, table.c.id).where(table.c.user == person).order_by(table.c.occasion)
    for occasion, booking in connection.execute(mine).all():
        _give_back(connection, occasion, booking)


def _named(booking: int, place: Place) -> tuple[ColumnElement[bool], ...]:
    """The row of that number. SQLite gives the number of a cancelled one again: who saw it says what it was."""
    table, (occasion, turn) = tables.booking, place
    where = (table.c.occasion == occasion,) if occasion else ()
    return (table.c.id == booking, *where, *((table.c.turn == turn,) if turn else ()))


def _lock(connection: Connection, occasion: str, *, turn: bool = False):
    """The occasion's row, nobody else's until the commit; None where there is none. turn: give the next number."""
    table = tables.occasion
    row = update(table).where(table.c.id == occasion).values(turns=table.c.turns + int(turn))
    return connection.execute(row.returning(table)).one_or_none()


def _is_to_come(row) -> bool:
    """Whether the occasion of that row takes place, and has not begun."""
    return row.cancelled is None and in_utc(row.begins) > now()


def _waiting(connection: Connection, occasion: str):
    table = tables.booking
    mine = (table.c.occasion == occasion, table.c.waiting == 1)
    return connection.execute(select(table).where(*mine).order_by(table.c.turn)).all()


def _take(connection: Connection, occasion: str, size: int) -> None:
    table = tables.occasion
    connection.execute(update(table).where(table.c.id == occasion).values(taken=table.c.taken + size))


def _give_back(connection: Connection, occasion: str, booking: int, *, arrived: bool = True) -> bool:
    """Whether it was still there. arrived: also of who was checked in."""
    table = tables.booking
    _lock(connection, occasion)
    gone = delete(table).where(table.c.id == booking, *(() if arrived else (table.c.arrived.is_(None),)))
    row = connection.execute(gone.returning(table)).one_or_none()
    if row is None:
        return False
    spent = {"user": row.user, "occasion": occasion, "key": row.key}
    connection.execute(tables.spent_form.insert().values(**spent))
    if not row.waiting:
        _take(connection, occasion, -row.size)
    promote(connection, occasion)
    return True


def _see_that_it_is_new(connection: Connection, person: str, occasion: str, key: str) -> None:
    """Raises _KnownError for a form that was sent before, PeopleError for another by the same person, and for one whose
    booking was cancelled."""
    table = tables.booking
    mine = (table.c.user == person, table.c.occasion == occasion)
    known = connection.execute(select(table.c.key).where(*mine)).scalar_one_or_none()
    if known is not None:
        raise _KnownError if known == key else PeopleError("booked-already")
    spent = tables.spent_form.c
    mine = (spent.user == person, spent.occasion == occasion, spent.key == key)
    if connection.execute(select(spent.key).where(*mine)).one_or_none() is not None:
        raise PeopleError("booking-cancelled")
