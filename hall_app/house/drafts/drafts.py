"""Drafts: what is to become of an exhibit's files, kept in the data folder until it is published or dropped.

A file is known by its tag: digests of what the draft and what the hall have. A form brings back the tag it was made
with, so that nobody writes over what he has not seen.
"""

from __future__ import annotations

import hashlib
import json
import re
import threading
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from hall_app.check import Changed
from hall_app.content.files import BAKED, TEXTS, is_there, replace_file, walk_files, whole_digest
from hall_app.content.loading import RESERVED
from hall_app.house.drafts.shelf import Shelf
from hall_app.house.people import PeopleError
from survey.store.database import now

__all__ = ["LONGEST_ID", "TEXT_FILES", "Draft", "Drafts"]

TOML = "exhibit.toml"
TEXT_FILES = (TOML, *TEXTS.values())
LONGEST_ID, LONGEST_TEXT = 60, 200_000
_MARK = b"\xef\xbb\xbf"  # Notepad's
_ID = re.compile(f"[a-z0-9][a-z0-9-]{{0,{LONGEST_ID - 1}}}")
_NAME = re.compile(r"(?:media|scan)/[a-z0-9][a-z0-9._-]{0,80}")


@dataclass(frozen=True)
class Draft:
    """base, files: name -> digest of the hall's file when it was changed, and of the draft's; "" for no file.

    by: the id of who changed it last; at: when, UTC.
    """

    exhibit: str
    base: Mapping[str, str] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)
    by: str = ""
    at: str = ""


class Drafts:
    """content: the hall's folder; data: its data folder."""

    def __init__(self, content: Path, data: Path, shelf: Shelf) -> None:
        self.content, self.shelf = content.resolve(), shelf
        self._folder = data / "drafts"
        self.lock = threading.RLock()  # of all that changes drafts or the content folder from here

    def home(self, exhibit: str) -> Path:
        """The exhibit's folder in the hall. Raises PeopleError for what cannot be a name."""
        if not _ID.fullmatch(exhibit) or exhibit in RESERVED:
            raise PeopleError("exhibit-id", most=LONGEST_ID)
        return self.content / "exhibits" / exhibit

    def all(self) -> dict[str, Draft]:
        """By exhibit."""
        if not self._folder.is_dir():
            return {}
        found = (
            self.of(path.stem) for path in sorted(self._folder.glob("*.json")) if _ID.fullmatch(path.stem)
        )
        return {draft.exhibit: draft for draft in found if draft is not None}

    def of(self, exhibit: str) -> Draft | None:
        path = self._folder / f"{self.home(exhibit).name}.json"
        return Draft(**json.loads(path.read_text("utf-8"))) if path.is_file() else None

    def known(self, exhibit: str) -> bool:
        """Whether the hall or a draft has it."""
        home = self.home(exhibit)
        return home.is_dir() or self.of(exhibit) is not None

    def published(self, exhibit: str) -> dict[str, str]:
        """Name -> digest of the exhibit's files in the hall, those that were baked aside."""
        home = self.home(exhibit)
        if not home.is_dir():
            return {}
        names = {path.relative_to(home).as_posix(): path for path in walk_files(home)}
        return {name: whole_digest(path) for name, path in names.items() if not name.startswith(BAKED)}

    def files(self, exhibit: str) -> dict[str, str]:
        """Name -> digest of the exhibit's files as they are to be."""
        draft = self.of(exhibit)
        whole = self.published(exhibit) | dict(draft.files if draft else {})
        return {name: digest for name, digest in whole.items() if digest}

    def path(self, exhibit: str, name: str) -> Path:
        """Where the file lies as it is to be, those that were baked included. Raises PeopleError."""
        draft = self.of(exhibit)
        if draft is not None and name in draft.files:
            if not draft.files[name]:
                raise PeopleError("no-file")
            return self.shelf.path(draft.files[name])
        path = self.place(exhibit, name)
        if not is_there(path):
            raise PeopleError("no-file")
        return path

    def place(self, exhibit: str, name: str) -> Path:
        """Where the hall's file of that name lies or is to lie. Raises PeopleError for one that leads out of its
        folder: drafts and history may come from elsewhere, with a backup that somebody made up."""
        home = self.home(exhibit)
        path = home / name
        if not path.resolve().is_relative_to(home.resolve()):
            raise PeopleError("no-file")
        return path

    def text(self, exhibit: str, name: str) -> str:
        """A text file as it is to be; "" for one that is not there yet, or no longer."""
        return self._bytes(exhibit, name).decode("utf-8-sig", "replace")

    def hall_text(self, exhibit: str, name: str) -> str:
        """A text file as the hall has it, "" for none."""
        path = self.home(exhibit) / name
        return _read(path) if is_there(path) else ""

    def encoded(self, exhibit: str, name: str, text: str) -> bytes:
        """A text as the file is to hold it: lines end as they did there, a mark at its beginning stays."""
        was = self._bytes(exhibit, name)
        plain = text.replace("\r\n", "\n").replace("\r", "\n")
        if was and was.count(b"\n") == was.count(b"\r\n") > 0:
            plain = plain.replace("\n", "\r\n")
        return (_MARK if was.startswith(_MARK) else b"") + plain.encode("utf-8", "replace")

    def tag(self, exhibit: str, name: str) -> str:
        """What a form brings back that changes the file."""
        draft, published = self.of(exhibit), self._digest(exhibit, name)
        mine = draft.files.get(name, published) if draft else published
        return f"{mine[:16] or 'none'}-{published[:16] or 'none'}"

    def mark(self, exhibit: str) -> str:
        """What a page brings back that showed the whole draft, "" for none."""
        draft = self.of(exhibit)
        told = json.dumps(dict(draft.files), sort_keys=True) if draft else ""
        return hashlib.sha256(told.encode()).hexdigest()[:16] if told else ""

    def stale(self, exhibit: str) -> tuple[str, ...]:
        """Files of the draft that were changed in the hall since, but those that are there as the draft has them: what
        was killed while it published leaves such, and publishing again completes it."""
        draft = self.of(exhibit)
        if draft is None:
            return ()
        return tuple(
            name
            for name, base in draft.base.items()
            if self._digest(exhibit, name) not in (base, draft.files[name])
        )

    def set(
        self, who: str, exhibit: str, changed: Mapping[str, bytes | None], tags: Mapping[str, str]
    ) -> None:
        """Change files in the draft; None: the file goes. tags: of those that a form showed.

        Raises PeopleError where one is another by now, where there is no room, or for a name that no file may have.
        """
        with self.lock:
            for name, tag in tags.items():
                if tag != self.tag(exhibit, name):
                    raise PeopleError("changed", name=name)
            draft = self.of(exhibit) or Draft(exhibit)
            base, files = dict(draft.base), dict(draft.files)
            for name, data in changed.items():
                if name not in TEXT_FILES and not _NAME.fullmatch(name) and data is not None:
                    raise PeopleError("no-file")
                if name in TEXT_FILES and data is not None and len(data) > LONGEST_TEXT:
                    raise PeopleError("text-size", most=LONGEST_TEXT)
                files[name] = "" if data is None else self.shelf.put(data)
                base[name] = self._digest(exhibit, name)
            same = [name for name, digest in files.items() if digest == base[name]]
            for name in same:
                del files[name], base[name]
            self._write(replace(draft, base=base, files=files, by=who, at=now().isoformat()))

    def see(self, exhibit: str, seen: str | None) -> Draft:
        """The draft. seen: its mark when it was looked at; None: nobody looked. Raises PeopleError where there is none,
        or another by now."""
        draft = self.of(exhibit)
        if draft is None:
            raise PeopleError("no-draft")
        if seen not in (None, self.mark(exhibit)):
            raise PeopleError("draft-changed")
        return draft

    def drop(self, exhibit: str) -> None:
        """Forget the draft. Raises PeopleError."""
        with self.lock:
            self.see(exhibit, None)
            (self._folder / f"{exhibit}.json").unlink()

    def changes(self, exhibit: str) -> Changed:
        """The draft's files as they would lie in the content folder; one that the shelf has lost is none."""
        draft = self.of(exhibit)
        if draft is None:
            return {}
        return {
            f"exhibits/{exhibit}/{name}": self.shelf.path(digest) if self.shelf.has(digest) else None
            for name, digest in draft.files.items()
        }

    def digests(self) -> frozenset[str]:
        """Of all files that drafts need, what they change among them: a kill while publishing leaves it here alone."""
        return frozenset(
            digest
            for draft in self.all().values()
            for pairs in (draft.base, draft.files)
            for digest in pairs.values()
        )

    def _digest(self, exhibit: str, name: str) -> str:
        path = self.home(exhibit) / name
        return whole_digest(path) if is_there(path) else ""

    def _bytes(self, exhibit: str, name: str) -> bytes:
        """Of a file as it is to be, none where there is no such file."""
        try:
            return self.path(exhibit, name).read_bytes()
        except PeopleError:
            return b""

    def _write(self, draft: Draft) -> None:
        path = self._folder / f"{draft.exhibit}.json"
        if draft.files:
            replace_file(path, json.dumps(asdict(draft), ensure_ascii=False, indent=1).encode())
        else:
            path.unlink(missing_ok=True)


def _read(path: Path) -> str:
    return path.read_bytes().decode("utf-8-sig", "replace")
