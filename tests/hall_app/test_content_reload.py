"""Edits while the hall is open: a good one shows, a bad one keeps the last good version and is reported."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from content_house import add_exhibit, edit, make_house, write_box

from hall_app.content import Content, ContentError, Watcher, exhibit_json, scene_json


@pytest.fixture
def house(tmp_path: Path) -> Path:
    return make_house(tmp_path / "assets")


def chest(content: Content | None) -> dict:
    assert content is not None
    shown = exhibit_json(content, "chest")
    assert shown is not None
    return shown


def test_nothing_changed(house: Path):
    assert Watcher(house).poll() is None


def test_text_picture_and_model_change(house: Path):
    watcher = Watcher(house)
    before = watcher.content
    shown = chest(before)
    (house / "exhibits/chest/text.en.md").write_text("A *new* text.")
    after = watcher.poll()
    assert after is not None
    assert after.revision != before.revision
    assert "<em>new</em>" in chest(after)["text"]["en"]
    (house / "exhibits/chest/media/front.jpg").write_bytes(b"another picture")
    now = chest(watcher.poll())
    assert now["media"][0]["sources"][0]["url"] != shown["media"][0]["sources"][0]["url"]
    write_box(house / "exhibits/chest/media/chest.glb", height=1.1)
    changed = watcher.poll()
    assert changed is not None
    assert changed.problems == ()
    assert watcher.poll() is None


def test_bad_edit_keeps_the_last_good_version(house: Path):
    watcher = Watcher(house)
    toml = house / "exhibits/chest/exhibit.toml"
    edit(toml, 'en = "Chest"', "en = Chest")
    content = watcher.poll()
    assert content is not None
    assert content.exhibits[0].file.title.en == "Chest"
    assert "not TOML" in str(content.problems[0])
    edit(toml, "en = Chest", 'en = "Coffer"')
    content = watcher.poll()
    assert content is not None
    assert content.exhibits[0].file.title.en == "Coffer"
    assert content.problems == ()


def test_bad_edit_of_the_house_keeps_hall_and_plan(house: Path):
    watcher = Watcher(house)
    good = scene_json(watcher.content)
    edit(house / "plan.toml", "outline = [[-5, -5], [5, -5]", "outline = [[-5, -5], [-5, 5]")
    content = watcher.poll()
    assert content is not None
    assert scene_json(content)["outline"] == good["outline"]
    assert [exhibit.id for exhibit in content.exhibits] == ["chest"]
    assert content.problems[0].file == "plan.toml"


def test_exhibits_come_and_go(house: Path):
    watcher = Watcher(house)
    home = add_exhibit(house, "other")
    edit(home / "exhibit.toml", "x = 0.0", "x = 2.0")
    content = watcher.poll()
    assert content is not None
    assert [exhibit.id for exhibit in content.exhibits] == ["chest", "other"]
    shutil.rmtree(house / "exhibits/chest")
    content = watcher.poll()
    assert content is not None
    assert [exhibit.id for exhibit in content.exhibits] == ["other"]


def test_editors_temporary_files_are_no_change(house: Path):
    watcher = Watcher(house)
    (house / "exhibits/chest/.text.en.md.swp").write_text("x")
    (house / "exhibits/chest/text.en.md~").write_text("x")
    assert watcher.poll() is None


def test_no_good_content_to_begin_with(house: Path):
    (house / "plan.toml").write_text("")
    with pytest.raises(ContentError, match=r"^plan\.toml: the file is empty"):
        Watcher(house)
