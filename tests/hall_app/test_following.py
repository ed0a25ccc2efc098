"""Looks at the content folder and at what is baked: nothing is lost when one fails, nothing is kept for good."""

from __future__ import annotations

import json
import os
import shutil
import time
from pathlib import Path
from typing import Any

import event_loop
import pytest
from build_processes import with_scarf
from content_house import edit, make_house
from stored_room import store_room

from hall_app.content import load
from hall_app.content.bakes import data_bake
from hall_app.house import Following, House
from hall_app.house import edits as following
from hall_app.house.baking import ROOM, Bake, BakingQueue, tidy
from hall_app.room.bake import built_key, data_room, room_key

SHIPPED = Path(__file__).parents[2] / "assets/exhibits/pibo/baked"
NEWEST = 3  # of a kind are kept


def store_bake(data: Path, name: str, key: str) -> Path:
    target = shutil.copytree(SHIPPED, data_bake(data, name, key))
    (target / "bake.json").write_text(json.dumps({"key": key}), "utf-8")
    return target


class Build:
    """A garment's bake that is done at once."""

    def __init__(self, data: Path, bake: Bake) -> None:
        store_bake(data, bake.name, bake.key)

    def poll(self) -> int | None:
        return 0

    def line(self) -> str:
        return ""

    def outcome(self) -> str:
        return "done"

    def end(self) -> None:
        pass


@pytest.mark.parametrize("where", ["wanted_bakes", "replace"])
def test_a_finished_bake_is_owed_until_it_is_shown(tmp_path: Path, monkeypatch, where: str):
    content = load(with_scarf(tmp_path / "content"))
    house = House(content, tmp_path / "data")
    queue = BakingQueue(lambda bake: Build(house.data, bake))
    follow = Following(house, queue, light=False, say=lambda line: None)
    owner = following if where == "wanted_bakes" else house
    whole = getattr(owner, where)

    def fail(*given: Any, **named: Any) -> None:
        raise OSError("too many open files")

    async def story() -> None:
        await follow.look()
        assert queue.running is not None
        monkeypatch.setattr(owner, where, fail)
        with pytest.raises(OSError, match="too many"):
            await follow.look()
        assert queue.running is None, "that it ended is told once"
        monkeypatch.setattr(owner, where, whole)
        await follow.look()
        assert house.models("scarf") is not None

    try:
        event_loop.run(story())
    finally:
        house.close()


def test_a_bake_whose_files_lie_there_before_its_process_ends_is_shown(tmp_path: Path):
    """On a machine that has much else to do, ending takes a process seconds."""
    content = load(with_scarf(tmp_path / "content"))
    house, said = House(content, tmp_path / "data"), []
    alive = [None, None, None, 0]

    class Slow(Build):
        def poll(self) -> int | None:
            return alive.pop(0)

    def tell(name: str, line: str, last: bool) -> None:
        said.extend([line] if last else [])

    queue = BakingQueue(lambda bake: Slow(house.data, bake), tell=tell)
    follow = Following(house, queue, light=False, say=lambda line: None)

    async def story() -> None:
        for _ in range(5):
            await follow.look()
        assert house.models("scarf") is not None
        assert queue.running is None

    event_loop.run(story())
    house.close()
    assert said == ["done"]


def test_an_edit_whose_showing_failed_is_shown_at_the_next_look(tmp_path: Path, monkeypatch):
    folder = make_house(tmp_path / "content")
    house = House(load(folder), tmp_path / "data")
    said: list[str] = []
    queue = BakingQueue(lambda bake: Build(house.data, bake))
    follow = Following(house, queue, light=False, say=said.append)
    show = house._show

    def fail(*given: Any) -> None:
        raise OSError("too many open files")

    async def story() -> None:
        edit(folder / "exhibits/chest/exhibit.toml", "radius = 0.4", 'radius = "wide"')
        edit(folder / "hall.toml", "z = 3.0", "z = 2.5")
        monkeypatch.setattr(house, "_show", fail)
        with pytest.raises(OSError, match="too many"):
            await follow.look()
        shown: list[object] = []
        monkeypatch.setattr(house, "_show", lambda *given: (shown.append(given), show(*given)))
        await follow.look()
        assert shown
        assert any("radius" in line for line in said), "and what is wrong with it is told"
        await follow.look()
        assert len(shown) == 1

    try:
        event_loop.run(story())
    finally:
        house.close()


def test_a_bake_that_somebody_stops_ends_and_is_told(tmp_path: Path):
    """The office asks from its threads; the open hall does it at its next look, and again when it is asked to."""
    house, log = House(load(with_scarf(tmp_path / "content")), tmp_path / "data"), []

    class Endless(Build):
        def __init__(self, bake: Bake) -> None:
            log.append(f"begin {bake.name}")

        def poll(self) -> int | None:
            return None

        def end(self) -> None:
            log.append("end")

    queue, said = BakingQueue(Endless), []
    follow = Following(house, queue, light=False, say=said.append)

    async def story() -> None:
        await follow.look()
        assert (log, house.preparing) == (["begin scarf"], ("scarf",))
        queue.ask("stop", "scarf")
        for _ in range(3):
            await follow.look()
        assert (log, house.preparing, queue.running) == (["begin scarf", "end"], (), None)
        assert [line for line in said if "stopped in the office" in line] == said[-1:]
        assert any("stopped in the office" in problem.what for problem in house.problems)
        queue.ask("again", "scarf")
        await follow.look()
        assert (log[2:], house.preparing) == (["begin scarf"], ("scarf",))

    try:
        event_loop.run(story())
    finally:
        queue.close()
        house.close()


def aged(folder: Path, seconds: float) -> Path:
    """As if nothing in the folder had been written for that long."""
    then = time.time() - seconds
    for path in (*folder.rglob("*"), folder):
        os.utime(path, (then, then))
    return folder


def test_the_newest_few_of_a_kind_are_kept_and_whatever_is_shown_or_wanted(tmp_path: Path):
    folder, data = make_house(tmp_path / "content"), tmp_path / "data"
    content = load(folder)
    rooms = [
        aged(store_room(data_room(data, f"{age:016x}"), f"{age:016x}"), 100 * age) for age in range(1, 9)
    ]
    robes = [aged(store_bake(data, "robe", f"{age:016x}"), 100 * age) for age in range(1, 9)]
    scarf = aged(store_bake(data, "scarf", "f" * 16), 10_000)
    letters = data_room(data, "e" * 16)
    aged(store_room(letters, "e" * 16, built=built_key(content.plan)), 10_000)
    works = {
        name: data / "bake-work" / name for name in (f"robe-{7:016x}", "robe-" + "a" * 16, "room-" + "b" * 16)
    }
    for work in works.values():
        work.mkdir(parents=True)
        aged(work, 86_400)
    fresh = data / "bake-work" / ("robe-" + "c" * 16)
    fresh.mkdir()
    strange = [data / "room-of-mine", data / "grids", data / "bakes/robe"]
    for path in strange:
        path.mkdir()
    wanted = [Bake("robe", f"{7:016x}"), Bake(ROOM, f"{7:016x}", patient=True)]
    tidy(content, data, shown=[robes[5], rooms[4]], wanted=wanted)
    assert [path.is_dir() for path in robes] == [True] * NEWEST + [False, False, True, True, False]
    assert [path.is_dir() for path in rooms] == [True] * NEWEST + [False, True, False, True, False]
    assert scarf.is_dir(), "one is no few"
    assert letters.is_dir(), "what a hall that opens now would be lit with"
    assert [path.is_dir() for path in works.values()] == [True, False, False]
    assert fresh.is_dir(), "it may be another program's, under way"
    assert all(path.is_dir() for path in strange)


def test_the_room_and_the_garments_of_the_content_as_it_is_are_kept(tmp_path: Path):
    folder, data = make_house(tmp_path / "content"), tmp_path / "data"
    content = load(folder)
    now = aged(store_room(data_room(data, room_key(content, data)), room_key(content, data)), 10_000)
    for age in range(1, 6):
        aged(store_room(data_room(data, f"{age:016x}"), f"{age:016x}"), 100 * age)
    tidy(content, data, shown=[], wanted=[])
    assert now.is_dir()
    assert len(list(data.glob("room-*"))) == NEWEST + 1


@pytest.mark.nightly
def test_a_data_folder_that_is_edited_on_and_on_does_not_grow(tmp_path: Path):
    folder = with_scarf(tmp_path / "content")
    toml = folder / "outfits/scarf.toml"
    house = House(load(folder), tmp_path / "data")
    queue = BakingQueue(lambda bake: Build(house.data, bake))
    follow = Following(house, queue, light=False, say=lambda line: None)
    edit(toml, "seed = 1", "seed = 100")

    async def story() -> None:
        for seed in range(100, 100 + 2 * NEWEST):
            edit(toml, f"seed = {seed}", f"seed = {seed + 1}")
            for _ in range(3):
                await follow.look()
            models = house.models("scarf")
            assert models is not None
            assert models.whole()
        assert len(list((house.data / "bakes").iterdir())) <= NEWEST + 1

    try:
        event_loop.run(story())
    finally:
        house.close()
