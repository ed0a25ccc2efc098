"""What many ask for is made once: answers per state of the hall, pieces and packs per name, few at a time."""

from __future__ import annotations

import asyncio
import json
import logging
import os
import shutil
import struct
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import event_loop
import pytest
import zstandard
from content_house import edit, make_house
from full_matrix import by_day
from PIL import Image
from test_catalogue import Outline
from test_server_door import message_of, noise, whole

from hall_app.content import load
from hall_app.house import House
from hall_app.show import LEAN, Pieces
from hall_app.show import pieces as scene
from hall_app.web import app as application
from hall_app.web import create_app
from hall_app.web.pages import PAGE_FOLDER, Thumbnails, catalogue_html


@dataclass(frozen=True)
class Answer:
    status: int
    headers: dict[str, str]
    content: bytes


class Visitor:
    """Asks the application without a network between."""

    def __init__(self, house: House) -> None:
        self.app = create_app(house)

    async def get(self, address: str, headers: Mapping[str, str] | None = None) -> Answer:
        path, _, query = address.partition("?")
        given = [(name.encode(), value.encode()) for name, value in (headers or {}).items()]
        scope = {"type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": "GET"}
        scope |= {"scheme": "http", "path": path, "raw_path": path.encode(), "query_string": query.encode()}
        scope |= {"root_path": "", "headers": given, "client": ("127.0.0.1", 9), "server": ("hall", 80)}
        came: list[dict[str, Any]] = []
        asked = asyncio.Event()

        async def receive() -> dict[str, Any]:
            if asked.is_set():
                await asyncio.Event().wait()  # stays on the line until it is answered
            asked.set()
            return {"type": "http.request", "body": b"", "more_body": False}

        async def send(message: dict[str, Any]) -> None:
            came.append(message)

        await self.app(scope, receive, send)  # type: ignore[arg-type]
        told = {name.decode().lower(): value.decode() for name, value in came[0]["headers"]}
        return Answer(came[0]["status"], told, b"".join(part.get("body", b"") for part in came[1:]))


class Counted:
    """Calls of something, and how many ran at once at most."""

    def __init__(self, act: Callable[..., Any], pause: float = 0.05) -> None:
        self.act, self.pause = act, pause
        self.calls = self.running = self.most = 0
        self.given: list[tuple[Any, ...]] = []
        self.changing = threading.Lock()

    def __call__(self, *given: Any, **named: Any) -> Any:
        with self.changing:
            self.calls, self.running = self.calls + 1, self.running + 1
            self.given.append(given)
            self.most = max(self.most, self.running)
        try:
            time.sleep(self.pause)
            return self.act(*given, **named)
        finally:
            with self.changing:
                self.running -= 1


@pytest.fixture
def hall(tmp_path: Path):
    """(its content folder, a house of one chest)."""
    folder = make_house(tmp_path / "content")
    house = House(load(folder), tmp_path / "data")
    yield folder, house
    house.close()


SLOW_ONES = {
    "/catalogue": "catalogue_html",
    "/catalogue?lang=xx": "catalogue_html",
    "/api/scene": "scene_json",
    "/api/exhibits/chest": "exhibit_json",
    "/": "door_page",
}


@pytest.mark.parametrize("path", by_day(["/"], SLOW_ONES))
def test_an_answer_is_made_once_however_many_ask(hall, monkeypatch, path: str):
    folder, house = hall
    made = Counted(getattr(application, SLOW_ONES[path]))
    monkeypatch.setattr(application, SLOW_ONES[path], made)
    monkeypatch.setattr(application, "_pack_first_view", lambda *given: None)

    async def story() -> None:
        visitor = Visitor(house)
        await visitor.get("/")
        await asyncio.sleep(0.5)  # the pack is made: its size stands in the door
        before = made.calls
        first = await asyncio.gather(*(visitor.get(path) for _ in range(16)))
        assert {answer.status for answer in first} == {200}
        assert made.calls - before <= 1
        named = {"if-none-match": first[0].headers["etag"]}
        assert (await visitor.get(path, headers=named)).status == 304
        assert made.calls - before <= 1
        edit(folder / "exhibits/chest/exhibit.toml", 'en = "Chest"', 'en = "Coffer"')
        edit(folder / "hall.toml", 'en = "Hall"', 'en = "House"')
        await house.replace(load(folder))
        now = await visitor.get(path, headers=named)
        assert now.status == 200, "another state, another answer"
        assert now.content != first[0].content

    event_loop.run(story())


def test_the_scene_tells_of_a_bake_at_once(hall):
    _, house = hall

    async def story() -> None:
        visitor = Visitor(house)
        assert json.loads((await visitor.get("/api/scene")).content)["preparing"] == []
        house._pending = frozenset({"chest"})
        assert json.loads((await visitor.get("/api/scene")).content)["preparing"] == ["chest"]

    event_loop.run(story())


# Pieces.


def kept(pieces: Pieces, data: bytes) -> str:
    """The name of a model that is one piece."""
    lean = pieces.lean(message_at(1.5, pieces.stand_in(data)))
    (length,) = struct.unpack_from("<I", lean, 8)
    (name,) = (part for part in json.loads(lean[12 : 12 + length])["parts"] if isinstance(part, str))
    return name


def message_at(when: float, *models: bytes) -> bytes:
    messages = [{"type": "GlbMessage", "props": {"glb_data": model}} for model in models]
    return message_of({"messages": messages, "timestampSec": when, "binaryBufferLengths": []})


WHOLE = noise(1, 70_000)


def test_a_piece_is_packed_once_however_many_ask(monkeypatch):
    packing = Counted(scene.best_frame)
    monkeypatch.setattr(scene, "best_frame", packing)
    pieces = Pieces()
    name = kept(pieces, WHOLE)
    with ThreadPoolExecutor(12) as visitors:
        frames = set(visitors.map(pieces.frame, [name] * 12))
    assert len(frames) == 1
    assert packing.given.count((WHOLE,)) == 1, "a house before may still pack its first view"


def test_who_waits_for_pieces_takes_no_thread_each(hall, monkeypatch):
    _, house = hall
    packing = Counted(scene.best_frame, pause=0.1)
    monkeypatch.setattr(scene, "best_frame", packing)
    monkeypatch.setattr(application, "_pack_first_view", lambda *given: None)

    async def story() -> None:
        visitor = Visitor(house)
        large = [noise(number, 40_000) for number in range(12)]
        names = [kept(house.scene.pieces, data) for data in large]
        before, most = threading.active_count(), 0
        asked = [asyncio.create_task(visitor.get(f"/scene/pieces/{name}")) for name in names * 3]
        while not all(task.done() for task in asked):
            most = max(most, threading.active_count() - before)
            await asyncio.sleep(0.01)
        assert {(await task).status for task in asked} == {200}
        assert sorted(data for (data,) in packing.given if data in large) == sorted(large), "once each"
        assert packing.most <= 4
        assert most < 12, "fewer threads than names, far fewer than visitors"
        for odd in ("pieces/none", "packs/none", "other/none"):
            assert (await visitor.get(f"/scene/{odd}")).status == 404

    event_loop.run(story())


def test_what_is_forgotten_while_it_is_packed_stays_forgotten(monkeypatch):
    """Else it stays for ever: nothing names it any more."""
    pieces, plain = Pieces(), scene.best_frame
    monkeypatch.setattr(scene, "KEPT", 100_000)

    def meanwhile(data: bytes) -> bytes:
        pieces.stand_in(noise(7, 90_000))
        return plain(data)

    monkeypatch.setattr(scene, "best_frame", meanwhile)
    name = kept(pieces, noise(8, 60_000))
    pieces.frame(name)
    with pytest.raises(KeyError):
        pieces.frame(name)


def test_a_pack_that_is_forgotten_while_it_is_made_stays_forgotten(monkeypatch):
    pieces, plain, edits = Pieces(), scene.best_frame, [noise(number, 40_000) for number in range(10, 15)]
    pieces.show("/box", noise(9, 40_000))
    name, _ = pieces.plan_pack()

    def meanwhile(data: bytes) -> bytes:
        while edits:
            pieces.show("/box", edits.pop())
            pieces.plan_pack()
        return plain(data)

    monkeypatch.setattr(scene, "best_frame", meanwhile)
    pieces.pack(name)
    with pytest.raises(KeyError):
        pieces.pack(name)


def test_the_next_visitors_scene_is_not_looked_through_again(monkeypatch):
    naming = Counted(scene.sha256, pause=0)
    monkeypatch.setattr(scene, "sha256", naming)
    pieces, models = Pieces(), [noise(1, 200_000), noise(2, 64_000)]
    marks = [pieces.show(str(n), model) for n, model in enumerate(models)]
    named = naming.calls
    for when in (1.5, 2.5, 1e300):
        assert len(message_at(when, *marks)) < 500, "what viser has to pack and to send"
        assert whole(pieces.lean(message_at(when, *marks)), pieces) == body_of(message_at(when, *models))
    assert naming.calls == named


def body_of(message: bytes) -> bytes:
    return zstandard.ZstdDecompressor().decompress(message[16:])


def test_what_is_shown_is_kept_and_other_models_make_room(monkeypatch):
    pieces, shown, passing = Pieces(), noise(1, 60_000), noise(2, 60_000)
    first, second = pieces.show("/box", shown), pieces.stand_in(passing)
    monkeypatch.setattr(scene, "KEPT", 100_000)
    third = pieces.stand_in(noise(3, 90_000))
    for mark in (first, third):
        assert pieces.lean(message_at(2.5, mark)).startswith(LEAN)
    with pytest.raises(KeyError):
        pieces.lean(message_at(2.5, second))
    assert pieces.stand_in(passing) == second, "looked at again: as before"
    assert whole(pieces.lean(message_at(2.5, second)), pieces) == body_of(message_at(2.5, passing))
    pieces.show("/box", passing)
    pieces.stand_in(noise(3, 90_000))
    with pytest.raises(KeyError):  # replaced: there was no room for both
        pieces.lean(message_at(2.5, first))


def test_what_comes_after_the_first_view_is_in_no_pack_and_is_kept(monkeypatch):
    pieces, near, far = Pieces(), noise(1, 60_000), noise(2, 60_000)
    pieces.show("near", near)
    name, _ = pieces.plan_pack()
    mark = pieces.show("far", far, first=False)
    assert pieces.plan_pack()[0] == name
    monkeypatch.setattr(scene, "KEPT", 100_000)
    pieces.stand_in(noise(3, 90_000))
    lean = pieces.lean(message_at(2.5, mark))
    assert whole(lean, pieces) == body_of(message_at(2.5, far))
    pieces.show("far", far)
    assert pieces.plan_pack()[0] != name, "a curator moved it ahead"


def test_a_message_in_another_shape_travels_whole_and_is_said_once(caplog):
    pieces, strange = Pieces(), message_of({"texts": "x" * 9}) + os.urandom(100_000)
    odd = strange[:8] + (1 << 62).to_bytes(8, "little") + os.urandom(100_000)
    with caplog.at_level(logging.WARNING):
        for _ in range(3):
            assert pieces.lean(odd) is odd
            assert pieces.lean(strange) is strange
    assert len(caplog.records) == 1
    mark = pieces.stand_in(noise(1, 60_000))
    assert pieces.lean(message_at(1.0, mark)).startswith(LEAN), "the next one is looked at again"


# Pictures, page files, the catalogue's names.


def test_a_thumbnail_that_cannot_be_made_is_not_kept_by_browsers(hall):
    folder, house = hall
    (house.data / "thumbnails").write_text("a file, not a folder: as good as a full disk")

    async def story() -> None:
        visitor = Visitor(house)
        answer = await visitor.get("/thumbnails/chest/media/front.jpg")
        assert answer.content == (folder / "exhibits/chest/media/front.jpg").read_bytes()
        assert "immutable" not in answer.headers["cache-control"]
        (house.data / "thumbnails").unlink()
        small = await visitor.get("/thumbnails/chest/media/front.jpg")
        assert small.headers["content-type"] == "image/webp"
        assert "immutable" in small.headers["cache-control"]

    event_loop.run(story())


def test_a_full_disk_leaves_no_half_of_a_thumbnail(tmp_path: Path, monkeypatch):
    def full(self, path, *given, **named) -> None:
        Path(path).write_bytes(b"RIFF")
        raise OSError(28, "No space left on device")

    picture = tmp_path / "p.png"
    Image.new("RGB", (8, 8)).save(picture)
    monkeypatch.setattr(Image.Image, "save", full)
    assert Thumbnails(tmp_path / "kept").file(picture) == picture
    assert list((tmp_path / "kept").iterdir()) == []


@pytest.mark.parametrize("spoilt", ["door.js", "hall.css", "texts.toml", "hall.js"])
def test_a_half_updated_page_answers_as_before(tmp_path: Path, spoilt: str):
    from hall_app.web.pages import PageFolder

    folder = Path(shutil.copytree(PAGE_FOLDER, tmp_path / "page"))
    watched = PageFolder(folder)
    whole_one, file = watched.now(), folder / spoilt
    text = file.read_text("utf-8")
    file.unlink()
    assert watched.now() is whole_one
    if spoilt == "texts.toml":
        file.write_text(text[: len(text) // 2].rsplit("=", 1)[0], "utf-8")
        assert watched.now() is whole_one
    file.write_text(text + "\n", "utf-8")
    assert watched.now().stamp != whole_one.stamp


@pytest.mark.parametrize("identity", ["contents", "exhibits", "contents-title", "chest-title"])
def test_no_exhibits_name_is_taken_by_the_catalogue_itself(tmp_path: Path, identity: str):
    folder = make_house(tmp_path / "content")
    shutil.copytree(folder / "exhibits/chest", folder / "exhibits" / identity)
    content = load(folder)
    assert {exhibit.id for exhibit in content.exhibits} >= {identity, "chest"}
    page = Outline(catalogue_html(content, content.exhibits, {}, "en"))
    assert len(page.ids) == len(set(page.ids))
    assert all(link[1:] in page.ids for link in page.links if link.startswith("#"))
