"""Baking from the server's side: what of the content needs it, and a child process that does it."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

from hall_app.content.bakes.store import bake_folder, bake_work, data_bake, key_now, read_record
from hall_app.content.folder import Content, Exhibit
from hall_app.house.baking.queue import Bake
from hall_app.house.signals import undisturbed

__all__ = ["ROOM", "Preparation", "bake_places", "forsake", "stale_garments", "wanted_bakes"]

ROOM = "the room's light"  # the name of its bake; no exhibit is called so
_NICE = 10  # how far a bake stands back for who serves visitors


def stale_garments(content: Content, data: Path) -> tuple[Exhibit, ...]:
    """Exhibits whose garment or scan has no bake of it as it is now."""
    return tuple(
        exhibit
        for exhibit in content.exhibits
        if exhibit.file.baked_key is not None
        and key_now(content, exhibit) is not None  # an input is missing: nothing can be baked from it
        and bake_folder(content, exhibit, data, stale=False) is None
    )


def wanted_bakes(
    content: Content, data: Path, *, light: bool, running: Bake | None = None
) -> tuple[Bake, ...]:
    """Every bake that the content lacks as it is now; light: the room's as well; running: the one that runs, which is
    wanted until its process has ended, though what it makes lies there a moment before.

    Reads and hashes files, some 25 ms of them: to be called beside the event loop.
    """
    from hall_app.room.bake.key import room_key
    from hall_app.room.bake.store import room_folder

    keys = ((exhibit.id, key_now(content, exhibit)) for exhibit in stale_garments(content, data))
    garments = tuple(Bake(name, key) for name, key in keys if key is not None)
    if running is not None and running not in garments and _fits(running, content):
        garments = (running, *garments)
    # Garments cast shadows: the light of one baked before them would be that of another hall.
    room = Bake(ROOM, room_key(content, data), patient=True) if light else None
    if room is None or (room_folder(content, data) is not None and room != running):
        return garments
    return (*garments, room)


def _fits(bake: Bake, content: Content) -> bool:
    """Whether it is of an exhibit as this is now."""
    exhibit = content.exhibit(bake.name)
    return (
        exhibit is not None and exhibit.file.baked_key is not None and key_now(content, exhibit) == bake.key
    )


def bake_places(bake: Bake, data: Path) -> tuple[Path, Path]:
    """Where a bake keeps its state while it is under way, and where what it makes is kept."""
    from hall_app.room.bake.store import data_room, room_work

    if bake.name == ROOM:
        return room_work(data, bake.key), data_room(data, bake.key)
    return bake_work(data, bake.name, bake.key), data_bake(data, bake.name, bake.key)


def forsake(bake: Bake, data: Path) -> None:
    """Remove what a bake that was ended has left: its state, and files in its place that make no whole bake."""
    from hall_app.room.bake.store import room_record

    work, target = bake_places(bake, data)
    shutil.rmtree(work, ignore_errors=True)
    if (room_record if bake.name == ROOM else read_record)(target) is None:
        shutil.rmtree(target, ignore_errors=True)


class Preparation:
    """One `hall build` in a process of its own, until `end`."""

    def __init__(self, content: Path, data: Path, bake: Bake) -> None:
        what = ("--room",) if bake.name == ROOM else ("--exhibit", bake.name)
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
            _stand_back(self._process.pid)
        except KeyboardInterrupt:  # came meanwhile
            self.end()
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

    def end(self) -> None:
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


def _stand_back(leader: int) -> None:
    """Let a session of processes run only where others leave it time. Best effort: not every system can."""
    with contextlib.suppress(OSError, AttributeError):
        os.setpriority(os.PRIO_PGRP, leader, _NICE)
    # Linux shares the time among sessions first, so that niceness alone tells only within one.
    with contextlib.suppress(OSError):
        Path(f"/proc/{leader}/autogroup").write_text(str(_NICE))
