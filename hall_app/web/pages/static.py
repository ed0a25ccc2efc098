"""The page's own files, kept in memory and read again when one has changed."""

from __future__ import annotations

import logging
import re
import time
import tomllib
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from hall_app.web.answers.packed import Packed
from hall_app.web.pages.modules import one_module

__all__ = ["PAGE_FOLDER", "PageFiles", "page_files"]

PAGE_FOLDER = Path(__file__).parents[2] / "page"
LOOK_EVERY = 1.0  # [s] between two looks at the files

SCRIPT, AHEAD, REST = "hall.packed.js", "hall.ahead.js", "hall.rest.css"  # made here, not files
_TYPES = {".js": "text/javascript; charset=utf-8", ".css": "text/css; charset=utf-8"}
_TAKEN_IN = re.compile(r'^@import url\("([^"]+)"\);\n', re.MULTILINE)
_AHEAD = ("viser/first.js", "viser/line.js")  # what must have run when viser's script begins
_NEEDED = ("door.html", "door.js", "texts.toml")  # what the door is made of
_FIRST = ("ui/enter/enter.css",)  # what the door is painted with, beside hall.css itself


class PageFiles:
    """Sources, and what is put together from them. `stamp` names this version in addresses.

    Raises KeyError or ValueError where a file is missing or cannot be read as what it is.
    """

    def __init__(self, sources: dict[str, str]) -> None:
        if missing := [name for name in _NEEDED if name not in sources]:
            raise KeyError(missing[0])
        self.sources = sources
        self.texts: dict[str, Any] = tomllib.loads(
            sources["texts.toml"]
        )  # {"zh": {group: {key: text}}, "en": …}
        taken_in = _TAKEN_IN.findall(sources["hall.css"])
        later = [name for name in taken_in if name not in _FIRST]
        own = _TAKEN_IN.sub("", sources["hall.css"])
        self.first_style = "".join(sources[name] for name in taken_in if name in _FIRST) + own
        total = sha256("".join(f"{name}\0{text}\0" for name, text in sorted(sources.items())).encode())
        self.stamp = total.hexdigest()[:10]
        files = {name: text for name, text in sources.items() if Path(name).suffix in _TYPES}
        files[SCRIPT] = one_module(sources.__getitem__, "hall.js")
        files[AHEAD] = "".join(sources[name] for name in _AHEAD)
        files[REST] = "".join(sources[name] for name in later)
        self._packed = {
            name: Packed(text.encode(), _TYPES[Path(name).suffix]) for name, text in files.items()
        }

    def find(self, path: str) -> tuple[Packed, bool] | None:
        """The file at `path`, with or without a stamp ahead of it, and whether that address names this version."""
        stamp, _, name = path.partition("/")
        if stamp == self.stamp and name in self._packed:
            return self._packed[name], True
        for known in (path, name):  # a page of an older version gets what there is now
            if known in self._packed:
                return self._packed[known], False
        return None


def page_files() -> PageFiles:
    """The files as they are now: whoever edits them sees it on reloading the page."""
    return _looked_up(int(time.monotonic() / LOOK_EVERY))


@lru_cache(maxsize=1)
def _looked_up(moment: int) -> PageFiles:
    return _watched.now()


class PageFolder:
    """The folder's files; while a program update has written half of them, the last version that was whole."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._seen: tuple[tuple[Path, int], ...] = ()
        self._good: PageFiles | None = None

    def now(self) -> PageFiles:
        """Raises what is wrong with them if they have never been whole."""
        try:
            found = sorted(p for p in self._folder.rglob("*") if p.suffix in (*_TYPES, ".html", ".toml"))
            seen = tuple((path, path.stat().st_mtime_ns) for path in found)
            if self._good is None or seen != self._seen:
                self._seen = seen  # also when they are faulty: said once
                self._good = PageFiles(
                    {path.relative_to(self._folder).as_posix(): path.read_text("utf-8") for path, _ in seen}
                )
        except (OSError, KeyError, ValueError) as error:
            if self._good is None:
                raise
            _log.warning("the page's files are not whole, the last version stays: %s", error)
        return self._good


_log = logging.getLogger(__name__)
_watched = PageFolder(PAGE_FOLDER)
