"""`hall check`: what loading cannot see, and the command around it."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from content_house import add_exhibit, dressed, edit, make_house, rewritten, write_box
from full_matrix import by_day

from hall_app.check import check
from hall_app.cli import main
from hall_app.content import load
from hall_app.content.models import GlbError, read_glb

ASSETS = Path(__file__).parents[2] / "assets"


@pytest.fixture
def house(tmp_path: Path) -> Path:
    return make_house(tmp_path / "assets")


def lines(folder: Path) -> list[str]:
    return [str(problem) for problem in check(folder)]


def test_good_folder(house: Path):
    assert lines(house) == []


def toml(house: Path) -> Path:
    return house / "exhibits/chest/exhibit.toml"


def replaced(house: Path, kind: str, name: str, data: bytes) -> None:
    """Put another medium in place of the chest's picture."""
    edit(toml(house), 'kind = "picture"\nfile = "media/front.jpg"', f'kind = "{kind}"\nfile = "media/{name}"')
    (house / "exhibits/chest/media/front.jpg").unlink()
    (house / "exhibits/chest/media" / name).write_bytes(data)


def close_the_back(house: Path) -> None:
    """A wall right across: what stands behind it cannot be reached."""
    edit(house / "plan.toml", "to = [1, -3]", "to = [5, -3]")
    edit(toml(house), "z = -1.0", "z = -4.2")


CASES: dict[str, tuple[Callable[[Path], object], str, str, str]] = {
    "behind a wall": (
        close_the_back,
        "exhibits/chest/exhibit.toml: place: ",
        "cannot be reached on foot",
        "open a way",
    ),
    "face to the wall": (
        lambda house: edit(toml(house), "x = 0.0\nz = -1.0", "x = -2.0\nz = -2.45\nfacing = 180"),
        "exhibits/chest/exhibit.toml: place.facing: ",
        "reached only from behind",
        "turn its front",
    ),
    "picture without words": (
        lambda house: edit(toml(house), 'alt = { zh = "正面", en = "The front" }', ""),
        "exhibits/chest/exhibit.toml: media[1].alt: ",
        "no description",
        "add alt =",
    ),
    "audio without transcript": (
        lambda house: replaced(house, "audio", "front.wav", b"RIFF\0\0\0\0WAVEfmt "),
        "exhibits/chest/exhibit.toml: media[1].transcript: ",
        "no transcript",
        "add transcript =",
    ),
    "video without words": (
        lambda house: (
            replaced(house, "video", "front.mp4", b"\0\0\0\x20ftypisom"),
            edit(toml(house), "alt =", "caption ="),
        ),
        "exhibits/chest/exhibit.toml: media[1].alt: ",
        "neither description nor transcript",
        "add alt =",
    ),
    "in centimetres": (
        lambda house: write_box(house / "exhibits/chest/media/chest.glb", scale=100),
        "exhibits/chest/exhibit.toml: models.hall: ",
        "80 m high, expected 0.3 to 3 m",
        "in metres",
    ),
    "too small": (
        lambda house: write_box(house / "exhibits/chest/media/chest.glb", height=0.1),
        "exhibits/chest/exhibit.toml: models.hall: ",
        "0.1 m high",
        "size_range",
    ),
    "floating": (
        lambda house: write_box(house / "exhibits/chest/media/chest.glb", foot=0.5),
        "exhibits/chest/exhibit.toml: models.hall: ",
        "lowest point is at y = 0.50 m",
        "foot at y = 0",
    ),
    "sunken": (
        lambda house: write_box(house / "exhibits/chest/media/chest.glb", foot=-0.5),
        "exhibits/chest/exhibit.toml: models.hall: ",
        "lowest point is at y = -0.50 m",
        "foot at y = 0",
    ),
    "unused file": (
        lambda house: (house / "exhibits/chest/media/old.jpg").write_bytes(b"x"),
        "exhibits/chest/media/old.jpg: ",
        "not used",
        "name it in exhibit.toml, or remove it",
    ),
    "script in a text": (
        lambda house: (house / "exhibits/chest/text.en.md").write_text("A <script>alert(1)</script> chest."),
        "exhibits/chest/text.en.md: ",
        "HTML is not read, <script> is shown as letters",
        "use Markdown",
    ),
    "foreign picture in a text": (
        lambda house: (house / "exhibits/chest/text.en.md").write_text("![x](https://example.org/x.jpg)"),
        "exhibits/chest/text.en.md: ",
        "https://example.org/x.jpg is not in the exhibit's folder",
        "copy it to media/",
    ),
    "too large a file": (
        lambda house: (house / "big.bin").write_bytes(bytes(10_000_001)),
        "big.bin: ",
        "10.0 MB, at most 10 MB",
        "make it smaller",
    ),
}


@pytest.mark.parametrize("case", by_day([*CASES][::4], CASES))
def test_each_fault_has_its_own_line(house: Path, case: str):
    spoil, where, what, fix = CASES[case]
    spoil(house)
    found = lines(house)
    assert len(found) == 1, found
    assert found[0].startswith(where)
    assert what in found[0]
    assert fix in found[0].partition(" – ")[2]


def test_too_large_a_folder(house: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("hall_app.check.files.budget.FOLDER", 60_000_000)
    for number in range(7):
        (house / f"{number}.bin").write_bytes(bytes(9_000_000))
    assert lines(house) == [".: the folder has 63.0 MB, at most 60 MB – remove or shrink the largest files"]


def test_too_many_triangles(house: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("hall_app.check.files.budget.TRIANGLES", {"hall": 11, "close": 12})
    (line,) = lines(house)
    assert "models.hall: 12 triangles, at most 11 – reduce the mesh" in line


@pytest.mark.parametrize(
    "extension", ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu"]
)
def test_compressed_models_are_refused(house: Path, extension: str):
    rewritten(house, lambda document: document.update(extensionsUsed=[extension]))
    (line,) = lines(house)
    assert f"models.hall: chest.glb: uses {extension}" in line
    assert "export it again without compression" in line


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda d: d["buffers"][0].update(uri="chest.bin"), "refers to another file"),
        (lambda d: d["meshes"][0]["primitives"][0]["attributes"].pop("POSITION"), "inconsistent"),
        (lambda d: d.update(nodes=[]), "holds no triangles"),
        (lambda d: d["accessors"].clear(), "inconsistent"),
    ],
)
def test_inconsistent_models(house: Path, change: Callable[[dict], None], what: str):
    rewritten(house, change)
    with pytest.raises(GlbError, match=what):
        read_glb(house / "exhibits/chest/media/chest.glb")
    assert len(lines(house)) == 1


def test_bounds_follow_the_nodes(house: Path):
    half_turn = {
        "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476],
        "translation": [1, 0, 0],
        "scale": [2, 1, 1],
    }

    def move(document: dict) -> None:
        shown = next(node for node in document["nodes"] if "mesh" in node)
        shown.pop("matrix", None)
        shown.update(half_turn)

    rewritten(house, move)
    info = read_glb(house / "exhibits/chest/media/chest.glb")
    assert info.triangles == 12
    assert info.low == pytest.approx((0.75, 0, -0.5))
    assert info.high == pytest.approx((1.25, 0.8, 0.5))


def test_bounds_follow_a_matrix_in_columns(house: Path):
    """A quarter turn about y (x to -z, z to x), twice as high, moved by (1, 2, 3): glTF writes columns."""

    def move(document: dict) -> None:
        shown = next(node for node in document["nodes"] if "mesh" in node)
        for name in ("rotation", "translation", "scale"):
            shown.pop(name, None)
        shown["matrix"] = [0, 0, -1, 0, 0, 2, 0, 0, 1, 0, 0, 0, 1, 2, 3, 1]

    before = read_glb(house / "exhibits/chest/media/chest.glb")
    info = read_glb(rewritten(house, move))
    assert before.high == pytest.approx((0.25, 0.8, 0.25))
    assert info.low == pytest.approx((0.75, 2.0, 2.75))
    assert info.high == pytest.approx((1.25, 3.6, 3.25))


def test_a_model_whose_last_bytes_are_missing(house: Path):
    """Its JSON part is whole, so only the length in its head tells."""
    path = house / "exhibits/chest/media/chest.glb"
    whole = path.read_bytes()
    path.write_bytes(whole[:-4])
    with pytest.raises(GlbError, match=f"broken or cut off: {len(whole) - 4} bytes of {len(whole)}"):
        read_glb(path)


def test_bodies_that_overlap(house: Path):
    home = add_exhibit(house, "second")
    edit(home / "exhibit.toml", "x = 0.0", "x = 0.6")
    (line,) = lines(house)
    assert line.startswith("exhibits/chest/exhibit.toml: body: its body overlaps that of exhibit 'second'")
    assert "move one of them" in line


def test_on_a_booth_and_low_things_hide_nothing(house: Path):
    edit(toml(house), "x = 0.0\nz = -1.0", 'x = -3.0\nz = 0.0\nfacing = 90\non = "booth"')
    assert lines(house) == []


def test_exhibits_are_looked_at_without_a_plan(house: Path):
    (house / "plan.toml").unlink()
    edit(toml(house), "licence", "licens")
    found = lines(house)
    assert found[0].startswith("plan.toml: missing file")
    assert any("licens: unknown key – did you mean licence?" in line for line in found)


def test_stale_and_missing_bakes(house: Path):
    home = add_exhibit(house, "scarf")
    outfit = dressed(house, "scarf")
    edit(home / "exhibit.toml", "x = 0.0", "x = 2.0")
    assert lines(house) == [
        "exhibits/scarf/exhibit.toml: outfit: has not been baked – run: hall build --exhibit scarf"
    ]
    (home / "baked").mkdir()
    (home / "baked/bake.json").write_text('{"key": "of long ago"}')
    assert "its bake is stale" in lines(house)[0]
    edit(house / "patterns/pibo.toml", "size = [0.4, 2.4]", "size = [0.4, -2.4]")
    (line,) = lines(house)
    assert line.startswith("patterns/pibo.toml: ")
    outfit.write_text("x", "utf-8")
    assert any(line.startswith("outfits/scarf.toml: not TOML") for line in lines(house))


def run(*words: str) -> int:
    return main(["check", *words])


def test_command(house: Path, capsys: pytest.CaptureFixture[str]):
    assert run(str(house)) == 0
    assert capsys.readouterr().out == f"{house.resolve()}: 0 problems\n"
    edit(toml(house), "licence", "licens")
    assert run(str(house)) == 1
    written = capsys.readouterr().out.splitlines()
    assert len(written) == 3
    assert written[-1].endswith(": 2 problems")


def test_what_is_not_stated_yet_is_a_hint_and_no_failure(house: Path, capsys: pytest.CaptureFixture[str]):
    (house / "questionnaires").mkdir(exist_ok=True)
    shutil.copy(ASSETS / "questionnaires/garment.toml", house / "questionnaires")
    shutil.copy(ASSETS / "controller.toml", house)
    assert run(str(house)) == 0
    hint, last = capsys.readouterr().out.splitlines()
    assert hint.startswith("hint: controller.toml: controller.name, ")
    assert last.endswith(": 0 problems, 1 hint")
    assert run("--json", str(house)) == 0
    assert [one["file"] for one in json.loads(capsys.readouterr().out)["hints"]] == ["controller.toml"]
    (house / "controller.toml").write_text("[controller]\nphone = '1'\n", "utf-8")
    assert run(str(house)) == 1
    fault, last = capsys.readouterr().out.splitlines()
    assert fault.startswith("controller.toml: controller.phone: unknown key")
    assert last.endswith(": 1 problem")


def test_command_json(house: Path, capsys: pytest.CaptureFixture[str]):
    (house / "hall.toml").unlink()
    assert run("--json", str(house)) == 1
    result = json.loads(capsys.readouterr().out)
    assert result["problems"] == [
        {"file": "hall.toml", "key": "", "what": "missing file", "fix": "add it (its form: README.md)"}
    ]
    assert run(str(house / "nowhere")) == 1
    assert "no such folder" in capsys.readouterr().out


@pytest.mark.door
def test_shipped_content_has_no_problem():
    """The bake of this checkout is judged by the tests of baking: it is not made by every change of the content."""
    found = [problem for problem in check(ASSETS) if problem.key != "outfit"]
    assert [str(problem) for problem in found] == []
    assert {"pibo", "gown", "mirror"} <= {exhibit.id for exhibit in load(ASSETS).exhibits}
