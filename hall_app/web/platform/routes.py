"""The platform put into the hall's application."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING

from fastapi import FastAPI, Request

from hall_app.house.house import House
from hall_app.house.people import People
from hall_app.web.answers.head import is_head
from hall_app.web.answers.work import SLOW
from hall_app.web.platform.counter import OFFICE, VISITOR, Counter, Pace
from hall_app.web.platform.me import add_me
from hall_app.web.platform.office import add_office
from hall_app.web.platform.programme import add_programme
from survey.errors import StoreError

if TYPE_CHECKING:
    from survey import Mounted

__all__ = ["NoteLook", "add_platform", "follow_withdrawals"]

NoteLook = Callable[[Request, str], None]  # an exhibit was looked at


def add_platform(app: FastAPI, house: House, people: People) -> NoteLook:
    """Add /me, /activities, /visit, /office. The caller closes `people` when the application has ended."""
    pace = Pace()
    visitors = Counter(app, house, people, VISITOR, pace)
    add_me(visitors)
    add_programme(visitors)
    add_office(app, Counter(app, house, people, OFFICE, pace))

    def note(request: Request, exhibit: str) -> None:
        """Beside the answer: nobody waits for it, and where it fails a visit is not kept."""
        if request.cookies.get(VISITOR.name) and not is_head(request):
            SLOW.begin(("look", request.cookies[VISITOR.name], exhibit), lambda: _note(request, exhibit))

    def _note(request: Request, exhibit: str) -> None:
        guest = visitors.guest(request)
        if guest is not None and guest.person.keeps_looks:
            people.keepsakes.note_look(guest.person.id, exhibit)

    return note


def follow_withdrawals(survey: Mounted, people: People) -> None:
    """With an answer goes what the office noted of its suggestions; what is left of one goes now."""

    def withdrawn(answer: str) -> None:
        with suppress(StoreError):  # it is withdrawn all the same, and the next who looks forgets the note
            people.followups.forget(answer)

    survey.when_withdrawn(withdrawn)
    with suppress(StoreError):
        people.followups.forget_all(survey.withdrawn)
