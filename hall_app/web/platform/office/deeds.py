"""What the office reads and does: values, so that the page and the API are two doors to one room."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from hall_app.web.platform.counter import PLAIN, Asking, Takes, View

__all__ = ["Deed", "Reading", "number_in"]


@dataclass(frozen=True)
class Reading:
    """Read at /office/PATH and /api/office/PATH. act: of the table of roles; of: as JSON; page: as HTML.

    query: what may be asked, for who writes a program.
    """

    path: str
    act: str
    of: Callable[[Asking], Any]
    page: View
    query: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Deed:
    """Something to do, by POST. do: takes the fields of a form, gives JSON of what came of it; back: path of the page
    that shows it, with the names of `path`; page: shown again where it is refused; shows: shown in place of `back`;
    takes: how large its form may be; fields: their names and what they are, for who writes a program.
    """

    path: str
    act: str
    do: Callable[[Asking], dict[str, Any]]
    back: str
    page: View
    shows: Callable[[Asking, dict[str, Any]], Any] | None = None
    takes: Takes = PLAIN
    fields: Mapping[str, str] = field(default_factory=dict)


def number_in(text: str) -> int:
    """A whole number as typed, -1 for anything else: no row has it, no limit admits it."""
    return int(text) if text.isascii() and text.isdigit() and len(text) < 10 else -1
