"""What the hall's own check says of a draft: at once for its files, beside the server for the ways through the hall."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from hall_app.check import EDITED, STANDING, Changed, check, likeness_of
from hall_app.content.files import revision, whole_digest
from hall_app.content.floor.footprints import solids_of
from hall_app.content.loading import load
from hall_app.content.problems import ContentError, Problem
from hall_app.house.beside import beside

__all__ = ["UNWALKED", "Examination"]

_KEPT = 24  # findings that are remembered
UNWALKED = Problem(
    "plan.toml", "", "the ways through the hall could not be walked", "try again, or run hall check"
)


class Examination:
    """content: the hall's folder. For threads beside the event loop."""

    def __init__(self, content: Path) -> None:
        self._content = content
        self._found: dict[tuple[object, ...], list[Problem]] = {}
        self._walks: dict[tuple[object, ...], _Walk] = {}
        self._lock = threading.Lock()

    def now(self) -> list[Problem]:
        """What is wrong with the hall's own files."""
        return self._quick({})

    def problems(self, files: Changed) -> list[Problem]:
        """What these files would bring about, the ways through the hall aside. A second at most."""
        known = set(self.now())
        return [problem for problem in self._quick(files) if problem not in known]

    def reach(self, files: Changed, *, wait: bool) -> list[Problem] | None:
        """Exhibits that nobody could come to any more; None while that is being found out. wait: until it is.

        A walk that came to nothing is told as a problem, and begun anew when it is asked for again.
        """
        with self._lock:
            key = ("reach", *self.state(files))
            walk = self._walks.get(key)
            if walk is None:
                self._forget(self._walks)
                walk = self._walks[key] = _Walk(self._content, files)
        found = walk.found(wait=wait)
        if found == [UNWALKED]:
            with self._lock:
                self._walks.pop(key, None)
        return found

    def _quick(self, files: Changed) -> list[Problem]:
        key = self.state(files)
        if key not in self._found:
            if files:
                with likeness_of(self._content, files) as whole:
                    found = check(whole, EDITED)
            else:
                found = check(self._content, EDITED)
            with self._lock:
                self._forget(self._found)
                self._found[key] = found
        return self._found[key]

    def state(self, files: Changed) -> tuple[object, ...]:
        """A name for these files in the hall as it is now: what was found of them holds while it is the same."""
        told = ((name, _digest(data)) for name, data in sorted(files.items()))
        return (revision(self._content), *told)

    @staticmethod
    def _forget(kept: dict[tuple[object, ...], Any]) -> None:
        while len(kept) >= _KEPT:
            kept.pop(next(iter(kept)))


class _Walk:
    """One walk through a hall as it would be, in a process of its own that ends with the server."""

    def __init__(self, content: Path, files: Changed) -> None:
        self._problems = [UNWALKED]
        self._thread = threading.Thread(target=self._walk, args=(content, dict(files)), daemon=True)
        self._thread.start()

    def found(self, *, wait: bool) -> list[Problem] | None:
        if wait:
            self._thread.join()
        return None if self._thread.is_alive() else self._problems

    def _walk(self, content: Path, files: dict[str, Any]) -> None:
        with suppress(OSError):  # the draft was dropped or saved again meanwhile, and its files are gone
            found = [] if _same_floor(content, files) else beside(_reached, content, files)
            if found is not None:
                self._problems = found


def _reached(content: Path, files: Mapping[str, Any]) -> list[Problem] | None:
    """What a walk finds that one through the hall as it is does not; None where the draft is gone meanwhile."""
    try:
        with likeness_of(content, files) as whole:
            found = check(whole, STANDING)
    except FileNotFoundError:
        return None
    if found:
        known = set(check(content, STANDING))
        found = [problem for problem in found if problem not in known]
    return found


def _same_floor(content: Path, files: Changed) -> bool:
    """Whether everything stands where it stood, looking the same way; not for a folder that is no hall."""
    if not any(name.endswith(".toml") for name in files):
        return True
    try:
        with likeness_of(content, files) as whole:
            before, after = load(content), load(whole)
    except ContentError:
        return False
    places = [[(one.id, one.file.place.facing) for one in each.exhibits] for each in (before, after)]
    solids = [solids_of(each.plan, each.exhibits) for each in (before, after)]
    return places[0] == places[1] and solids[0] == solids[1]


def _digest(data: bytes | Path | None) -> object:
    return whole_digest(data) if isinstance(data, Path) else data
