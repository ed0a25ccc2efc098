"""All that the house knows of people, in one place to open and close."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from hall_app.house.people.database import PEOPLE_FILE, Ledger
from hall_app.house.people.records import (
    Accounts,
    AnswerCodes,
    Bookings,
    FollowUps,
    Journal,
    Keepsakes,
    Occasions,
    Person,
    Revisions,
    Roles,
    Sessions,
    own_copy,
)
from survey.errors import SurveyError
from survey.store.database import tables as survey_tables

__all__ = ["People", "existing_people"]


class People:
    """where: the data folder (Path), in which the file people.sqlite lies, or a database URL. Raises StoreError."""

    def __init__(self, where: Path | str) -> None:
        self._ledger = Ledger(where)
        self.accounts = Accounts(self._ledger)
        self.sessions = Sessions(self._ledger)
        self.roles = Roles(self._ledger)
        self.keepsakes = Keepsakes(self._ledger)
        self.answer_codes = AnswerCodes(self._ledger)
        self.occasions = Occasions(self._ledger)
        self.bookings = Bookings(self._ledger)
        self.followups = FollowUps(self._ledger)
        self.revisions = Revisions(self._ledger)
        self.journal = Journal(self._ledger)
        self.refuse = self._ledger.refuse
        self.copy_to = self._ledger.copy_to
        self.see_that_it_takes = self._ledger.see_that_it_takes
        self.take_copy = self._ledger.take_copy

    def note(self, who: str, act: str, subject: str) -> None:
        """Write down what was done elsewhere and took long, or is handed out now."""
        with self.noting(who, act, subject):
            pass

    @contextmanager
    def noting(self, who: str, act: str, subject: str) -> Iterator[None]:
        """Write down what the block does elsewhere: in files, in the survey's store. What fails in it leaves no row.

        Nothing else of people is changed meanwhile: it is for what is done at once.
        """
        with self._ledger.change(who, act, subject):
            yield

    def copy_of(self, person: Person, drafts: Sequence[Mapping[str, str]] = ()) -> bytes:
        """All that is kept of a person, as a ZIP; that it was taken is written down.

        drafts: of exhibits that name him, which lie in the data folder and not here.
        """
        with self._ledger.change(person.id, "take copy", person.id):
            pass
        kept, booked = self.keepsakes, self.bookings.of(person.id)
        return own_copy(
            person,
            {
                "sessions": self.sessions.of(person.id),
                "favourites": kept.favourites(person.id),
                "visits": kept.looks(person.id),
                "bookings": booked,
                "occasions": [self.occasions.of(one.occasion) for one in booked],
                "answers": self.answer_codes.of(person.id),
                "followups": [one for one in self.followups.all().values() if one.by == person.id],
                "revisions": self.revisions.by(person.id),
                "drafts": drafts,
                "journal": self.journal.about(person.id, booked),
            },
        )

    def close(self) -> None:
        self._ledger.close()


def existing_people(where: Path | str) -> People:
    """Raises SurveyError where none was made yet: a mistyped folder would look like a house without people."""
    file = where / PEOPLE_FILE if isinstance(where, Path) else survey_tables.sqlite_file(where)
    if file is not None and not file.is_file():
        raise SurveyError(f"{file}: no accounts there – give --data (or --accounts) as `hall serve` has it")
    return People(where)
