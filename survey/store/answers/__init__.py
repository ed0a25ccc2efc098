"""Reading answers: `rows` one by one as values, `columns` in bulk as arrays, from a `Store` or an `Archive`.

`columns` needs numpy, which a service that takes answers does not, so its names are handed out late (PEP 562).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from survey.store.answers.archive import Archive
from survey.store.answers.rows import WITHDRAWN, Given, Stored, given_answer, given_of, standing, stored_rows

if TYPE_CHECKING:
    from survey.store.answers.columns import (
        ABSENT,
        UNSCORED,
        Columns,
        Heads,
        read_columns,
        read_heads,
        read_texts,
    )

__all__ = [
    "ABSENT",
    "UNSCORED",
    "WITHDRAWN",
    "Archive",
    "Columns",
    "Given",
    "Heads",
    "Stored",
    "given_answer",
    "given_of",
    "read_columns",
    "read_heads",
    "read_texts",
    "standing",
    "stored_rows",
]

_LATE = {
    "ABSENT": "columns",
    "UNSCORED": "columns",
    "Columns": "columns",
    "Heads": "columns",
    "read_columns": "columns",
    "read_heads": "columns",
    "read_texts": "columns",
}


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
