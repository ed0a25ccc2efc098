"""Roles, given and taken. The house always keeps an administrator."""

from __future__ import annotations

from sqlalchemy import delete
from sqlalchemy.exc import IntegrityError

from hall_app.house.people.acts import Role
from hall_app.house.people.database import CONSOLE, Ledger, tables
from hall_app.house.people.errors import PeopleError
from hall_app.house.people.records.person import found_by, see_that_one_is_left
from survey.store.database import now

__all__ = ["Roles"]


class Roles:
    """Who is what."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def set(self, who: str, person: str, roles: frozenset[Role]) -> None:
        """Give a person these roles and no others. Raises PeopleError.

        Anybody may have made an account of anybody's address: none that is not verified is given a role by the office.
        """
        told, table = " ".join(sorted(roles)) or "none", tables.role
        try:
            with self._ledger.change(who, "roles", f"{person} {told}") as connection:
                found = found_by(connection, id=person)
                if found is None:
                    raise PeopleError("no-account")
                for gone in found.roles - roles:
                    connection.execute(delete(table).where(table.c.user == person, table.c.role == gone))
                for new in roles - found.roles:
                    connection.execute(table.insert().values(user=person, role=new, given=now()))
                if Role.ADMINISTRATOR in found.roles - roles:
                    see_that_one_is_left(connection)
                foreign = found.has_password and found.verified is None
                if foreign and roles - found.roles and who != CONSOLE:
                    raise PeopleError("not-verified")
        except IntegrityError:
            raise PeopleError("no-account") from None  # deleted just now
