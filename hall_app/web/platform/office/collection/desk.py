"""What the pages of the collection work with: drafts, their examination, publication; an exhibit.toml changed."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from html import escape
from typing import Any, NoReturn

from hall_app.content.files import TEXTS
from hall_app.content.problems import Problem
from hall_app.house.drafts import Drafts, Examination, Publication, Shelf
from hall_app.house.people import PeopleError
from hall_app.web.collection.table import Change, EditError, edited, read_toml_text
from hall_app.web.platform.counter import Asking, Counter, form

__all__ = ["TOML", "Desk", "listed_problems", "publish_form", "refusal"]

TOML = "exhibit.toml"


class Desk:
    """One for all pages: what is remembered of an examination serves the next."""

    def __init__(self, counter: Counter) -> None:
        self.house, self.people = counter.house, counter.people
        folder, data = self.house.content.folder, self.house.data
        self.drafts = Drafts(folder, data, Shelf(data / "shelf", self.house.quota))
        self.examination = Examination(folder)
        self.publication = Publication(self.drafts, self.examination, self.people)

    def key(self, asking: Asking) -> str:
        """The exhibit that is asked for. Raises PeopleError."""
        key = asking.names["key"]
        try:
            known = self.drafts.known(key)
        except PeopleError:
            known = False
        if not known:
            raise PeopleError("no-exhibit")
        return key

    def table(self, key: str) -> dict[str, Any]:
        """Its exhibit.toml as it is to be, empty where it cannot be read."""
        return _readable(self.drafts.text(key, TOML))

    def title(self, key: str, lang: str) -> str:
        found = self.table(key).get("title")
        text = found.get(lang) if isinstance(found, dict) else None
        return text if isinstance(text, str) and text.strip() else key

    def problems(self, key: str) -> list[Problem]:
        """What the draft would bring about and, without one, what the open hall says of the exhibit."""
        if self.drafts.of(key) is not None:
            return self.examination.problems(self.drafts.changes(key))
        return [one for one in self.house.own_problems if one.file.startswith(f"exhibits/{key}/")]

    def change(
        self,
        asking: Asking,
        key: str,
        changes: Iterable[Change],
        *,
        files: Mapping[str, bytes | None] | None = None,
        tag: str | None = None,
    ) -> None:
        """Write changes of exhibit.toml, and files beside it, into the draft. tag: that the form was made with.

        Raises PeopleError, where the hall's file was changed beneath the draft as well.
        """
        changes, brought = tuple(changes), dict(files or {})
        with self.drafts.lock:
            if TOML in self.drafts.stale(key):
                raise PeopleError("changed", name=TOML)
            if changes:
                try:
                    text = edited(self.drafts.text(key, TOML), changes)
                except (EditError, tomllib.TOMLDecodeError) as error:
                    why = f"{TOML}: {error} – change it in its editor below"
                    raise PeopleError("content-file", why=why) from error
                brought[TOML] = self.drafts.encoded(key, TOML, text)
            self._write(asking, key, brought, {} if tag is None else {TOML: tag})

    def write_text(self, asking: Asking, key: str, name: str, text: str, tag: str | None) -> None:
        """A whole text file into the draft. Raises PeopleError, also for an exhibit.toml that is no TOML."""
        data = self.drafts.encoded(key, name, text)
        if name == TOML:
            _table(data.decode("utf-8-sig"))
        self._write(asking, key, {name: data}, {} if tag is None else {name: tag})

    def _write(
        self, asking: Asking, key: str, files: Mapping[str, bytes | None], tags: Mapping[str, str]
    ) -> None:
        self._check_place(asking, key, files.get(TOML))
        try:
            # This lock before the journal's, as in publication.
            with self.drafts.lock, self.people.noting(asking.person.id, "draft", key):
                try:
                    self.drafts.set(asking.person.id, key, files, tags)
                except PeopleError as error:
                    if error.key != "quota":
                        raise
                    self.publication.tidy()  # what was replaced or taken out since makes room
                    self.drafts.set(asking.person.id, key, files, tags)
        except OSError as error:
            raise PeopleError("content-write", why=error.strerror or str(error)) from error

    def drop(self, asking: Asking, key: str, seen: str) -> None:
        """Forget the draft. seen: its mark as the page showed it.

        Raises PeopleError where it is another by now, and where it moves the exhibit and who drops it may not place it:
        a curator's placing would be undone.
        """
        with self.drafts.lock:
            self.drafts.see(key, seen)
            if self.moved(key) and not asking.person.may("place"):
                self._refuse_place(asking)
            with self.people.noting(asking.person.id, "draft", key):
                self.drafts.drop(key)
        self.publication.tidy()

    def moved(self, key: str) -> bool:
        """Whether its draft has it elsewhere than the hall or, where the hall has none, than where it began."""
        there = self.drafts.hall_text(key, TOML)
        before = self._hall(key).get("place") if there else self.first_place()
        return self.drafts.of(key) is not None and self.table(key).get("place") != before

    def _hall(self, key: str) -> dict[str, Any]:
        """Its exhibit.toml in the hall, empty where it cannot be read."""
        return _readable(self.drafts.hall_text(key, TOML))

    def first_place(self) -> dict[str, float]:
        """Where a new exhibit stands until it is placed."""
        start = self.house.content.hall.start
        return {"x": round(start.x + 1.5, 4), "z": round(start.z, 4), "facing": 0.0}

    def _refuse_place(self, asking: Asking) -> NoReturn:
        self.people.refuse(asking.person.id, "place", asking.path)
        raise PeopleError("not-allowed")

    def _check_place(self, asking: Asking, key: str, toml: bytes | None) -> None:
        """Raises PeopleError, and writes it down, where someone moves an exhibit who may not."""
        before = self.table(key) or self._hall(key)
        if toml is None or not before or asking.person.may("place"):
            return
        if _table(toml.decode("utf-8-sig")).get("place") != before.get("place"):
            self._refuse_place(asking)


def _table(text: str) -> dict[str, Any]:
    """An exhibit.toml. Raises PeopleError for what is no TOML, and for what nobody can read even so."""
    try:
        return read_toml_text(text)
    except tomllib.TOMLDecodeError as error:
        raise PeopleError("content-file", why=f"{TOML}: {error}") from None
    except EditError as error:
        why = f"{TOML}: {error} – shorten its numbers and lists"
        raise PeopleError("content-file", why=why) from None


def _readable(text: str) -> dict[str, Any]:
    """An exhibit.toml, empty where it cannot be read."""
    try:
        return _table(text)
    except PeopleError:
        return {}


def listed_problems(asking: Asking, found: Iterable[Problem]) -> str:
    """Under a heading of their own; "" for none."""
    lines = "".join(f"<li>{escape(one.text(asking.lang))}</li>" for one in found)
    title = asking.word("展厅检查指出", "The hall's check says")
    return f'<div class="faults"><p><b>{title}</b></p><ul>{lines}</ul></div>' if lines else ""


def refusal(asking: Asking, *forms: str) -> str:
    """The refusal, where it stands beside none of these forms."""
    beside = asking.form.get("of", "") in forms
    return (
        f'<p class="refused" role="alert">{escape(asking.refusal)}</p>'
        if asking.refusal and not beside
        else ""
    )


def publish_form(desk: Desk, asking: Asking, key: str) -> str:
    """It publishes the draft that the page shows, and no later one."""
    words, hidden = asking.word("发布", "Publish"), {"seen": desk.drafts.mark(key)}
    way = f"/office/collection/{key}/publish"
    return form(asking, "publish", way, (), words, hidden=hidden, style="small-act")


def language_of(name: str) -> str:
    """Of a text file, "" for another."""
    return next((language for language, file in TEXTS.items() if file == name), "")
