"""Who somebody is, as the store knows it; addresses and names as they are kept."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, Connection, Row, func, select, true

from hall_app.house.people.acts import Role, may
from hall_app.house.people.database import tables
from hall_app.house.people.errors import PeopleError
from survey.store.database import in_utc

__all__ = [
    "Person",
    "checked_address",
    "checked_name",
    "everybody",
    "found_by",
    "how_many",
    "is_as_it_was",
    "see_that_one_is_left",
    "stays",
]

_ADDRESS = re.compile(r"[^@\s]{1,64}@[^@\s.]+(\.[^@\s.]+)+")
_LONGEST = 254  # of an address: RFC 5321
_NAME = 80


@dataclass(frozen=True)
class Person:
    """id: random, names the person in the journal. Times are in UTC."""

    id: str
    address: str
    name: str
    language: str
    made: datetime
    verified: datetime | None
    closed: datetime | None
    second_factor: bool
    has_password: bool
    keeps_looks: bool
    roles: frozenset[Role]

    def may(self, act: str) -> bool:
        return may(self.roles, act)


def checked_address(text: str) -> str:
    """The address as it is compared and kept. Raises PeopleError."""
    told = _folded(text).strip()
    if len(told) > _LONGEST or not _ADDRESS.fullmatch(told) or not told.isprintable():
        raise PeopleError("address")
    return told


def checked_name(text: str) -> dict[str, str]:
    """The columns of a name: as it is shown, and as it is searched. Raises PeopleError."""
    told = unicodedata.normalize("NFC", text).strip()
    if len(told) > _NAME or not all(letter.isprintable() for letter in told):
        raise PeopleError("name", most=_NAME)
    return {"name": told, "name_folded": _folded(told)}


def _folded(text: str) -> str:
    """Alike for all ways to write the same letters, big or small. Databases have no such thing in common."""
    return unicodedata.normalize("NFKC", text).casefold()


def found_by(connection: Connection, **key: str) -> Person | None:
    """The person of that id or address."""
    table, ((column, value),) = tables.user, key.items()
    row = connection.execute(select(table).where(table.c[column] == value)).one_or_none()
    if row is None:
        return None
    roles = connection.execute(select(tables.role.c.role).where(tables.role.c.user == row.id)).scalars()
    return _person(row, frozenset(Role(role) for role in roles))


def is_as_it_was(connection: Connection, checked: Row) -> bool:
    """Whether password, second factor and closing are still those of `checked`, the account's row as it was read.

    A password takes long to look at, and may be changed meanwhile. The row is nobody else's until the commit.
    """
    table = tables.user
    mine = select(table).where(table.c.id == checked.id).with_for_update()
    now = connection.execute(mine).one_or_none()
    seen = (checked.password, checked.authenticator, checked.closed)
    return now is not None and (now.password, now.authenticator, now.closed) == seen


def stays(connection: Connection, person: str, *, alone: bool = False) -> bool:
    """Whether the account is there: it is not deleted before the commit, or changed by nobody else (`alone`).

    Asked before anything else is locked, by who books as by who deletes: so no two of them wait for each other.
    """
    user = tables.user
    mine = select(user.c.id).where(user.c.id == person)
    held = mine.with_for_update() if alone else mine.with_for_update(read=True, key_share=True)
    return connection.execute(held).one_or_none() is not None


def everybody(connection: Connection, wanted: str, most: int) -> tuple[Person, ...]:
    """People whose address or name holds `wanted`, those with roles first, then by address; `most` at most."""
    user, role = tables.user, tables.role
    ranks = select(role.c.user, func.count().label("count")).group_by(role.c.user).subquery()
    query = select(user).outerjoin(ranks, ranks.c.user == user.c.id).where(_holds(wanted))
    order = (func.coalesce(ranks.c.count, 0) == 0, user.c.address)
    rows = connection.execute(query.order_by(*order).limit(most)).all()
    given: dict[str, set[Role]] = {}
    ids = [row.id for row in rows]
    for whose, name in connection.execute(select(role.c.user, role.c.role).where(role.c.user.in_(ids))):
        given.setdefault(whose, set()).add(Role(name))
    return tuple(_person(row, frozenset(given.get(row.id, ()))) for row in rows)


def how_many(connection: Connection, wanted: str) -> int:
    """People whose address or name holds `wanted`."""
    query = select(func.count()).select_from(tables.user).where(_holds(wanted))
    return connection.execute(query).scalar_one()


def _holds(wanted: str) -> ColumnElement[bool]:
    user, part = tables.user, _folded(wanted)
    if not part:
        return true()
    address, name = (
        column.contains(part, autoescape=True) for column in (user.c.address, user.c.name_folded)
    )
    return address | name


def see_that_one_is_left(connection: Connection) -> None:
    """Raises PeopleError where no open account would be an administrator any more; the change is undone then."""
    user, role = tables.user, tables.role
    query = (
        select(func.count())
        .select_from(role.join(user, user.c.id == role.c.user))
        .where(role.c.role == Role.ADMINISTRATOR, user.c.closed.is_(None))
    )
    if not connection.execute(query).scalar_one():
        raise PeopleError("last-administrator")


def _person(row, roles: frozenset[Role]) -> Person:
    return Person(
        id=row.id,
        address=row.address,
        name=row.name,
        language=row.language,
        made=in_utc(row.made),
        verified=None if row.verified is None else in_utc(row.verified),
        closed=None if row.closed is None else in_utc(row.closed),
        second_factor=row.authenticator is not None,
        has_password=row.password is not None,
        keeps_looks=bool(row.keeps_looks),
        roles=roles,
    )
