"""Who reads answers needs a token, and what he was handed is written down."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime

from fastapi import Request

from survey.errors import AnswerError
from survey.questionnaire import Questionnaire
from survey.store import Store

__all__ = ["journal", "token_guard"]

_FILES = ("csv", "xlsx", "sav", "json")  # codebook and script hold no answers
_LISTS = ("rows", "suggestions")


def token_guard(store: Store) -> Callable[[Request], None]:
    """A dependency of the guarded routes: raises AnswerError 401 or 403. The token is the request's `state.token`."""

    def guard(request: Request) -> None:
        kind, _, secret = request.headers.get("authorization", "").partition(" ")
        if kind.lower() != "bearer":
            remedy = "send Authorization: Bearer TOKEN; `survey token` makes one"
            raise AnswerError("authorization", "no valid token", remedy, status=401)
        request.state.token = store.tokens.admit(secret.strip(), request.path_params["key"])

    return guard


def journal(store: Store) -> Callable[[Request, Questionnaire, str, int | None], None]:
    """Notes what is made and about to be handed out: (request, questionnaire, what, k). Raises StoreError.

    Not earlier, or the audit would tell of what was refused or failed. Every export has its entry; rows and suggestions
    may be asked for again and again by a program: the first time of a day, since the start, is enough.
    """
    told: set[tuple[object, ...]] = set()

    def note(request: Request, asked: Questionnaire, what: str, k: int | None) -> None:
        if what not in _FILES + _LISTS:
            return
        hidden = "" if k is None else f" k={k}"
        subject = f"{asked.id} version {asked.version} {what}{hidden}, token {request.state.token.id}"
        if what in _FILES:
            store.audit.note("export", subject)
            return
        today = datetime.now(UTC).date()
        if (today, subject) not in told:
            told.difference_update([entry for entry in list(told) if entry[0] != today])
            store.audit.note("read", subject)
            told.add((today, subject))

    return note
