"""Noticing edits: compare the folder's file times and, after a change, load it again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from hall_app.content.files import snapshot
from hall_app.content.folder import Content
from hall_app.content.loading.hall import load
from hall_app.content.problems import Problem


class Watcher:
    """Keeps the last good content of a folder. No threads: the server calls `poll` once a second."""

    def __init__(self, folder: Path, content: Content | None = None) -> None:
        """Start watching `folder`. Raises ContentError if there is no good content to begin with."""
        self._folder = folder
        # The look at the files comes first: an edit while loading is then seen by the next poll.
        self._seen = snapshot(folder)
        self._content = content or load(folder)
        self._failed: object = None

    @property
    def content(self) -> Content:
        """The content to show now: the newest, with the last good version of what is faulty."""
        return self._content

    def poll(self) -> Content | None:
        """The content after an edit, or None if no file changed. Never raises for a bad edit."""
        now = snapshot(self._folder)
        if now == self._seen:
            return None
        try:
            self._content = load(self._folder, last_good=self._content)
        except Exception as error:
            if self._failed != now:
                self._failed = now
                return None  # a file went away while it was read: the next poll sees what became of it
            reason = " ".join(str(error).split()) or type(error).__name__
            problem = Problem(".", "", f"the folder cannot be read ({reason})", "undo the last change")
            self._content = replace(self._content, problems=(problem,))
        self._seen = now
        return self._content
