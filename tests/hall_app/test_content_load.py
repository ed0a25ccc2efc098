"""Loading: good folders, every kind of bad input with its own line, path traversal, lookup of the folder."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from content_house import EXHIBIT, add_exhibit, dressed, edit, make_house, write_outfit

from hall_app.content import ContentError, content_folder, load
from hall_app.content.bakes import bake_key, key_now


@pytest.fixture
def house(tmp_path: Path) -> Path:
    return make_house(tmp_path / "assets")


def only_line(folder: Path) -> str:
    content = load(folder)
    assert [exhibit.id for exhibit in content.exhibits] == [], "the faulty exhibit is left out"
    assert len(content.problems) == 1, [str(problem) for problem in content.problems]
    return str(content.problems[0])


def test_good_folder_has_no_problem(house: Path):
    content = load(house)
    assert [exhibit.id for exhibit in content.exhibits] == ["chest"]
    assert content.problems == ()
    assert content.exhibits[0].text_en == "A chest."


CASES: dict[str, tuple[Callable[[Path], object], tuple[str, ...]]] = {
    "unknown key": (
        lambda home: edit(home / "exhibit.toml", "licence", 'capton = "x"\nlicence'),
        ("exhibit.toml: capton: unknown key", "did you mean caption"),
    ),
    "unknown key in a table": (
        lambda home: edit(home / "exhibit.toml", "radius", "radus = 1\nradius"),
        ("body.radus: unknown key", "did you mean radius"),
    ),
    "unknown key in the first medium": (
        lambda home: edit(home / "exhibit.toml", 'kind = "picture"', 'kind = "picture"\nqqq = 1'),
        ("media[1].qqq: unknown key", "known keys are kind, file"),
    ),
    "wrong number": (
        lambda home: edit(home / "exhibit.toml", "x = 0.0", 'x = "3,2m"'),
        ("place.x: ", "(got '3,2m')", "write a number"),
    ),
    "not a number": (
        lambda home: edit(home / "exhibit.toml", "x = 0.0", "x = nan"),
        ("place.x: ", "finite", "write an ordinary number"),
    ),
    "missing key": (
        lambda home: edit(home / "exhibit.toml", 'licence = "CC0-1.0"', ""),
        ("exhibit.toml: licence: missing", "add licence"),
    ),
    "missing language": (
        lambda home: edit(home / "exhibit.toml", ', en = "The front"', ""),
        ("media[1].alt.en: missing", "add en"),
    ),
    "empty language": (
        lambda home: edit(home / "exhibit.toml", 'en = "Chest"', 'en = " "'),
        ("title.en: the text is empty", "both languages"),
    ),
    "unknown behaviour": (
        lambda home: edit(home / "exhibit.toml", '"glow_when_near"', '"fly"'),
        ("behaviours[2]: no such behaviour", "glow_when_near", "correct its spelling"),
    ),
    "not TOML": (
        lambda home: edit(home / "exhibit.toml", 'licence = "CC0-1.0"', "licence = CC0"),
        ("exhibit.toml: not TOML", "line 4", "quotation marks"),
    ),
    "not UTF-8": (
        lambda home: (home / "exhibit.toml").write_bytes(EXHIBIT.encode("gb18030")),
        ("exhibit.toml: not UTF-8", "save the file"),
    ),
    "empty exhibit.toml": (
        lambda home: (home / "exhibit.toml").write_bytes(b""),
        ("exhibits/chest/exhibit.toml: the file is empty", "write it anew"),
    ),
    "missing exhibit.toml": (
        lambda home: (home / "exhibit.toml").unlink(),
        ("exhibits/chest/exhibit.toml: missing file", "add it"),
    ),
    "missing picture": (
        lambda home: (home / "media/front.jpg").unlink(),
        ("media[1].file: missing file media/front.jpg", "add exhibits/chest/media/front.jpg"),
    ),
    "empty picture": (
        lambda home: (home / "media/front.jpg").write_bytes(b""),
        ("media[1].file: media/front.jpg is empty (0 bytes)", "replace it"),
    ),
    "missing text": (
        lambda home: (home / "text.zh.md").unlink(),
        ("exhibits/chest/text.zh.md: missing text", "both languages"),
    ),
    "blank text": (
        lambda home: (home / "text.en.md").write_text("\n"),
        ("exhibits/chest/text.en.md: the text is empty", "both languages"),
    ),
    "broken GLB": (
        lambda home: (home / "media/chest.glb").write_bytes((home / "media/chest.glb").read_bytes()[:300]),
        ("models.hall: chest.glb: the GLB is broken or cut off", "export it again"),
    ),
    "not a GLB": (
        lambda home: (home / "media/chest.glb").write_bytes(b"solid chest\nendsolid\n" * 9),
        ("models.hall: chest.glb: not a GLB file", "binary glTF"),
    ),
    "unknown booth": (
        lambda home: edit(home / "exhibit.toml", "z = -1.0", 'z = -1.0\non = "table"'),
        ("place.on: plan.toml has no solid 'table'", "booth"),
    ),
    "outside the hall": (
        lambda home: edit(home / "exhibit.toml", "x = 0.0", "x = 5.2"),
        ("place: outside the hall's outline", "change place.x"),
    ),
    "inside a wall": (
        lambda home: edit(home / "exhibit.toml", "z = -1.0", "z = -2.8"),
        ("place: stands inside wall 'wall-1'", "move it"),
    ),
    "inside a booth": (
        lambda home: edit(home / "exhibit.toml", "x = 0.0\nz = -1.0", "x = -3.0\nz = 0.0"),
        ("place: stands inside booth 'booth'", 'place.on = "booth"'),
    ),
    "where visitors begin": (
        lambda home: edit(home / "exhibit.toml", "z = -1.0", "z = 3.3"),
        ("place: stands where visitors begin", "move it"),
    ),
    "two models": (
        lambda home: edit(home / "exhibit.toml", "licence", 'outfit = "outfits/o.toml"\nlicence'),
        ("exhibit.toml: needs one of outfit, scan and [models]", "keep one"),
    ),
    "nothing to show": (
        lambda home: edit(home / "exhibit.toml", '[models]\nhall = "media/chest.glb"', ""),
        ("exhibit.toml: needs one of outfit, scan and [models]", "keep one"),
    ),
    "a ready-made model that is shown": (
        lambda home: edit(home / "exhibit.toml", "[body]", "[show]\nnearest = 2.0\n[body]"),
        ("exhibit.toml: [show] is for an outfit", "remove it"),
    ),
    "the table of before": (
        lambda home: edit(
            home / "exhibit.toml",
            '[models]\nhall = "media/chest.glb"',
            '[garment]\npattern = "patterns/p.toml"\nweave = "weaves/w.toml"\nrecipe = "x"\nnearest = 2.0',
        ),
        ("exhibit.toml: garment: no longer a table", 'write outfit = "outfits/….toml"', "below [show]"),
    ),
    "body without a size": (
        lambda home: edit(home / "exhibit.toml", 'shape = "round"', 'shape = "box"'),
        ("body: a round body has a radius, a box body a size", "size = [width, depth]"),
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_bad_exhibit_is_left_out_with_one_clear_line(house: Path, case: str):
    spoil, words = CASES[case]
    spoil(house / "exhibits/chest")
    line = only_line(house)
    assert line.startswith("exhibits/chest/")
    assert "\n" not in line
    assert " – " in line, "names the remedy"
    for word in words:
        assert word in line


@pytest.mark.parametrize(
    "path",
    [
        "../../hall.toml",
        "/etc/passwd",
        "media/../../../x.jpg",
        "C:/x.jpg",
        "..\\x.jpg",
        "media\\x.jpg",
        ".",
        "",
    ],
)
def test_paths_stay_inside_the_folder(house: Path, path: str):
    edit(house / "exhibits/chest/exhibit.toml", '"media/front.jpg"', f"'{path}'")
    line = only_line(house)
    assert "media[1].file: the path leaves the content folder" in line
    assert "copy the file into the folder" in line


def test_link_that_leaves_the_folder_is_refused(house: Path, tmp_path: Path):
    secret = tmp_path / "secret.jpg"
    secret.write_bytes(b"secret")
    picture = house / "exhibits/chest/media/front.jpg"
    picture.unlink()
    os.symlink(secret, picture)
    assert "is a link that leaves the content folder – copy the file itself" in only_line(house)


@pytest.mark.parametrize("name", ["outfits/scarf.toml", "patterns/pibo.toml"])
def test_zero_byte_input(house: Path, name: str):
    dressed(house)
    (house / name).write_bytes(b"")
    key = (
        "exhibits/chest/exhibit.toml: outfit" if "outfits" in name else "outfits/scarf.toml: layer.1.pattern"
    )
    assert only_line(house) == f"{key}: {name} is empty (0 bytes) – replace it by the whole file"


def test_a_bake_depends_on_the_outfit_all_it_names_and_how_it_is_shown(house: Path):
    dressed(house)
    toml = house / "exhibits/chest/exhibit.toml"

    def key() -> str:
        content = load(house)
        (exhibit,) = content.exhibits
        return bake_key(content, exhibit)

    keys = [key()]
    edit(toml, "Chest", "Dress")
    assert key() == keys[0], "what is written of it is no matter of its bake"
    write_outfit(house, more='weaves = { cloth = "weaves/juan.toml" }')
    (house / "weaves/juan.toml").write_text("one", "utf-8")
    keys.append(key())
    for name in ("weaves/juan.toml", "weaves/gauze.toml", "patterns/pibo.toml", "outfits/scarf.toml"):
        path = house / name
        path.write_text(path.read_text("utf-8") + "\n# changed\n", "utf-8")
        keys.append(key())
    motifs = house / "motifs"
    motifs.mkdir()
    (house / "weaves/juan.toml").write_text('[draft]\nmotif = "../motifs/bands.toml"\n', "utf-8")
    (motifs / "bands.toml").write_text('[[part]]\nmotif = "vine.toml"\n', "utf-8")
    keys.append(key())
    for name in ("vine.toml", "vine.toml", "bands.toml"):
        with (motifs / name).open("a", encoding="utf-8") as file:
            file.write("# changed\n")
        keys.append(key())
    (motifs / "vine.toml").write_text('svg = "vine.svg"\n', "utf-8")
    for drawing in ("<svg/>", '<svg width="3mm"/>'):
        keys.append(key())
        (motifs / "vine.svg").write_text(drawing, "utf-8")
    keys.append(key())
    edit(toml, "[body]", "[show]\nnearest = 3.0\n[body]")
    keys.append(key())
    assert len(set(keys)) == len(keys)
    last = load(house)
    (house / "weaves/juan.toml").unlink()
    assert key_now(last, last.exhibits[0]) is None, "of what went away there is none"


def test_name_of_an_exhibit(house: Path):
    add_exhibit(house, "hall")
    add_exhibit(house, "Two Words")
    lines = [str(problem) for problem in load(house).problems]
    assert len(lines) == 2
    assert all("cannot be the name of an exhibit – rename the folder" in line for line in lines)


def test_all_faults_of_an_exhibit_at_once(house: Path):
    home = house / "exhibits/chest"
    edit(home / "exhibit.toml", "licence", "licens")
    (home / "text.en.md").unlink()
    files = {(problem.file, problem.key) for problem in load(house).problems}
    toml = "exhibits/chest/exhibit.toml"
    assert files == {(toml, "licens"), (toml, "licence"), ("exhibits/chest/text.en.md", "")}


@pytest.mark.parametrize("name", ["hall.toml", "plan.toml"])
def test_without_hall_or_plan_nothing_opens(house: Path, name: str):
    (house / name).unlink()
    with pytest.raises(ContentError, match=f"^{name}: missing file – add it"):
        load(house)


HOUSE_CASES = {
    "crossing outline": (
        "plan.toml",
        "outline = [[-5, -5], [5, -5], [5, 5], [-5, 5]]",
        "outline = [[-5, -5], [5, 5], [5, -5], [-5, 5]]",
        r"^plan\.toml: outline: the outline crosses itself at x = 0\.00, z = 0\.00 – list the corners in order",
    ),
    "no floor": (
        "plan.toml",
        "outline = [[-5, -5], [5, -5], [5, 5], [-5, 5]]",
        "outline = [[-5, -5], [5, -5], [0, -5]]",
        r"^plan\.toml: outline: the outline .* – list the corners",
    ),
    "id twice": (
        "plan.toml",
        'id = "post"',
        'id = "booth"',
        r"^plan\.toml: solid\[1\]\.id: the id 'booth' is given 2 times – rename",
    ),
    "two footprints": (
        "plan.toml",
        "at = [-3, 0]",
        "at = [-3, 0]\nround = {x = 0, z = 0, radius = 1}",
        r"^plan\.toml: solid\[1\]: needs exactly one of: polygon, size with at, round – keep one",
    ),
    "solid outside": (
        "plan.toml",
        "at = [-3, 0]",
        "at = [-8, 0]",
        r"^plan\.toml: solid\[1\]: 'booth' stands outside the outline – move it",
    ),
    "start in a wall": (
        "hall.toml",
        "z = 3.0",
        "z = -3.0",
        r"^hall\.toml: start: a visitor would begin inside wall 'wall-1' – move start\.x",
    ),
    "start outside": (
        "hall.toml",
        "z = 3.0",
        "z = 30.0",
        r"^hall\.toml: start: a visitor would begin outside the outline – move",
    ),
    "missing music": (
        "hall.toml",
        "licence",
        'music = ["media/song.mp3"]\nlicence',
        r"^hall\.toml: music\[1\]: missing file media/song\.mp3 – add media/song\.mp3",
    ),
}


@pytest.mark.parametrize("case", HOUSE_CASES)
def test_bad_house(house: Path, case: str):
    name, old, new, line = HOUSE_CASES[case]
    edit(house / name, old, new)
    with pytest.raises(ContentError, match=line):
        load(house)


def test_lookup_of_the_folder(house: Path, tmp_path: Path):
    assert content_folder(house, here=tmp_path / "x") == house.resolve()
    assert content_folder(here=house.parent) == house.resolve()
    packaged = content_folder(here=tmp_path / "elsewhere")
    assert (packaged / "hall.toml").is_file()
    with pytest.raises(ContentError, match="no such folder – give --content"):
        content_folder(tmp_path / "none")


def test_half_a_folder_is_still_found_so_that_loading_can_say_what_is_missing(house: Path):
    (house / "hall.toml").unlink()
    assert content_folder(here=house.parent) == house.resolve()


def test_a_key_asked_for_again_parses_nothing_that_is_as_it_was(house: Path, monkeypatch: pytest.MonkeyPatch):
    """An open hall asks every second."""
    dressed(house)
    content = load(house)
    (exhibit,) = content.exhibits
    before = bake_key(content, exhibit)
    parsed, loads = [], tomllib.loads
    monkeypatch.setattr(tomllib, "loads", lambda text: parsed.append(text) or loads(text))
    assert bake_key(content, exhibit) == before
    assert parsed == []
    weave = house / "weaves/gauze.toml"
    weave.write_text(weave.read_text("utf-8") + "\n# another\n", "utf-8")
    assert bake_key(content, exhibit) != before
    assert len(parsed) == 1
