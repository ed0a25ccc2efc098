"""Odd files: each is one line that names it, and the rest of the hall stays as it is."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest
from content_house import add_exhibit, dressed, edit, make_house, png_of, rewritten, with_texture
from full_matrix import by_day

from hall_app.check import check
from hall_app.content import ContentError, Watcher, exhibit_json, load
from hall_app.content.models import GlbError, read_glb

LONG = "x" * 300
DEEP = "deep = " + "[" * 5000 + "]" * 5000
DIGITS = "digits = " + "9" * 5000


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """A hall of two exhibits: what befalls one must leave the other."""
    folder = make_house(tmp_path / "assets")
    home = add_exhibit(folder, "other")
    edit(home / "exhibit.toml", "x = 0.0", "x = 2.0")
    return folder


def toml(house: Path) -> Path:
    return house / "exhibits/chest/exhibit.toml"


def only(folder: Path) -> str:
    """The one line of `hall check`."""
    found = [str(problem) for problem in check(folder)]
    assert len(found) == 1, found
    assert "\n" not in found[0]
    assert len(found[0]) < 500
    assert " – " in found[0], "names the remedy"
    return found[0]


def left_out(folder: Path) -> str:
    """The one line about the chest, which is left out; the other exhibit stays."""
    assert [exhibit.id for exhibit in load(folder).exhibits] == ["other"]
    line = only(folder)
    assert line.startswith("exhibits/chest/")
    return line


def first_accessor(document: dict) -> dict:
    return document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]


def loop(document: dict) -> None:
    document["nodes"] = [{"children": [1]}, {"children": [0], "mesh": 0}]
    document["scenes"] = [{"nodes": [0]}]


def claim(change: dict, view: dict | None = None) -> Callable[[dict], None]:
    """The corners' accessor, and perhaps its view, told of otherwise; a key of None is left out."""

    def told(document: dict) -> None:
        accessor = first_accessor(document)
        document["bufferViews"][accessor["bufferView"]].update(view or {})
        for key, value in change.items():
            accessor.pop(key, None) if value is None else accessor.update({key: value})

    return told


def sparse(count: int, named: int = 1, **values: int) -> dict:
    told = {"indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 0, **values}}
    return {"bufferView": None, "count": count, "sparse": {"count": named, **told}}


def many_shapes(document: dict) -> None:
    """A hundred meshes of the same corners, none of them shown."""
    first_accessor(document).update(sparse(800_000))
    first_accessor(document).pop("bufferView")
    document["meshes"] += [document["meshes"][0]] * 100


CLAIMS: dict[str, tuple[Callable[[dict], object], str]] = {
    "more than its view holds": (claim({"count": 30_000_000}), "claims more than"),
    "begun beyond its view": (claim({"byteOffset": 100_000}), "claims more than"),
    "rows that overlap": (claim({}, {"byteStride": 1}), "inconsistent"),
    "a view beyond the file": (claim({}, {"byteLength": 10**9}), "inconsistent"),
    "a view begun before the file": (claim({}, {"byteOffset": -4}), "inconsistent"),
    "a count that is no number": (claim({"count": True}), "inconsistent"),
    "corners nobody gives": (claim({"bufferView": None}), "holds nothing"),
    "zeros without end": (claim(sparse(30_000_000)), "claims more than"),
    "more changed than there is": (claim(sparse(8, named=9)), "claims more than"),
    "changes beyond their view": (claim(sparse(1, byteOffset=90_000)), "claims more than"),
    "the same again and again": (many_shapes, "MB of memory to read"),
}
MODELS: dict[str, tuple[Callable[[dict], object], str]] = {
    "extensions null": (lambda d: d.update(extensionsUsed=None), "inconsistent"),
    "extensions a number": (lambda d: d.update(extensionsUsed=5), "inconsistent"),
    "extensions nested": (lambda d: d.update(extensionsUsed=[[1]]), "inconsistent"),
    "required extensions a number": (lambda d: d.update(extensionsRequired=7), "inconsistent"),
    "only required": (
        lambda d: d.update(extensionsRequired=["KHR_draco_mesh_compression"]),
        "uses KHR_draco",
    ),
    "huge count": (lambda d: [a.update(count=10**400) for a in d["accessors"]], "inconsistent"),
    "huge corner": (lambda d: first_accessor(d).update(min=[10**400, 0, 0]), "inconsistent"),
    "endless corner": (lambda d: first_accessor(d).update(max=[float("inf"), 1, 1]), "no finite size"),
    "corner of thirty numbers": (
        lambda d: first_accessor(d).update(min=[0] * 30, max=[1] * 30),
        "inconsistent",
    ),
    "a node its own ancestor": (loop, "in a loop"),
    "nodes null": (lambda d: d.update(nodes=None), "inconsistent"),
    "huge scale": (lambda d: d["nodes"][-1].update(scale=[1e300, 1e300, 1e300]), "m high"),
}


@pytest.mark.parametrize("case", by_day([*MODELS][::4], MODELS))
def test_odd_models(house: Path, case: str):
    change, what = MODELS[case]
    rewritten(house, change)
    line = only(house)
    assert line.startswith("exhibits/chest/exhibit.toml: models.hall: ")
    assert what in line
    assert "other" in [exhibit.id for exhibit in load(house).exhibits]


@pytest.mark.parametrize("case", CLAIMS)
def test_a_model_that_claims_more_than_it_holds(house: Path, case: str):
    """A few hundred bytes of it would fill the memory of whoever reads it."""
    change, what = CLAIMS[case]
    path = rewritten(house, change)
    with pytest.raises(GlbError, match=what):
        read_glb(path)
    assert what in left_out(house)


def test_a_model_of_too_many_triangles_is_read_once(house: Path, monkeypatch: pytest.MonkeyPatch):
    """The second reader takes everything apart: it is not asked where the number alone says that it cannot stay."""
    monkeypatch.setattr("hall_app.check.files.models.MOST_TRIANGLES", 11)
    monkeypatch.setattr("trimesh.load_scene", lambda path: pytest.fail("read by trimesh"))
    monkeypatch.setattr("hall_app.check.files.budget.TRIANGLES", {"hall": 11, "close": 11})
    assert {problem.what for problem in check(house)} == {"12 triangles, at most 11"}


def test_a_texture_that_would_fill_the_memory(house: Path):
    with_texture(house, png_of(30_000, 30_000))
    assert "one of its textures cannot be read" in left_out(house)


def test_a_large_texture_is_named_without_a_warning(house: Path):
    with_texture(house, png_of(12_000, 9_000, rows=9_000))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "a texture has 12000 x 9000 pixels, at most 2048 x 2048" in only(house)


@pytest.mark.parametrize("text", [DEEP, DIGITS])
def test_odd_toml_of_an_exhibit(house: Path, text: str):
    toml(house).write_text(text, "utf-8")
    assert left_out(house).startswith("exhibits/chest/exhibit.toml: cannot be read")


@pytest.mark.parametrize("name", ["hall.toml", "plan.toml"])
@pytest.mark.parametrize("text", [DEEP, DIGITS])
def test_odd_toml_of_the_house(house: Path, name: str, text: str):
    (house / name).write_text(text, "utf-8")
    with pytest.raises(ContentError, match=f"^{name}: cannot be read"):
        load(house)
    assert only(house).startswith(f"{name}: cannot be read")


def test_a_byte_order_mark_is_no_fault(house: Path):
    for path in house.rglob("*.toml"):
        path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert check(house) == []


@pytest.mark.parametrize("name", [LONG + ".jpg", "media/" + "y/" * 3000 + "z.jpg"])
def test_a_path_longer_than_the_file_system_takes(house: Path, name: str):
    edit(toml(house), "media/front.jpg", name)
    (house / "exhibits/chest/media/front.jpg").unlink()
    assert "media[1].file: " in left_out(house)


@pytest.mark.parametrize(
    "src", by_day(["media/%00.jpg"], [f"media/{LONG}.jpg", "media/%00.jpg", "media/" + "y/" * 3000 + "z.jpg"])
)
def test_a_picture_of_a_text_with_an_impossible_name(house: Path, src: str):
    (house / "exhibits/chest/text.en.md").write_text(f"![words]({src})", "utf-8")
    shown = exhibit_json(load(house), "chest")
    assert shown is not None
    assert "words" in shown["text"]["en"]
    assert "<img" not in shown["text"]["en"]
    assert only(house).startswith("exhibits/chest/text.en.md: the picture media/")


@pytest.mark.parametrize("name", ["patterns/pibo.toml", "weaves/gauze.toml", "outfits/scarf.toml"])
@pytest.mark.parametrize("text", by_day([DIGITS, "x = 1"], [DEEP, DIGITS, "x = 1", "\ufeffx = 1"]))
def test_odd_inputs_of_a_bake(house: Path, name: str, text: str):
    dressed(house)
    (house / name).write_text(text, "utf-8")
    assert only(house).startswith(f"{name}: ")


def test_an_input_that_fails_in_an_unforeseen_way(house: Path, monkeypatch: pytest.MonkeyPatch):
    def fail(path: Path) -> None:
        raise MemoryError

    dressed(house)
    monkeypatch.setattr("sim_core.weave.Weave.load", fail)
    assert only(house) == "weaves/gauze.toml: cannot be read (MemoryError) – correct the file"


def test_huge_numbers_of_a_pattern_warn_of_nothing(house: Path):
    dressed(house)
    edit(house / "patterns/pibo.toml", "[0.4, 2.4]", "[1e300, 1e300]")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check(house)


@pytest.mark.parametrize(
    "key", by_day(["layer.1.weave"], ["layer.1.pattern", "layer.1.weave", "layer.1.weaves.cloth", "wearer"])
)
def test_every_file_an_outfit_names_has_to_be_there(house: Path, key: str):
    outfit, name = dressed(house), key.rpartition(".")[2]
    lines = [line for line in outfit.read_text("utf-8").splitlines() if not line.startswith(f"{name} =")]
    named = {"cloth": 'weaves = { cloth = "none" }', "wearer": ""}.get(name, f'{name} = "none"')
    outfit.write_text("\n".join(['wearer = "none"' if key == "wearer" else "", *lines, named]), "utf-8")
    assert [exhibit.id for exhibit in load(house).exhibits] == ["other"]
    assert only(house) == f"outfits/scarf.toml: {key}: missing file none – add none or correct the path"


def test_a_file_of_an_outfit_may_not_leave_the_folder(house: Path):
    (house.parent / "secret.toml").write_text("x = 1", "utf-8")
    edit(dressed(house), "patterns/pibo.toml", "../secret.toml")
    assert only(house).startswith("outfits/scarf.toml: layer.1.pattern: ../secret.toml is a link that leaves")


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("seed = 1", "seeed = 1", "layer.1.seeed: unknown key – "),
        ("seed = 1", "edge = 5.0", "layer.1.edge: "),
        ("seed = 1", 'place = { way = "flat" }', "layer.1.place.way: 'flat' – choose over_bar"),
        (
            "seed = 1",
            "measures = { width = 4 }",
            "layer.1: patterns/pibo.toml: measures.width: no such measure",
        ),
    ],
)
def test_an_outfit_that_cannot_be_dressed_is_told_by_file_key_and_remedy(
    house: Path, old: str, new: str, line: str
):
    edit(dressed(house), old, new)
    assert only(house).startswith(f"outfits/scarf.toml: {line}")


def test_an_exhibit_that_fails_in_an_unforeseen_way(house: Path, monkeypatch: pytest.MonkeyPatch):
    from hall_app.content.models import read_glb

    def fail(path: Path, *, whole=read_glb) -> object:
        return whole(path) if "other" in str(path) else 1 / 0

    monkeypatch.setattr("hall_app.content.loading.exhibits.read_glb", fail)
    content = load(house)
    assert [exhibit.id for exhibit in content.exhibits] == ["other"]
    (problem,) = content.problems
    assert str(problem).startswith("exhibits/chest/exhibit.toml: cannot be read (division by zero) – ")


@pytest.mark.parametrize("name", ["text.en.md", "exhibit.toml"])
def test_texts_and_tables_are_no_links_out_of_the_folder(house: Path, tmp_path: Path, name: str):
    path, secret = house / "exhibits/chest" / name, tmp_path / "secret"
    path.rename(secret)
    os.symlink(secret, path)
    line = left_out(house)
    assert line.startswith(f"exhibits/chest/{name}: ")
    assert "link that leaves the content folder – copy the file itself" in line


def test_hall_and_plan_are_no_links_out_of_the_folder(house: Path, tmp_path: Path):
    (house / "hall.toml").rename(tmp_path / "hall.toml")
    os.symlink(tmp_path / "hall.toml", house / "hall.toml")
    assert only(house).startswith("hall.toml: it is a link that leaves the content folder – ")


PLACES = {
    "millimetres": ("[-5, 5]]\n[[wall]]", "[-20000, 20000]]\n[[wall]]", "outline[4]: -20000 m"),
    "a far wall": ("from = [-5, -3]", "from = [1e7, -3]", "wall[1].from: 1e+07 m"),
    "a far solid": ("at = [-3, 0]", "at = [-3, -3000]", "solid[1].at: -3000 m"),
    "a far round": ("x = 3, z = 0", "x = 3, z = 1e300", "solid[2].round: 1e+300 m"),
    "a far bay": ("polygon = [[-5, -5]", "polygon = [[-5, -5e9]", "bay[1].polygon[1]: -5e+09 m"),
}


@pytest.mark.parametrize("case", PLACES)
def test_places_are_in_metres(house: Path, case: str):
    old, new, what = PLACES[case]
    edit(house / "plan.toml", old, new)
    line = only(house)
    assert line.startswith(f"plan.toml: {what} is no place in a hall")
    assert "write metres" in line


@pytest.mark.parametrize("x", by_day(["4000"], ["1e300", "-1e300", "4000"]))
def test_an_exhibit_or_a_start_far_away(house: Path, x: str):
    edit(toml(house), "x = 0.0", f"x = {x}")
    assert "place: outside the hall's outline" in left_out(house)
    edit(house / "hall.toml", "x = 0.0", f"x = {x}")
    with pytest.raises(ContentError, match=r"^hall\.toml: start: a visitor would begin outside"):
        load(house)


def test_a_lasting_fault_of_the_folder_is_told_in_the_running_hall(
    house: Path, monkeypatch: pytest.MonkeyPatch
):
    """A file that goes away while it is read is looked at again; what stays as it is is told."""
    watcher = Watcher(house)
    edit(toml(house), 'en = "Chest"', 'en = "Coffer"')

    def fail(*args: object, **options: object) -> None:
        raise PermissionError(13, "Permission denied", "hall.toml")

    with monkeypatch.context() as failing:
        failing.setattr("hall_app.content.loading.reload.load", fail)
        assert watcher.poll() is None
        told = watcher.poll()
        assert told is not None
        assert [exhibit.file.title.en for exhibit in told.exhibits] == ["Chest", "Chest"]
        assert "cannot be read" in str(told.problems[-1])
        assert "Permission denied" in str(told.problems[-1])
        assert watcher.poll() is None, "told once"
    edit(toml(house), 'en = "Coffer"', 'en = "Trunk"')
    mended = watcher.poll()
    assert mended is not None
    assert mended.problems == ()
    assert mended.exhibits[0].file.title.en == "Trunk"
