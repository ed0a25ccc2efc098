"""A draft put in place: checked as `hall check` does, all its files or none, written down; and taken back."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from hall_app.content.files import remove_file, replace_file
from hall_app.content.problems import Problems
from hall_app.house.drafts.drafts import Drafts
from hall_app.house.drafts.examination import Examination
from hall_app.house.people import People, PeopleError

__all__ = ["Publication"]

_TOLD = 6  # problems that a refusal names


class Publication:
    """people: holds the history and the journal."""

    def __init__(self, drafts: Drafts, examination: Examination, people: People) -> None:
        self._drafts, self._examination, self._people = drafts, examination, people

    def publish(self, who: str, exhibit: str, seen: str | None = None) -> None:
        """Put the draft in place. seen: its mark when it was looked at; None: nobody looked.

        Raises PeopleError, with what the check finds, or where it is another draft by now; it stays then.
        """
        with self._drafts.lock:
            draft = self._drafts.see(exhibit, seen)
            for name in draft.files:
                self._drafts.place(exhibit, name)
            for name in self._drafts.stale(exhibit):
                raise PeopleError("changed", name=name)
            self._see(self._drafts.changes(exhibit))
            self._put(who, "publish", exhibit, {n: (draft.base[n], draft.files[n]) for n in draft.files})
            self._drafts.drop(exhibit)
            self.tidy()

    def undo(self, who: str, number: int) -> str:
        """Take one published change back, which is a change as well; its exhibit. Raises PeopleError."""
        with self._drafts.lock:
            revision = self._people.revisions.one(number)
            exhibit, now = revision.exhibit, self._drafts.published(revision.exhibit)
            for name, (_, after) in revision.files.items():
                self._drafts.place(exhibit, name)
                if now.get(name, "") != after:
                    raise PeopleError("undo-changed", name=name)
            back = {name: (after, before) for name, (before, after) in revision.files.items()}
            shelf = self._drafts.shelf
            self._see(
                {f"exhibits/{exhibit}/{n}": shelf.path(to) if to else None for n, (_, to) in back.items()}
            )
            self._put(who, "undo", exhibit, back)
        return exhibit

    def tidy(self) -> None:
        """Let go of files that neither a draft nor the history needs."""
        with self._drafts.lock:
            self._drafts.shelf.keep_only(self._drafts.digests() | self._people.revisions.digests())

    def _see(self, files: Mapping[str, bytes | Path | None]) -> None:
        found = self._examination.problems(files) or self._examination.reach(files, wait=True) or []
        if found:
            raise PeopleError("content-check", problems=Problems(tuple(found), _TOLD))

    def _put(self, who: str, act: str, exhibit: str, files: Mapping[str, tuple[str, str]]) -> None:
        """Where one file cannot be written, those before it are put back and nothing is written down."""
        home, shelf = self._drafts.home(exhibit), self._drafts.shelf
        old = {name: (home / name).read_bytes() if before else None for name, (before, _) in files.items()}
        new = {name: shelf.path(after).read_bytes() if after else None for name, (_, after) in files.items()}
        for data in old.values():
            if data is not None:
                shelf.put(data)
        with self._people.revisions.adding(who, act, exhibit, files):
            try:
                # The table last: a hall that looks meanwhile finds what it names.
                for name in sorted(new, key=lambda name: (name == "exhibit.toml", name)):
                    _write(home / name, new[name], home.parent)
            except OSError as error:
                for name, data in old.items():
                    with suppress(OSError):
                        _write(home / name, data, home.parent)
                raise PeopleError("content-write", why=error.strerror or str(error)) from error


def _write(path: Path, data: bytes | None, root: Path) -> None:
    """root: what stays, however empty."""
    if data is None:
        remove_file(path, root)
    else:
        replace_file(path, data)
