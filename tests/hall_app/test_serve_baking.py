"""A curator edits while something is baked: the edits show, the bake follows what the content wants."""

from __future__ import annotations

import json
import os
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path

import pytest
from build_processes import builds_of, processes, with_scarf
from plain_hall import write_plain_hall
from running_hall import RunningHall, running_hall

from hall_app.content import load
from hall_app.content.bakes import bake_work, key_now

PATIENCE = 20.0  # [s] of a machine that has much else to do; baking takes minutes of it


def until(test: Callable[[], object], hall: RunningHall, patience: float = PATIENCE) -> None:
    end = time.monotonic() + patience
    while not test():
        assert time.monotonic() < end, hall.said()
        time.sleep(0.1)


def asked(hall: RunningHall, path: str) -> dict:
    with urllib.request.urlopen(f"{hall.url}/api/{path}", timeout=PATIENCE) as answer:
        return json.load(answer)


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")


def title(hall: RunningHall, words: str) -> bool:
    return asked(hall, "exhibits/box")["title"]["en"] == words


def text(hall: RunningHall, words: str) -> bool:
    return words in asked(hall, "exhibits/box")["text"]["en"]


@pytest.mark.nightly
@pytest.mark.slow
def test_edits_show_while_the_rooms_light_is_baked(tmp_path: Path):
    with running_hall(write_plain_hall(tmp_path / "content"), tmp_path, light=True) as hall:
        until(lambda: builds_of(hall.process.pid), hall)
        first = builds_of(hall.process.pid)
        assert all(os.getpriority(os.PRIO_PROCESS, pid) >= 10 for pid in first), (
            "it stands back for the server"
        )
        home = hall.content / "exhibits/box"
        edit(home / "exhibit.toml", "Plain box", "Another title")
        until(lambda: title(hall, "Another title"), hall)
        (home / "text.en.md").write_text("Another text.", "utf-8")
        until(lambda: text(hall, "Another text"), hall)
        # A title is written in the room: the light that was on its way is that of another room.
        until(lambda: not first & processes().keys(), hall)
        until(lambda: builds_of(hall.process.pid), hall)
        assert "Preparing the room's light: done" not in hall.said()
        works = list((hall.data / "bake-work").glob("room-*"))
        assert len(works) <= 1, "nothing is left of the light that was given up"


@pytest.mark.slow
def test_the_doors_open_while_a_garment_is_baked_and_a_superseded_bake_ends(tmp_path: Path):
    content = with_scarf(tmp_path / "content")
    data = tmp_path / "data"

    def key() -> str:
        now = load(content)
        scarf = now.exhibit("scarf")
        assert scarf is not None
        return key_now(now, scarf) or ""

    with running_hall(content, tmp_path) as hall:
        scene = asked(hall, "scene")
        assert [exhibit["id"] for exhibit in scene["exhibits"]] == ["box"]
        assert scene["preparing"] == ["scarf"]
        assert scene["problems"] == 0
        until(lambda: bake_work(data, "scarf", key()).is_dir(), hall, 300)
        first, before = builds_of(hall.process.pid), bake_work(data, "scarf", key())
        edit(content / "exhibits/box/exhibit.toml", "Plain box", "Another title")
        until(lambda: title(hall, "Another title"), hall)
        assert builds_of(hall.process.pid) & first, "an edit that does not concern it leaves a bake alone"
        edit(content / "outfits/scarf.toml", "seed = 1", "seed = 7")
        until(lambda: not first & processes().keys(), hall)
        until(lambda: not before.exists(), hall)
        until(lambda: builds_of(hall.process.pid), hall)
        assert asked(hall, "scene")["preparing"] == ["scarf"]
        second = builds_of(hall.process.pid)
        (content / "exhibits/scarf/exhibit.toml").unlink()
        (content / "exhibits/scarf").rename(content / "exhibits/_scarf")
        until(lambda: not second & processes().keys(), hall)
        until(lambda: asked(hall, "scene")["preparing"] == [], hall)
    assert not list((data / "bake-work").iterdir())


@pytest.mark.nightly
@pytest.mark.slow
def test_a_bake_that_fails_is_told_and_not_tried_again(tmp_path: Path):
    content = with_scarf(tmp_path / "content")
    edit(content / "patterns/pibo.toml", "2.4]", "1e300]")
    with running_hall(content, tmp_path) as hall:
        until(lambda: asked(hall, "scene")["problems"] == 1, hall, 300)
        (problem,) = asked(hall, "problems")
        assert problem["file"] == "exhibits/scarf/exhibit.toml"
        assert "baking failed" in problem["what"]
        begun = hall.said().count("Preparing scarf: starting")
        (content / "exhibits/box/text.en.md").write_text("Another text.", "utf-8")
        until(lambda: text(hall, "Another text"), hall)
        time.sleep(2.5)  # two more looks of the hall
        assert not builds_of(hall.process.pid)
        assert hall.said().count("Preparing scarf: starting") == begun
