"""What a page with forms is asked, and what it may answer: values, so that pages are functions of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO
from urllib.parse import quote, urlencode

from hall_app.house.people import Person, Session

__all__ = ["Asking", "Brought", "Download", "Guest", "Moved", "Page", "Shown", "own_path"]


@dataclass(frozen=True)
class Guest:
    """Who is signed in, and by which session and token."""

    person: Person
    session: Session
    token: str


@dataclass(frozen=True)
class Brought:
    """A file that came with a form. name: as it was called, not to be believed; size: [bytes]."""

    field: str
    name: str
    file: BinaryIO
    size: int


@dataclass(frozen=True)
class Asking:
    """One request. path: as asked for; names: parts of the path; query, form: first values of what was given.

    lang: "zh" or "en"; seal: what a form of this browser has to bring back; network: whom the request counts for;
    mark: by which the browser is known at an account that let it in, "" for none;
    refusal: what was wrong with the form that is shown again, "" for none; site: scheme and host as the browser has it.
    """

    path: str
    lang: str
    seal: str
    network: str
    site: str
    names: Mapping[str, str] = field(default_factory=dict)
    query: Mapping[str, str] = field(default_factory=dict)
    form: Mapping[str, str] = field(default_factory=dict)
    files: tuple[Brought, ...] = ()
    guest: Guest | None = None
    refusal: str = ""
    mark: str = ""

    @property
    def person(self) -> Person:
        """Of pages that none but who is signed in are asked for."""
        assert self.guest is not None
        return self.guest.person

    @property
    def afterwards(self) -> str:
        """Where the visitor was on his way to, a path of this hall; "" for nowhere."""
        return own_path(self.form.get("next", self.query.get("next", "")))

    def word(self, zh: str, en: str) -> str:
        return zh if self.lang == "zh" else en

    def address(self, path: str, **query: str) -> str:
        """A path of the hall in this language; what is empty is left out."""
        given = {"lang": self.lang} | {name: value for name, value in query.items() if value}
        way, _, anchor = path.partition("#")
        return f"{way}?{urlencode(given)}" + (f"#{quote(anchor)}" if anchor else "")


@dataclass(frozen=True)
class Page:
    """A page of the frame. main: its HTML; here: key of the navigation; query: of its address; script: of /static."""

    title: str
    main: str
    here: str = ""
    query: Mapping[str, str] = field(default_factory=dict)
    script: str = ""


@dataclass(frozen=True)
class Shown:
    """200 (or `status`) with a page. path: address of the page in the other language, where it is not the one asked."""

    page: Page
    status: int = 200
    path: str = ""


@dataclass(frozen=True)
class Moved:
    """303 to another page of the hall. token: of a session that begins with it; None: none begins, "": it ends.

    mark: for the browser to keep, by which the account knows it again; "": it keeps what it has.
    """

    to: str
    token: str | None = None
    mark: str = ""


@dataclass(frozen=True)
class Download:
    """A file to keep; inline: one that a page shows, which runs nothing."""

    data: bytes | Path
    name: str
    kind: str
    inline: bool = False


def own_path(text: str) -> str:
    """A path of this hall, "" for any other address: nobody is led elsewhere by signing in."""
    plain = text.startswith("/") and not text.startswith(("//", "/\\")) and text.isprintable()
    return text if plain and len(text) < 500 and "\\" not in text else ""
