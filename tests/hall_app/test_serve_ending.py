"""`hall serve` ends on Ctrl-C whatever it is doing, takes its bakes with it, and writes a log one can read."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from build_processes import builds_of, processes, with_scarf
from plain_hall import write_plain_hall
from running_hall import free_port

from hall_app.content import load
from hall_app.content.bakes import bake_folder, bake_key
from hall_app.house.baking import stale_garments

PATIENCE = 60.0  # [s] of a machine that has much else to do


class Serving:
    """A hall that has been started, whatever has become of it yet."""

    def __init__(self, content: Path, work: Path, *options: str) -> None:
        self.log = work / "serve.log"
        command = [sys.executable, "-m", "hall_app", "serve", "--content", content, "--data", work / "data"]
        with self.log.open("wb") as sink:
            self.process = subprocess.Popen(
                [*command, "--port", str(free_port()), *options], stdout=sink, stderr=subprocess.STDOUT
            )

    def said(self) -> str:
        return self.log.read_text("utf-8")

    def until(self, test: Callable[[], object], patience: float = 400.0) -> None:
        end = time.monotonic() + patience
        while not test():
            assert self.process.poll() is None, self.said()
            assert time.monotonic() < end, self.said()
            time.sleep(0.05)

    def builds(self) -> set[int]:
        """Processes of all builds it has started: each is a session of its own."""
        return builds_of(self.process.pid)


@contextmanager
def serving(content: Path, work: Path, *options: str) -> Iterator[Serving]:
    hall = Serving(content, work, *options)
    try:
        yield hall
    finally:
        if hall.process.poll() is None:
            hall.process.kill()
            hall.process.wait()


def ends(hall: Serving, sign: signal.Signals) -> None:
    """Ended, all of it, with status 0 and without an account of its inner life."""
    builds = hall.builds()
    hall.process.send_signal(sign)
    assert hall.process.wait(PATIENCE) == 0
    end = time.monotonic() + PATIENCE
    while left := builds & processes().keys():
        assert time.monotonic() < end, f"{left} are left"
        time.sleep(0.05)
    assert "Traceback" not in hall.said()
    assert "viser" not in hall.said()


@pytest.mark.nightly
@pytest.mark.parametrize("word", ["Content ", "Opening the hall", "walking grid", "Open  "])
def test_ctrl_c_at_every_stage_of_opening(tmp_path: Path, word: str):
    with serving(write_plain_hall(tmp_path / "content"), tmp_path, "--no-light") as hall:
        hall.until(lambda: word in hall.said())
        ends(hall, signal.SIGINT)


@pytest.mark.nightly
@pytest.mark.parametrize("sign", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_garment_under_way_is_given_up_with_all_its_helpers(tmp_path: Path, sign: signal.Signals):
    from hall_app.build import film_possible

    helpers = 3 if film_possible() else 1  # the build, and those who draw its film
    with serving(with_scarf(tmp_path / "content"), tmp_path, "--no-light") as hall:
        hall.until(lambda: len(hall.builds()) >= helpers)
        ends(hall, sign)
        said = [line for line in hall.said().splitlines() if line.startswith("Preparing scarf")]
        assert said
        assert len(set(said)) == len(said), "a log is no terminal: nothing is said twice"


@pytest.mark.nightly
def test_the_rooms_light_under_way_is_given_up(tmp_path: Path):
    with serving(write_plain_hall(tmp_path / "content"), tmp_path) as hall:
        hall.until(lambda: "Preparing the room's light" in hall.said() and hall.builds())
        ends(hall, signal.SIGINT)


def test_a_garment_whose_pattern_went_away_keeps_its_last_bake(tmp_path: Path):
    content = load(with_scarf(tmp_path / "content"))
    scarf = content.exhibit("scarf")
    assert scarf is not None
    home = scarf.folder / "baked"
    home.mkdir()
    (home / "bake.json").write_text(json.dumps({"key": bake_key(content, scarf)}))
    for name in ("garment.npz", "hall.glb", "close.glb"):
        (home / name).write_bytes(b"made long ago")
    assert bake_folder(content, scarf, tmp_path / "data", stale=False) == home
    os.remove(tmp_path / "content/patterns/pibo.toml")
    assert bake_folder(content, scarf, tmp_path / "data") == home
    assert bake_folder(content, scarf, tmp_path / "data", stale=False) is None
    assert stale_garments(content, tmp_path / "data") == ()
