"""`hall check`: openings, lanterns, curtains and signs that no wall, column or ceiling holds; mannequins' licence."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from content_house import edit, make_house
from full_matrix import by_day

from hall_app.check import check
from hall_app.check import folder as checking
from hall_app.check.hall import fitting_problems
from hall_app.content import load
from hall_app.room import raise_room

ASSETS = Path(__file__).parents[2] / "assets"

# The wall of the small house stands at z = -3 from x = -5 to 1, 4.3 m high.
PIECES = {
    "window": '[[opening]]\nkind = "window"\nfrom = [-4, -3]\nto = [-2, -3]\nsill = 1.0\nheight = 1.5\n',
    "door": '[[opening]]\nkind = "door"\nfrom = [-4, -3]\nto = [-2.5, -3]\nheight = 2.4\n',
    "lantern": "[[lantern]]\nat = [1, 1]\nheight = 3.0\n",
    "laylight": "[[laylight]]\nat = [0, 0]\nsize = [3, 3]\n",
    "curtain": "[[curtain]]\nfrom = [3, 0]\nto = [5, 0]\n",
    "sign": '[[sign]]\nkind = "plaque"\nat = [-2, -2.9]\nheight = 3.0\nsize = [1.2, 0.5]\n',
    "low wall": "[[wall]]\nfrom = [2, 2]\nto = [4, 2]\nheight = 2.0\n\n"
    '[[sign]]\nkind = "banner"\nat = [3, 2.1]\nheight = 0.9\nsize = [0.3, 1.4]\n',
    "gap": "[[wall]]\nfrom = [1, -3]\nto = [4, -3]\n\n"
    '[[sign]]\nkind = "plaque"\nat = [1.5, -2.9]\nheight = 3.0\nsize = [1.4, 0.5]\n',
    "window and sign": '[[opening]]\nkind = "window"\nfrom = [-4, -3]\nto = [-2, -3]\nsill = 1.0\nheight = 1.5\n\n'
    '[[sign]]\nkind = "plaque"\nat = [-3, -2.9]\nheight = 3.0\nsize = [1.2, 0.5]\n',
    "two signs": '[[sign]]\nkind = "plaque"\nat = [-2, -2.9]\nheight = 3.0\nsize = [1.2, 0.5]\n\n'
    '[[sign]]\nkind = "banner"\nat = [-0.6, -2.9]\nheight = 2.2\nsize = [0.4, 1.4]\n',
}
FAULTS = {
    "longer than its wall": ("window", "from = [-4, -3]\nto = [-2, -3]", "from = [-9, -3]\nto = [9, -3]", "opening[1]",
                             "the window of 18.00 m reaches beyond its wall of 6.00 m"),
    "off the end of its wall": ("window", "to = [-2, -3]", "to = [2, -3]", "opening[1]", "reaches beyond its wall"),
    "higher than its wall": ("window", "height = 1.5", "height = 9.9", "opening[1]",
                             "the window reaches up to 10.90 m, its wall to 4.30 m"),
    "above its wall": ("window", "sill = 1.0", "sill = 4.5", "opening[1]", "reaches up to 6.00 m"),
    "door in no wall": ("door", "from = [-4, -3]\nto = [-2.5, -3]", "from = [-4, 1]\nto = [-2.5, 1]", "opening[1]",
                        "the door lies in no wall"),
    "door across its wall": ("door", "to = [-2.5, -3]", "to = [-4, -1]", "opening[1]", "the door lies in no wall"),
    "lantern outside": ("lantern", "at = [1, 1]", "at = [-40, 1]", "lantern[1].at", "hangs outside the hall (x = -40"),
    "lantern above": ("lantern", "height = 3.0", "height = 9.0", "lantern[1].height", "above the ceiling of 4.3 m"),
    "paper outside": ("laylight", "at = [0, 0]", "at = [4, 0]", "laylight[1]", "reaches outside the hall"),
    "curtain outside": ("curtain", "from = [3, 0]", "from = [-44, 0]", "curtain[1].from",
                        "at no column and no wall (x = -44"),
    "curtain in the air": ("curtain", "to = [5, 0]", "to = [1, 1]", "curtain[1].to", "at no column and no wall"),
    "sign in the air": ("sign", "at = [-2, -2.9]", "at = [-2, 0]", "sign[1].at", "hangs off its wall"),
    "sign off the end": ("sign", "at = [-2, -2.9]", "at = [0.9, -2.9]", "sign[1].at", "an edge is 0.50 m from any"),
    "sign across its wall": ("sign", "height = 3.0", "facing = 90\nheight = 3.0", "sign[1].at", "off its wall"),
    "sign outside": ("sign", "at = [-2, -2.9]", "at = [-2, -30]", "sign[1].at", "hangs outside the hall"),
    "sign in its wall": ("sign", "at = [-2, -2.9]", "at = [-2, -3]", "sign[1].at", "hidden inside a wall"),
    "sign into its wall": ("sign", "height = 3.0", "facing = 180\nheight = 3.0", "sign[1].at", "hidden inside a wall"),
    "sign on the floor": ("sign", "height = 3.0\nsize = [1.2, 0.5]", "height = 0.5\nsize = [1.2, 1.2]",
                          "sign[1].height",
                          "reaches 0.10 m below the floor"),
    "sign over a low wall": ("low wall", "height = 2.0", "height = 1.2", "sign[1].height",
                             "up to 1.60 m, its wall to 1.20 m"),
    "sign across a gap": ("gap", "from = [1, -3]\nto = [4", "from = [2, -3]\nto = [4", "sign[1].at",
                          "hangs across a gap"),
    "sign before a window": ("window and sign", "height = 3.0", "height = 2.4", "sign[1].at",
                             "hangs before the window"),
    "sign over a sign": ("two signs", "at = [-0.6, -2.9]", "at = [-1.5, -2.9]", "sign[2].at", "hangs over sign[1]"),
    "letters too small": ("sign", "height = 3.0", 'height = 3.0\ntext = "' + 60 * "衣" + '"', "sign[1].text",
                          "its 60 letters would be 16 mm high"),
    "no letter": ("sign", "height = 3.0", 'height = 3.0\ntext = "衣\U0001f458"', "sign[1].text", "cannot be drawn"),
    "sign too high": ("sign", "height = 3.0", "height = 4.2", "sign[1].height", "up to 4.45 m, the ceiling is at 4.3"),
}  # fmt: skip


def with_piece(folder: Path, piece: str) -> Path:
    house = make_house(folder / "house")
    with (house / "plan.toml").open("a", encoding="utf-8") as plan:
        plan.write(PIECES[piece])
    return house


@pytest.mark.parametrize("piece", PIECES)
def test_what_is_held_is_no_problem(piece: str, tmp_path: Path):
    assert check(with_piece(tmp_path, piece)) == []


@pytest.mark.parametrize("fault", by_day([*FAULTS][::4], FAULTS))
def test_what_nothing_holds_is_one_line(fault: str, tmp_path: Path):
    piece, old, new, key, what = FAULTS[fault]
    house = with_piece(tmp_path, piece)
    edit(house / "plan.toml", old, new)
    (problem,) = check(house)
    assert (problem.file, problem.key) == ("plan.toml", key)
    assert what in problem.what
    assert problem.fix


def test_what_passes_is_drawn_and_what_does_not_is_left_out(tmp_path: Path):
    """The check judges as the room's geometry does: a window it passes has paper, one it refuses has none."""
    house = with_piece(tmp_path, "window")

    def paper() -> bool:
        content = load(house)
        room = raise_room(content.plan, content.hall.title, (), blank=True)
        return any(patch.material == "paper" for patch in room.patches)

    assert paper()
    edit(house / "plan.toml", "from = [-4, -3]\nto = [-2, -3]", "from = [-4, 1]\nto = [-2, 1]")
    assert fitting_problems(load(house))
    assert not paper()


def test_high_windows_over_an_arcade_are_held(tmp_path: Path):
    house = with_piece(tmp_path, "window")
    edit(house / "plan.toml", 'id = "all"', 'id = "all"\nheight = 3.0')
    nave = '[[bay]]\nid = "nave"\nname = { zh = "中", en = "Nave" }\nheight = 5.4\n'
    nave += "polygon = [[-1, -2.8], [2, -2.8], [2, 5], [-1, 5]]\n"
    text = (house / "plan.toml").read_text("utf-8").replace("[[bay]]", nave + "[[bay]]", 1)
    text = text.replace(
        "from = [-4, -3]\nto = [-2, -3]\nsill = 1.0\nheight = 1.5", "from = [-1, 0]\nto = [-1, 2]\nSILL"
    )
    for sill, said in (
        ("sill = 3.5\nheight = 1.0", ""),
        ("sill = 3.5\nheight = 2.5", "up to 6.00 m, its wall to 5.40"),
    ):
        (house / "plan.toml").write_text(text.replace("SILL", sill), "utf-8")
        found = fitting_problems(load(house))
        assert len(found) == bool(said)
        assert all(said in problem.what for problem in found)


def test_the_shipped_plan_is_held():
    assert fitting_problems(load(ASSETS)) == []


# The rest of the folder is looked at whatever one check meets.


def test_a_check_that_fails_is_one_line_and_the_others_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    house = make_house(tmp_path / "house")
    (house / "exhibits/chest/media/old.jpg").write_bytes(b"x")

    def broken_problems(content: object) -> list:
        raise RuntimeError("an unforeseen\nfault")

    monkeypatch.setattr(checking, "CHECKS", (broken_problems, *checking.CHECKS))
    first, second = (str(problem) for problem in check(house))
    assert "broken problems: cannot be checked (an unforeseen fault)" in first
    assert "old.jpg: the file is not used" in second


SPOILT: dict[str, Callable[[bytes], bytes]] = {
    "cut off": lambda data: data[:60_000],
    "no GLB": lambda data: b"x" * len(data),
    "empty": lambda data: b"",
}


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["hall.glb", "close.glb"])
@pytest.mark.parametrize("fault", SPOILT)
def test_a_broken_model_of_a_bake_is_named_and_the_rest_is_checked(name: str, fault: str, tmp_path: Path):
    house = tmp_path / "assets"
    shutil.copytree(ASSETS, house, ignore=shutil.ignore_patterns("room", "mirror", "pibo*", "music.*"))
    for file in ("patterns/pibo.toml", "patterns/pibo-long.toml"):
        shutil.copyfile(ASSETS / file, house / file)
    edit(house / "hall.toml", "music", "# music")
    (house / "exhibits/beizi/media/unused.txt").write_text("x")
    model = house / "exhibits/beizi/baked" / name
    model.write_bytes(SPOILT[fault](model.read_bytes()))
    lines = [str(problem) for problem in check(house) if "0 bytes" not in problem.what]
    assert sum(name in line for line in lines) == 1, lines
    (line,) = [line for line in lines if name in line]
    assert line.startswith("exhibits/beizi/exhibit.toml: outfit: ")
    assert line.endswith("run: hall build --exhibit beizi")
    assert any("unused.txt" in line for line in lines)


# Mannequins.


@pytest.fixture
def figured(tmp_path: Path) -> Path:
    house = make_house(tmp_path / "house")
    others = shutil.ignore_patterns("woman-*", "man-*")
    shutil.copytree(ASSETS / "mannequins", house / "mannequins", ignore=others)
    assert check(house) == []
    return house


@pytest.mark.parametrize(
    ("spoil", "what"),
    [
        (lambda readme: readme.unlink(), "missing file: nothing says whence woman.npz may be shown"),
        (lambda readme: readme.write_text("woman.npz: a figure."), "names no licence"),
        (lambda readme: readme.write_text("A figure, CC0."), "does not name woman.npz"),
        (lambda readme: readme.write_bytes(b"\xff\xfe\x00"), "cannot be read"),
    ],
)
def test_a_figure_without_its_licence(spoil: Callable[[Path], object], what: str, figured: Path):
    spoil(figured / "mannequins/README.md")
    (problem,) = check(figured)
    assert problem.file == "mannequins/README.md"
    assert what in problem.what
