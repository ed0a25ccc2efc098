"""What has places: activities, and slots of a day for visits. Planned, changed, called off by the office."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, astuple, dataclass, replace
from datetime import UTC, datetime

from sqlalchemy import ColumnElement, Connection, Select, func, select, update

from hall_app.house.people.credentials import new_id
from hall_app.house.people.database import Ledger, tables
from hall_app.house.people.errors import PeopleError
from hall_app.house.people.records.bookings import promote
from survey.store.database import in_utc, now

__all__ = ["Occasion", "Occasions", "Plan"]

MOST_PLACES, LONGEST_TITLE, LONGEST_TEXT = 1000, 120, 4000
FIRST_YEAR, YEARS_AHEAD = 1970, 10  # at the ends of all time an hour of one zone is none in another


@dataclass(frozen=True)
class Plan:
    """What the office writes of an occasion. kind: "activity" or "visit"; party: the most one booking may be for."""

    kind: str
    title_zh: str
    title_en: str
    begins: datetime
    ends: datetime
    places: int
    party: int
    text_zh: str = ""
    text_en: str = ""
    place_zh: str = ""
    place_en: str = ""

    @property
    def mark(self) -> str:
        """What a form brings back that showed it; another for any change."""
        told = [value.isoformat() if isinstance(value, datetime) else value for value in astuple(self)]
        return hashlib.sha256(json.dumps(told).encode()).hexdigest()[:16]

    def checked(self, least: int = 1) -> Plan:
        """As it is kept. least: places that it must have, for who has booked or waits. Raises PeopleError."""
        titles, places = (self.title_zh.strip(), self.title_en.strip()), (self.place_zh, self.place_en)
        if not all(0 < len(title) <= LONGEST_TITLE and title.isprintable() for title in titles):
            raise PeopleError("occasion-title")
        if not self.begins < self.ends:
            raise PeopleError("occasion-times")
        last = now().year + YEARS_AHEAD
        if not FIRST_YEAR <= self.begins.year <= self.ends.year <= last:
            raise PeopleError("occasion-far", first=FIRST_YEAR, last=last)
        if not least <= self.places <= MOST_PLACES or not 1 <= self.party <= self.places:
            raise PeopleError("occasion-places", least=least)
        if (
            max(map(len, (self.text_zh, self.text_en))) > LONGEST_TEXT
            or max(map(len, places)) > LONGEST_TITLE
            or not all(_legible(text) for text in (self.text_zh, self.text_en, *places))
        ):
            raise PeopleError("occasion-text")
        if self.kind not in ("activity", "visit"):
            raise PeopleError("occasion-kind")
        # SQLite keeps the clock of what it is given and not its zone.
        times = {"begins": self.begins.astimezone(UTC), "ends": self.ends.astimezone(UTC)}
        return replace(self, title_zh=titles[0], title_en=titles[1], **times)


@dataclass(frozen=True)
class Occasion:
    """id; plan; taken: places booked; waiting: people on the waiting list. Times are in UTC."""

    id: str
    plan: Plan
    taken: int
    waiting: int
    cancelled: datetime | None

    @property
    def left(self) -> int:
        """Places that may be booked at once: none while somebody waits."""
        return 0 if self.waiting else self.plan.places - self.taken

    def told(self, what: str, lang: str) -> str:
        """ "title", "text" or "place" in "zh" or "en"; of texts that were not translated the other."""
        other = "en" if lang == "zh" else "zh"
        return getattr(self.plan, f"{what}_{lang}") or getattr(self.plan, f"{what}_{other}")


class Occasions:
    """The programme."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def to_come(
        self,
        kind: str = "",
        *,
        past: bool = False,
        off: bool = False,
        start: int = 0,
        most: int | None = None,
    ) -> tuple[Occasion, ...]:
        """Those that are not over, of that kind or all, the next first; past: over or off, the last first.

        off: those to come that were called off as well, for calendars that have them already; start, most: a part of
        the list, from that one on (from 0).
        """
        table = tables.occasion
        order = table.c.begins.desc() if past else table.c.begins
        query = select(table).where(*_listed(kind, past=past, off=off)).order_by(order, table.c.id)
        return self._found(query.offset(start).limit(most))

    def between(self, first: datetime, end: datetime, kind: str = "") -> tuple[Occasion, ...]:
        """Those that begin from `first` on and before `end`, over or not, none that was called off, in order."""
        table = tables.occasion
        query = select(table).where(
            table.c.begins >= first.astimezone(UTC), table.c.begins < end.astimezone(UTC)
        )
        query = query.where(table.c.cancelled.is_(None)).order_by(table.c.begins, table.c.id)
        return self._found(query.where(table.c.kind == kind) if kind else query)

    def beginnings(self, kind: str = "") -> tuple[datetime, ...]:
        """When those that are not over begin, in order."""
        table = tables.occasion
        query = select(table.c.begins).where(*_listed(kind)).order_by(table.c.begins)
        with self._ledger.read() as connection:
            return tuple(in_utc(row.begins) for row in connection.execute(query))

    def _found(self, query: Select) -> tuple[Occasion, ...]:
        with self._ledger.read() as connection:
            rows = connection.execute(query).all()
            waiting = _waiting(connection)
        return tuple(_occasion(row, waiting.get(row.id, 0)) for row in rows)

    def of(self, key: str) -> Occasion:
        """Raises PeopleError."""
        table = tables.occasion
        with self._ledger.read() as connection:
            row = connection.execute(select(table).where(table.c.id == key)).one_or_none()
            waiting = _waiting(connection)
        if row is None:
            raise PeopleError("no-occasion")
        return _occasion(row, waiting.get(row.id, 0))

    def plan(self, who: str, *plans: Plan) -> tuple[str, ...]:
        """New occasions, all or none; their ids. Raises PeopleError."""
        rows = [{"id": new_id(), "taken": 0, "turns": 0, **asdict(plan.checked())} for plan in plans]
        subject = " ".join(row["id"] for row in rows)
        with self._ledger.change(who, "events", subject) as connection:
            connection.execute(tables.occasion.insert(), rows)
        return tuple(row["id"] for row in rows)

    def change(self, who: str, key: str, plan: Plan, seen: str = "") -> None:
        """Who waits gets places that were added. seen: the mark of the plan that was looked at, "" for none.

        Raises PeopleError, also where it is another by now, and for fewer places than are booked, or than a party that
        waits needs: the list is served in order, and nobody would ever pass it.
        """
        table, waits = tables.occasion, tables.booking
        with self._ledger.change(who, "events", key) as connection:
            lock = update(table).where(table.c.id == key).values(turns=table.c.turns)
            row = connection.execute(lock.returning(*table.c)).one_or_none()
            if row is None:
                raise PeopleError("no-occasion")
            if seen not in ("", _occasion(row, 0).plan.mark):
                raise PeopleError("occasion-changed")
            mine = (waits.c.occasion == key, waits.c.waiting == 1)
            party = connection.execute(select(func.max(waits.c.size)).where(*mine)).scalar_one() or 0
            kept = asdict(plan.checked(max(1, row.taken, party)))
            connection.execute(update(table).where(table.c.id == key).values(**kept))
            promote(connection, key)

    def call_off(self, who: str, key: str) -> None:
        """It does not take place; bookings stay, so that people can be told. Raises PeopleError."""
        table = tables.occasion
        with self._ledger.change(who, "events", f"{key} off") as connection:
            row = update(table).where(table.c.id == key, table.c.cancelled.is_(None)).values(cancelled=now())
            if not connection.execute(row).rowcount:
                raise PeopleError("no-occasion")


def _legible(text: str) -> bool:
    """In lines, without characters that calendars must not hold."""
    return all(letter.isprintable() or letter in "\n\r\t" for letter in text)


def _listed(kind: str, *, past: bool = False, off: bool = False) -> tuple[ColumnElement[bool], ...]:
    """What a list holds, as `to_come` tells it."""
    table = tables.occasion
    open_now = table.c.ends > now()
    open_now = open_now if off else open_now & table.c.cancelled.is_(None)
    return (~open_now if past else open_now, *((table.c.kind == kind,) if kind else ()))


def _waiting(connection: Connection) -> dict[str, int]:
    table = tables.booking
    query = select(table.c.occasion, func.sum(table.c.size)).where(table.c.waiting == 1)
    return {key: int(count) for key, count in connection.execute(query.group_by(table.c.occasion))}


def _occasion(row, waiting: int) -> Occasion:
    names = Plan.__dataclass_fields__
    written = {name: getattr(row, name) for name in names}
    written |= {"begins": in_utc(row.begins), "ends": in_utc(row.ends)}
    off = None if row.cancelled is None else in_utc(row.cancelled)
    return Occasion(row.id, Plan(**written), row.taken, waiting, off)
