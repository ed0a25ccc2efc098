"""What became of a suggestion: open, answered or done, by whom. The suggestions themselves lie with the answers."""

from __future__ import annotations

from collections.abc import Callable, Set
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import delete, select

from hall_app.house.people.database import Ledger, tables
from hall_app.house.people.errors import PeopleError
from survey.store.database import in_utc, now

__all__ = ["FOLLOWED", "FollowUp", "FollowUps"]

FOLLOWED = ("open", "answered", "done")
LONGEST_NOTE, LONGEST_KEY = 400, 110


@dataclass(frozen=True)
class FollowUp:
    """id: of the suggestion; state: of FOLLOWED; by: the id of a person, "" for nobody yet; at: UTC."""

    id: str
    state: str
    note: str
    by: str
    at: datetime | None


class FollowUps:
    """Of all suggestions that somebody looked after."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def all(self) -> dict[str, FollowUp]:
        """By the suggestion's id."""
        with self._ledger.read() as connection:
            rows = connection.execute(select(tables.followup)).all()
        return {row.id: FollowUp(row.id, row.state, row.note, row.by, in_utc(row.at)) for row in rows}

    def set(self, who: str, key: str, state: str, note: str) -> None:
        """Raises PeopleError."""
        told, table = note.strip(), tables.followup
        if state not in FOLLOWED or len(told) > LONGEST_NOTE or len(key) > LONGEST_KEY:
            raise PeopleError("followup")
        with self._ledger.change(who, "answers", f"{key} {state}") as connection:
            connection.execute(delete(table).where(table.c.id == key))
            connection.execute(table.insert().values(id=key, state=state, note=told, by=who, at=now()))

    def forget(self, answer: str) -> None:
        """What was noted of suggestions whose answer was withdrawn: a note may repeat them. answer: its pseudonym."""
        table = tables.followup
        mine = table.c.id.startswith(f"{answer}.", autoescape=True)
        with self._ledger.read() as connection:
            if connection.execute(select(table.c.id).where(mine)).first() is None:
                return
        with self._ledger.keep() as connection:
            connection.execute(delete(table).where(mine))
        self._ledger.scrub()

    def forget_all(self, withdrawn: Callable[[], Set[str]]) -> None:
        """The same of all that is still noted. withdrawn: pseudonyms; asked only where there is anything to forget."""
        known = {key.partition(".")[0] for key in self.all()}
        for answer in known & withdrawn() if known else ():
            self.forget(answer)
