"""A draft put in place: checked as `hall check` does, all its files or none, written down; and taken back."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from hall_app.content.files import remove_file, replace_file
from hall_app.content.problems import Problem, Problems
from hall_app.house.drafts.drafts import Drafts
from hall_app.house.drafts.examination import UNWALKED, Examination
from hall_app.house.people import People, PeopleError

__all__ = ["Publication"]

_TOLD = 6  # problems that a refusal names
_Pairs = Mapping[str, tuple[str, str]]  # name -> digest of the file that is there, of what is to be; "": none


class Publication:
    """people: holds the history and the journal."""

    def __init__(self, drafts: Drafts, examination: Examination, people: People) -> None:
        self._drafts, self._examination, self._people = drafts, examination, people

    def publish(self, who: str, exhibit: str, seen: str | None = None) -> None:
        """Put the draft in place. seen: its mark when it was looked at; None: nobody looked, and it is as it is now.

        Raises PeopleError, with what the check finds, or where it is another draft by now; it stays then.
        """
        with self._drafts.lock:
            self._drafts.see(exhibit, seen)
            seen = self._drafts.mark(exhibit)

        def asked() -> _Pairs:
            draft = self._drafts.see(exhibit, seen)
            for name in draft.files:
                self._drafts.place(exhibit, name)
            for name in self._drafts.stale(exhibit):
                raise PeopleError("changed", name=name)
            return {name: (draft.base[name], draft.files[name]) for name in draft.files}

        with self._checked(exhibit, asked) as pairs:
            self._put(who, "publish", exhibit, pairs)
            self._drafts.drop(exhibit)
            self.tidy()

    def undo(self, who: str, number: int) -> str:
        """Take one published change back, which is a change as well; its exhibit. Raises PeopleError."""
        revision = self._people.revisions.one(number)
        exhibit = revision.exhibit

        def asked() -> _Pairs:
            now = self._drafts.published(exhibit)
            for name, (_, after) in revision.files.items():
                self._drafts.place(exhibit, name)
                if now.get(name, "") != after:
                    raise PeopleError("undo-changed", name=name)
            return {name: (after, before) for name, (before, after) in revision.files.items()}

        with self._checked(exhibit, asked) as pairs:
            self._put(who, "undo", exhibit, pairs)
        return exhibit

    def tidy(self) -> None:
        """Let go of files that neither a draft nor the history needs."""
        with self._drafts.lock:
            self._drafts.shelf.keep_only(self._drafts.digests() | self._people.revisions.digests())

    @contextmanager
    def _checked(self, exhibit: str, asked: Callable[[], _Pairs]) -> Iterator[_Pairs]:
        """What is `asked` for under the lock, which is held while the block runs: the check found nothing against it.

        A check takes seconds, in which others save their drafts: the lock is let go for it. Where anything in the hall
        is another afterwards, it is checked again. Raises PeopleError.
        """
        state: object = None
        found: list[Problem] = []
        while True:
            with self._drafts.lock:
                pairs, path = asked(), self._drafts.shelf.path
                files = {f"exhibits/{exhibit}/{n}": path(to) if to else None for n, (_, to) in pairs.items()}
                before, state = state, self._examination.state(files)
                if before == state:
                    if found:
                        raise PeopleError("content-check", problems=Problems(tuple(found), _TOLD))
                    yield pairs
                    return
            try:
                found = self._examination.problems(files) or self._examination.reach(files, wait=True) or []
            except (
                FileNotFoundError
            ):  # of the shelf: the draft was saved again or dropped, which `asked` tells
                found = [UNWALKED]

    def _put(self, who: str, act: str, exhibit: str, files: _Pairs) -> None:
        """Where one file cannot be written, those before it are put back and nothing is written down."""
        home, shelf = self._drafts.home(exhibit), self._drafts.shelf
        old = {name: (home / name).read_bytes() if (home / name).is_file() else None for name in files}
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
