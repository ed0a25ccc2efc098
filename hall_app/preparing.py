"""Baking from the server's side: what needs it, and a child process that does it."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import threading
from pathlib import Path
from types import TracebackType

from .bake.places import bake_folder
from .content.loading import Content, Exhibit

__all__ = ["Preparation", "stale_garments"]


def stale_garments(content: Content, data: Path) -> tuple[Exhibit, ...]:
    """Exhibits whose garment has no bake of its present pattern, weave and recipe."""
    return tuple(
        exhibit
        for exhibit in content.exhibits
        if exhibit.file.garment is not None and bake_folder(content, exhibit, data, stale=False) is None
    )


class Preparation:
    """One `hall build` in a process of its own; ends with the block that holds it."""

    def __init__(self, content: Path, data: Path, *what: str) -> None:
        """what: options of `hall build`, such as "--exhibit", "pibo" or "--room"."""
        command = [sys.executable, "-m", "hall_app", "build", "--content", str(content), "--data", str(data)]
        self._process = subprocess.Popen(
            [*command, *what, "--into-data", "--json"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            start_new_session=True,  # Ctrl-C reaches us alone; we end the child ourselves
        )
        self._line = "starting …"
        self._errors: list[str] = []
        self._readers = (
            threading.Thread(target=self._read_progress, daemon=True),
            threading.Thread(target=self._read_errors, daemon=True),
        )
        for reader in self._readers:
            reader.start()

    def _read_progress(self) -> None:
        assert self._process.stdout is not None
        for text in self._process.stdout:
            with contextlib.suppress(ValueError, KeyError, TypeError):
                news = json.loads(text)
                self._line = f"{news['fraction']:4.0%} {news['label']}"

    def _read_errors(self) -> None:
        assert self._process.stderr is not None
        self._errors.extend(text.strip() for text in self._process.stderr if text.strip())

    @property
    def returncode(self) -> int | None:
        return self._process.returncode

    def poll(self) -> int | None:
        """Exit status, None while it works."""
        return self._process.poll()

    def line(self) -> str:
        """What it is doing, padded to overwrite an earlier line."""
        return f"{self._line:<60.60}"

    def outcome(self) -> str:
        """How it ended, in one line."""
        if self.returncode == 0:
            return f"{'done':<70}"
        return self._errors[-1] if self._errors else f"ended with status {self.returncode}"

    def __enter__(self) -> Preparation:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        for reader in self._readers:
            reader.join(2)
        for pipe in (self._process.stdout, self._process.stderr):
            if pipe is not None:
                pipe.close()
