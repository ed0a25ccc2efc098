"""Baking from the server's side: what needs it, and a child process that does it."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import TracebackType

from .bake.places import bake_folder, key_now
from .content.loading import Content, Exhibit
from .ending import undisturbed

__all__ = ["Preparation", "stale_garments"]


def stale_garments(content: Content, data: Path) -> tuple[Exhibit, ...]:
    """Exhibits whose garment has no bake of its present pattern, weave and recipe."""
    return tuple(
        exhibit
        for exhibit in content.exhibits
        if exhibit.file.garment is not None
        and key_now(content, exhibit) is not None  # an input is missing: nothing can be baked from it
        and bake_folder(content, exhibit, data, stale=False) is None
    )


class Preparation:
    """One `hall build` in a process of its own; ends with the block that holds it."""

    def __init__(self, content: Path, data: Path, *what: str) -> None:
        """what: options of `hall build`, such as "--exhibit", "pibo" or "--room"."""
        command = [sys.executable, "-m", "hall_app", "build", "--content", str(content), "--data", str(data)]
        self._line = "starting …"
        self._errors: list[str] = []
        try:
            with undisturbed():
                self._process = subprocess.Popen(
                    [*command, *what, "--into-data", "--json"],
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE,
                    text=True,
                    encoding="utf-8",
                    start_new_session=True,  # Ctrl-C reaches us alone; we end the child ourselves
                )
                self._readers = (
                    threading.Thread(target=self._read_progress, daemon=True),
                    threading.Thread(target=self._read_errors, daemon=True),
                )
                for reader in self._readers:
                    reader.start()
        except KeyboardInterrupt:  # came meanwhile
            self._end()
            raise

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
        """What it is doing."""
        return self._line

    def outcome(self) -> str:
        """How it ended, in one line."""
        if self.returncode == 0:
            return "done"
        return self._errors[-1] if self._errors else f"ended with status {self.returncode}"

    def __enter__(self) -> Preparation:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    def _end(self) -> None:
        """End the build with all it started: its film is drawn by processes that hold the same pipes.

        What it has done is kept by its own files, whole ones or none, so it needs no time to say good-bye.
        """
        if self._process.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        for reader, pipe in zip(self._readers, (self._process.stdout, self._process.stderr), strict=True):
            reader.join(1)
            if pipe is not None and not reader.is_alive():  # closing waits for who reads
                pipe.close()
