"""What stays on show while something is to be baked: the lit room, the last model; what changes at once: obstacles."""

from __future__ import annotations

import asyncio
import contextlib
import json
import shutil
import time
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from build_processes import with_scarf
from content_house import edit, make_house
from stored_room import store_room

from hall_app.content import load
from hall_app.content.bakes import data_bake, key_now
from hall_app.house import House, grid_beside
from hall_app.room.bake import built_key, room_key, shown_room
from hall_app.show import drawn_exhibits

SHIPPED = Path(__file__).parents[2] / "assets/exhibits/pibo/baked"


def alone(work: Coroutine[Any, Any, None]) -> None:
    """asyncio.run in a thread of its own: a browser test before may have left its loop in the main thread."""
    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, work).result()


async def settled(house: House, test: Callable[[], object], patience: float = 120.0) -> None:
    end = time.monotonic() + patience
    while not test():
        assert time.monotonic() < end
        await asyncio.sleep(0.05)
        house.catch_up()


@pytest.fixture
def lit(tmp_path: Path):
    """(its content folder, a house whose room is baked)."""
    folder = make_house(tmp_path / "content")
    content = load(folder)
    store_room(folder / "room", room_key(content), built=built_key(content.plan))
    house = House(content, tmp_path / "data")
    yield folder, house
    house.close()


def test_a_title_leaves_the_room_lit_and_a_wall_does_not(lit):
    folder, house = lit

    async def story() -> None:
        before = house.room.glb
        edit(folder / "exhibits/chest/exhibit.toml", 'en = "Chest"', 'en = "Box"')
        await house.replace(load(folder))
        await settled(house, lambda: house.room.former)
        assert house.content.exhibits[0].file.title.en == "Box"
        assert house.room.baked
        assert house.room.glb is before, "it is not even sent again"
        assert house.room_unlit(), "and its light has still to be computed"
        edit(folder / "plan.toml", "to = [1, -3]", "to = [0.9, -3]")
        await house.replace(load(folder))
        await settled(house, lambda: not house.room.baked)
        assert house.room.glb != before

    alone(story())


@pytest.mark.nightly
def test_who_is_inside_hears_that_the_floor_has_a_grid_of_its_own(lit):
    """Once for the content, and once more when the grid that belongs to it can be fetched."""
    folder, house = lit

    async def story() -> None:
        visitor = house.welcome(time.monotonic(), "predict", "page")
        before = house.walk_json()["grid"]["url"]
        edit(folder / "plan.toml", "to = [1, -3]", "to = [0.9, -3]")
        await house.replace(load(folder))
        await settled(house, lambda: house.walk_json()["grid"]["url"] != before)
        heard = [visitor.outbox.get_nowait()["t"] for _ in range(visitor.outbox.qsize())]
        assert heard.count("content") == 2

    alone(story())


def test_a_hall_that_opens_after_the_edit_is_lit_as_well(lit, tmp_path: Path):
    folder, _ = lit
    edit(folder / "hall.toml", 'zh = "厅"', 'zh = "堂"')
    shown = shown_room(load(folder), tmp_path / "data")
    assert shown.baked
    assert shown.former
    edit(folder / "plan.toml", "height = 0.2", "height = 0.25")
    assert not shown_room(load(folder), tmp_path / "data").baked


def test_what_is_built_is_more_than_what_is_written():
    folder = Path(__file__).parents[2] / "assets"
    plan = load(folder).plan
    bays = tuple(bay.model_copy(update={"name": plan.bay[0].name}) for bay in plan.bay)
    assert built_key(plan.model_copy(update={"bay": bays})) == built_key(plan)
    assert built_key(plan.model_copy(update={"height": plan.height + 0.1})) != built_key(plan)
    record = json.loads((folder / "room/room.json").read_text("utf-8"))
    assert record["built"] == built_key(plan)


def test_a_garment_keeps_its_last_model_until_the_new_one_is_baked(tmp_path: Path):
    folder, data = with_scarf(tmp_path / "content"), tmp_path / "data"

    def bake(content, name: str = "scarf") -> Path:
        exhibit = content.exhibit(name)
        assert exhibit is not None
        key = key_now(content, exhibit)
        assert key is not None
        target = shutil.copytree(SHIPPED, data_bake(data, name, key))
        (target / "bake.json").write_text(json.dumps({"key": key}), "utf-8")
        return target

    toml = folder / "outfits/scarf.toml"
    first = bake(load(folder))
    house = House(load(folder), data)

    def shown() -> Path | None:
        models = house.models("scarf")
        return models.baked if models else None

    async def story() -> None:
        assert shown() == first
        edit(toml, "seed = 1", "seed = 7")
        await house.replace(load(folder))
        assert shown() == first, "until the new one is there"
        second = bake(load(folder))
        await house.replace(load(folder))
        assert shown() == second
        edit(toml, "seed = 7", "seed = 1")
        await house.replace(load(folder))
        assert shown() == first, "what is baked already is shown at once"
        edit(toml, "seed = 1", "seed = 8")
        await house.replace(load(folder))
        assert shown() == first, "and stays, though another was baked later"

    try:
        alone(story())
    finally:
        house.close()
    again = House(load(folder), data)
    again.close()
    assert again.models("scarf") is not None, "a hall that opens now shows the last one there is"


def broken_once(act: Callable[..., Any], times: int = 1) -> Callable[..., Any]:
    """`act`, which fails the first `times` times."""
    left = [True] * times

    def first(*given: Any) -> Any:
        if left:
            left.pop()
            raise OSError("no room on the disk")
        return act(*given)

    return first


@pytest.mark.parametrize("spoil", [lambda file: file.write_bytes(file.read_bytes()[:99]), Path.unlink])
def test_a_model_that_is_being_copied_leaves_the_last_whole_one(tmp_path: Path, spoil):
    folder = make_house(tmp_path / "content")
    chest, line = folder / "exhibits/chest", 'hall = "media/chest.glb"\n'
    fine = chest / "media/fine.glb"
    fine.write_bytes((chest / "media/chest.glb").read_bytes())
    edit(chest / "exhibit.toml", line, line + 'close = "media/fine.glb"\n')
    content = load(folder)  # a faulty exhibit stays as it was last read
    before = drawn_exhibits(content, tmp_path)
    whole = fine.read_bytes()
    spoil(fine)
    after = drawn_exhibits(content, tmp_path, before.models, {figure.id: figure for figure in before.figures})
    assert [figure.close.glb() for figure in after.figures] == [whole]
    assert "fine.glb" in " ".join(map(str, (*load(folder).problems, *after.unreadable)))


@pytest.mark.nightly
def test_what_fails_beside_takes_nothing_else_with_it(lit, monkeypatch):
    folder, house = lit
    monkeypatch.setattr("hall_app.house.house.shown_room", broken_once(shown_room))

    async def story() -> None:
        grid = house.grid
        edit(folder / "plan.toml", "to = [1, -3]", "to = [0.9, -3]")
        await house.replace(load(folder))
        for slow in (house._grid_to_come, house._room_to_come):
            assert slow._task is not None
            await asyncio.wait([slow._task], timeout=120)
        with pytest.raises(OSError, match="no room"):
            house.catch_up()
        assert house.grid is not grid, "the grid was ready and is kept"
        await settled(house, lambda: not house.room.baked)

    alone(story())


@pytest.mark.nightly
@pytest.mark.parametrize("times", [1, 2])
def test_a_grid_that_failed_is_begun_again_once_and_then_told(lit, monkeypatch, times: int):
    folder, house = lit
    fail = broken_once(lambda: None, times)

    async def failing(*given):
        fail()
        return await grid_beside(*given)

    monkeypatch.setattr("hall_app.house.house.grid_beside", failing)

    async def until(test: Callable[[], object]) -> None:
        end = time.monotonic() + 120
        while not test():
            assert time.monotonic() < end
            await asyncio.sleep(0.05)
            with contextlib.suppress(OSError):
                house.catch_up()

    async def story() -> None:
        grid, toml = house.grid, folder / "exhibits/chest/exhibit.toml"
        edit(toml, "z = -1.0", "z = -1.5")
        await house.replace(load(folder))
        if times == 2:
            await until(lambda: "no room on the disk" in " ".join(map(str, house.problems)))
            assert house.grid is grid
            edit(toml, 'en = "Chest"', 'en = "Box"')
            await house.replace(load(folder))  # any edit is an occasion to try again
        await until(lambda: house.grid is not grid)
        assert "no room on the disk" not in " ".join(map(str, house.problems))

    alone(story())


def test_obstacles_hold_at_once_and_the_grid_follows(lit):
    folder, house = lit

    async def story() -> None:
        floor = house.floor
        grid, name = house.grid, house.walk_json()["grid"]["url"]
        edit(folder / "exhibits/chest/exhibit.toml", "z = -1.0", "z = -1.5")
        await house.replace(load(folder))
        assert house.floor.solids != floor.solids
        assert house.grid is grid
        await settled(house, lambda: house.grid is not grid)
        assert house.walk_json()["grid"]["url"] != name

    alone(story())
