"""Exhibits baked beside each other: as alone, one that fails holds no other up, and what is ended goes on later."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from multiprocessing import active_children
from pathlib import Path

import pytest
from coarse_bake import LAYERED, STAND, coarse

from hall_app.build import Job, bake_beside
from hall_app.content import load
from hall_app.content.bakes import bake_key, baked_here, read_record

pytestmark = pytest.mark.slow


def jobs(folder: Path, *exhibits: str) -> list[Job]:
    content = load(folder)
    found = []
    for name in exhibits:
        exhibit = content.exhibit(name)
        assert exhibit is not None
        key, target = bake_key(content, exhibit), baked_here(exhibit)
        found.append(Job(folder, name, key, target, folder.parent / "data", 60.0, film=False))
    return found


def test_they_are_as_baked_alone(coarse_scarf, coarse_layers, tmp_path):
    folder, told = coarse(tmp_path), []
    records = dict(bake_beside(jobs(folder, STAND, LAYERED), 2, lambda *news: told.append(news)))
    assert records[STAND]["digest"] == coarse_scarf[1]["digest"]
    assert records[LAYERED]["digest"] == coarse_layers[1]["digest"]
    for name in (STAND, LAYERED):
        own = [share for exhibit, share, _ in told if exhibit == name]
        assert own == sorted(own)
        assert own[-1] == 1.0
    assert told[0][0] != told[-1][0] or len({exhibit for exhibit, *_ in told[:-1]}) == 2


def test_one_that_fails_holds_no_other_up(tmp_path):
    folder = coarse(tmp_path)
    wanted = jobs(folder, STAND, LAYERED)
    crossed = 'name = "x"\ntitle = { zh = "x", en = "x" }\nedge = 0.05\noutline = [[0, 0], [1, 1], [1, 0], [0, 1]]\n'
    (folder / "patterns/pibo.toml").write_text(crossed, "utf-8")
    found = dict(bake_beside(wanted, 2, lambda *_: None))
    assert "patterns/pibo.toml" in found[STAND]
    assert "cross" in found[STAND]
    assert found[LAYERED]["key"] == wanted[1].key


def test_whoever_stops_listening_ends_them(tmp_path):
    class EnoughError(Exception):
        pass

    def enough(*_: object) -> None:
        raise EnoughError

    folder = coarse(tmp_path)
    wanted = jobs(folder, STAND, LAYERED)
    with pytest.raises(EnoughError):
        list(bake_beside(wanted, 2, enough))
    end = time.monotonic() + 20
    while active_children() and time.monotonic() < end:
        time.sleep(0.1)
    assert not [process.name for process in active_children() if process.name in (STAND, LAYERED)]
    assert not any(read_record(job.target) for job in wanted)
    assert {name for name, _ in bake_beside(wanted, 2, lambda *_: None)} == {STAND, LAYERED}


@pytest.mark.nightly
def test_the_command_bakes_all_and_then_the_room(tmp_path):
    folder = coarse(tmp_path)
    words = [
        sys.executable,
        "-m",
        "hall_app",
        "build",
        "--content",
        str(folder),
        "--data",
        str(tmp_path / "data"),
    ]
    done = subprocess.run([*words, "--no-film", "--json", "--workers", "2"], capture_output=True, text=True)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0, done.stderr
    assert {line["exhibit"] for line in lines if line.get("state") == "baked" and "exhibit" in line} == {
        STAND,
        LAYERED,
    }
    assert {line["exhibit"] for line in lines if "fraction" in line and "exhibit" in line} == {STAND, LAYERED}
    assert "room" in lines[-1]
    again = subprocess.run([*words, "--json"], capture_output=True, text=True)
    assert [json.loads(line)["state"] for line in again.stdout.splitlines()] == ["up to date"] * 3
