"""A stored room is shown and passes `hall check` only while every file is the one that was baked."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from content_house import make_house, write_box
from full_matrix import by_day
from stored_room import store_room

from hall_app.check import check
from hall_app.cli import main
from hall_app.content import load
from hall_app.content.bakes import FILES, publish, seal, seal_record
from hall_app.house import House
from hall_app.room.bake import build as bake
from hall_app.room.bake import room_folder, room_key, room_record, shown_room, still_right


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """A good content folder with its room."""
    folder = make_house(tmp_path / "house")
    store_room(folder / "room", room_key(load(folder)))
    assert check(folder) == []
    return folder


def torn(room: Path) -> None:
    data = (room / "room.glb").read_bytes()
    (room / "room.glb").write_bytes(data[: len(data) // 2])


def scrambled(room: Path) -> None:
    """The head whole, the pictures noise: what a bad disk or an unfinished copy leaves."""
    data = bytearray((room / "room.glb").read_bytes())
    start = 28 + int.from_bytes(data[12:16], "little")
    data[start:] = np.random.default_rng(1).bytes(len(data) - start)
    (room / "room.glb").write_bytes(data)


def record_of(change: Callable[[dict], object]) -> Callable[[Path], object]:
    def spoil(room: Path) -> None:
        record = json.loads((room / "room.json").read_text("utf-8"))
        change(record)
        (room / "room.json").write_text(json.dumps(record), "utf-8")

    return spoil


def resealed(change: Callable[[Path], object]) -> Callable[[Path], object]:
    """The change, and a record that vouches for it: what stays is what opening the files finds."""

    def spoil(room: Path) -> None:
        change(room)
        record_of(lambda record: record.update({FILES: seal(room, "room.json")}))(room)

    return spoil


def without_light(room: Path) -> None:
    write_box(room / "room.glb")


def garbage(room: Path) -> None:
    (room / "environment.jpg").write_bytes(b"garbage\n")


BAKED = "is not the file that was baked"
FAULTS: dict[str, tuple[Callable[[Path], object], str, str]] = {
    "torn GLB": (torn, "room.glb", BAKED),
    "noise in the GLB": (scrambled, "room.glb", BAKED),
    "another GLB": (without_light, "room.glb", BAKED),
    "no picture": (garbage, "environment.jpg", BAKED),
    "no environment": (lambda room: (room / "environment.jpg").unlink(), "environment.jpg", "is missing"),
    "no record": (lambda room: (room / "room.json").unlink(), "room.json", "is missing"),
    "broken record": (lambda room: (room / "room.json").write_text("{"), "room.json", "cannot be read"),
    "a list for a record": (lambda room: (room / "room.json").write_text("[]"), "room.json", "which files"),
    "key alone": (record_of(lambda record: record.pop(FILES)), "room.json", "which files belong"),
    "odd digests": (record_of(lambda record: record.update(files={"room.glb": 1})), "room.json", "which"),
    "one digest less": (record_of(lambda r: r[FILES].pop("room.glb")), "room.glb", "not named in the record"),
    "a file elsewhere": (record_of(lambda r: r[FILES].update({"../x": "0"})), "../x", "outside the bake"),
    "sealed torn GLB": (resealed(torn), "room.glb", "cannot be opened: the GLB is broken or cut off"),
    "sealed noise": (resealed(scrambled), "room.glb", "texture"),
    "sealed other GLB": (resealed(without_light), "room.glb", "has no meshes hall_… with a lightmap"),
    "sealed garbage": (resealed(garbage), "environment.jpg", "cannot be shown"),
    "odd triangles": (record_of(lambda r: r.update(triangles="x")), "room.json: triangles", "tells of 'x'"),
}


@pytest.mark.parametrize("fault", by_day([*FAULTS][::6], FAULTS))
def test_a_broken_room_is_one_line(house: Path, fault: str):
    spoil, file, what = FAULTS[fault]
    spoil(house / "room")
    (line,) = [str(problem) for problem in check(house) if problem.what != "the file is empty (0 bytes)"]
    assert line.startswith(f"room/{file}")
    assert what in line
    assert line.endswith(" – run: hall build --room")


SHOWN_ALL_THE_SAME = ["torn GLB", "noise in the GLB", "another GLB", "no picture", "key alone"]


@pytest.mark.parametrize("fault", by_day(["torn GLB"], SHOWN_ALL_THE_SAME))
def test_a_broken_room_is_shown_evenly_lit_and_named(house: Path, tmp_path: Path, fault: str):
    data, content = tmp_path / "data", load(house)
    whole = shown_room(content, data)
    assert whole.baked
    spoil, file, what = FAULTS[fault]
    spoil(house / "room")
    assert not still_right(whole, content, data)
    shown = shown_room(content, data)
    assert not shown.baked
    assert shown.broken is not None
    assert shown.broken.startswith(f"room/{file} ")
    store_room(data / f"room-{shown.key}", shown.key)  # the server's own is whole, and is taken
    assert shown_room(content, data).baked


def test_the_hall_tells_which_file_of_its_room_is_broken(house: Path, tmp_path: Path):
    torn(house / "room")
    running = House(load(house), tmp_path / "data")
    try:
        (line,) = [str(problem) for problem in running.problems]
        assert line.startswith("room/room.glb: is not the file that was baked")
        assert "shown evenly lit – run: hall build --room" in line
        assert running.room_unlit()
    finally:
        running.close()


def test_build_makes_a_broken_room_again(house: Path, tmp_path: Path, monkeypatch, capsys):
    made = []

    def bake_room(content, *, key, target, **_):
        made.append(store_room(target, key, bytes=1, seconds=0.0))
        return room_record(target)

    monkeypatch.setattr(bake, "bake_room", bake_room)
    command = ["build", "--room", "--content", str(house), "--data", str(tmp_path / "data")]
    assert main(command) == 0
    assert "up to date" in capsys.readouterr().out
    assert not made
    torn(house / "room")
    assert main(command) == 0
    assert made == [house.resolve() / "room"]
    assert check(house) == []


def test_a_model_made_again_takes_the_old_shadow_with_it(house: Path, tmp_path: Path):
    content, before = load(house), room_key(load(house))
    write_box(house / "exhibits/chest/media/chest.glb", height=0.9)
    assert room_key(load(house)) != before
    assert room_folder(content, tmp_path) is None
    (problem,) = check(house)
    assert "a model" in problem.what
    (house / "exhibits/chest/media/chest.glb").unlink()
    room_key(content)  # a model that went away after the content was read casts no shadow


def test_a_room_sealed_once_is_not_sealed_again(house: Path):
    record_of(lambda record: record.pop(FILES))(house / "room")
    assert set(seal_record(house / "room", "room.json")) == {"room.glb", "environment.jpg"}
    assert check(house) == []
    torn(house / "room")
    with pytest.raises(ValueError, match="sealed already"):
        seal_record(house / "room", "room.json")


def test_while_files_are_put_in_place_the_old_record_is_gone(tmp_path: Path, monkeypatch):
    """Cut off between two files, old and new ones lie side by side: that is no bake."""
    old = store_room(tmp_path / "room", "old")
    new = store_room(tmp_path / "out", "new")
    copy, copied = shutil.copyfile, []

    def cut(source, target):
        copied.append(target)
        if len(copied) == 2:
            raise KeyboardInterrupt
        return copy(source, target)

    monkeypatch.setattr(shutil, "copyfile", cut)
    with pytest.raises(KeyboardInterrupt):
        publish(new, old, "room.json")
    assert not (old / "room.json").exists()
    assert room_record(old) is None
    monkeypatch.undo()
    publish(new, old, "room.json")
    record = room_record(old)
    assert record is not None
    assert record["key"] == "new"
