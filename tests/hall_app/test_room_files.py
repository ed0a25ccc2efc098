"""The room as files: one GLB within its budget, letters, key, environment, and the checks that go with them."""

import io
from pathlib import Path

import numpy as np
import pytest
from content_house import make_house
from PIL import Image
from room_font import BLANK, needs_font
from stored_room import store_room

from hall_app.check import check
from hall_app.cli import main
from hall_app.content import load
from hall_app.content.models import difference, hex_of, main_colour, open_glb, read_glb
from hall_app.light import LightMap
from hall_app.room import raise_room, room_glb
from hall_app.room.bake import room_folder, room_key, shown_room
from hall_app.room.picture import environment_jpeg, painted
from hall_app.room.surface import (
    BACKDROPS,
    MATERIALS,
    TEXTURES,
    MissingFontError,
    Writing,
    lettering,
    linear,
    texture,
    write,
)
from sim_core.gltf import GlbFile

ASSETS = Path(__file__).parents[2] / "assets"
MB = 1_000_000


@pytest.fixture(scope="module")
def content():
    return load(ASSETS)


@pytest.fixture(scope="module")
def room(content):
    return raise_room(content.plan, content.hall.title, content.exhibits, folder=ASSETS, blank=BLANK)


@pytest.fixture(scope="module")
def flat(room, tmp_path_factory):
    path = tmp_path_factory.mktemp("room") / "flat.glb"
    path.write_bytes(room_glb(room))
    return path


@pytest.fixture(scope="module")
def lit(room, tmp_path_factory):
    """The room with a light map of a few grey texels."""
    faces = room.triangles
    uv = np.tile([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]], (faces, 1, 1))
    starts = np.cumsum([0, *(len(p.faces) for p in room.patches)])
    for patch, start in zip(
        room.patches, starts, strict=False
    ):  # one place per vertex, as a packed chart has
        place = np.full((len(patch.vertices), 2), 0.5)
        uv[start : start + len(patch.faces)] = place[patch.faces]
    quarter = np.full((8, 8, 3), 0.25, np.float32)
    light = LightMap(quarter, 2 * quarter, uv, np.ones((8, 8), bool), 2.0, {})
    path = tmp_path_factory.mktemp("room") / "lit.glb"
    path.write_bytes(room_glb(room, light))
    return path


def meshes(path: Path) -> list[tuple[str, dict]]:
    """Names, of which several meshes may have one, and what glTF calls primitives."""
    document = open_glb(path).document
    return [(mesh["name"], {**mesh["primitives"][0], "document": document}) for mesh in document["meshes"]]


@pytest.mark.parametrize("kind", ["flat", "lit"])
def test_the_room_stays_within_its_budget(kind, flat, lit):
    info = read_glb({"flat": flat, "lit": lit}[kind])
    assert info.triangles <= 40_000
    assert info.size <= 1.8 * MB
    assert max(max(size) for size in info.textures) <= 2048
    assert sum(size != (8, 8) for size in info.textures) <= 17


def test_pictures_of_materials_are_small_and_tile():
    total = 0
    for name, material in MATERIALS.items():
        if material.texture not in TEXTURES:
            continue
        picture = texture(material.texture, material.colour).astype(float)
        stream = io.BytesIO()
        Image.fromarray(picture.astype(np.uint8)).save(stream, "JPEG", quality=88, subsampling=0)
        total += len(stream.getvalue())
        wanted = [int(material.colour[k : k + 2], 16) for k in (1, 3, 5)]
        assert np.allclose(picture.mean((0, 1)), wanted, atol=7), name
        if material.texture not in ("tiles", "boards", "panel", "lantern"):
            inner = np.abs(np.diff(picture, axis=0)).mean(), np.abs(np.diff(picture, axis=1)).mean()
            seam = np.abs(picture[0] - picture[-1]).mean(), np.abs(picture[:, 0] - picture[:, -1]).mean()
            assert all(s < 3 * i + 1 for s, i in zip(seam, inner, strict=True)), name
    assert total <= 0.6 * MB


def test_large_walls_vary_by_a_hundredth():
    shade = texture("plaster", "#808080").astype(float) / 128
    assert shade.std() < 0.012


def test_without_light_every_mesh_is_shaded(flat):
    for name, mesh in meshes(flat):
        assert name.startswith("hall_")
        assert mesh["document"]["materials"][mesh["material"]]["name"] == name
        assert "KHR_materials_unlit" in mesh["document"]["materials"][mesh["material"]]["extensions"]
        glows = MATERIALS[name.removeprefix("hall_")].glow > 0
        assert ("COLOR_0" in mesh["attributes"]) != glows
        assert "TEXCOORD_1" not in mesh["attributes"]


def test_with_light_every_mesh_but_lamps_has_its_second_coordinates(lit):
    found = meshes(lit)
    (bearer,) = [mesh for name, mesh in found if name == "lightmap"]
    material = bearer["document"]["materials"][bearer["material"]]
    assert material["name"] == "lightmap"
    assert "baseColorTexture" in material["pbrMetallicRoughness"]
    for name, mesh in found:
        if mesh is bearer:
            continue
        glows = MATERIALS[name.removeprefix("hall_")].glow > 0
        assert ("TEXCOORD_1" in mesh["attributes"]) != glows
        assert "COLOR_0" not in mesh["attributes"]
        assert ("TEXCOORD_0" in mesh["attributes"]) == (
            MATERIALS[name.removeprefix("hall_")].texture is not None
        )


def test_what_lies_beside_the_view_can_be_left_out(room, flat):
    """From the middle of the hall, whichever way one looks, most of its triangles lie in meshes beside the view."""
    parts = open_glb(flat)
    boxes, counts = [], []
    for _, mesh in meshes(flat):
        place = parts.document["accessors"][mesh["attributes"]["POSITION"]]
        boxes.append([place["min"], place["max"]])
        counts.append(parts.document["accessors"][mesh["indices"]]["count"] // 3)
    assert sum(counts) == room.triangles
    low, high = np.array(boxes).transpose(1, 0, 2)
    middle, reach = (low + high) / 2, np.linalg.norm(high - low, axis=1) / 2
    half = np.radians(45)  # wider than any picture of the hall on a screen
    for way in np.radians(np.arange(0, 360, 30)):
        sides = np.array([way - half - np.pi / 2, way + half + np.pi / 2])
        outward = np.stack([np.cos(sides), np.zeros(2), np.sin(sides)], axis=1)
        drawn = ((middle - [0, 1.6, 0]) @ outward.T < reach[:, None]).all(axis=1)
        assert 0.1 * room.triangles < np.array(counts)[drawn].sum() < 0.7 * room.triangles


def test_stored_light_is_half_of_it(lit):
    picture = np.asarray(Image.open(io.BytesIO(open_glb(lit).pictures()[-1])))
    assert np.abs(picture.astype(float) - 255 * (1.055 * 0.25 ** (1 / 2.4) - 0.055)).max() < 2


def test_another_reader_draws_the_room(flat):
    import trimesh

    scene = trimesh.load_scene(flat)
    assert len(scene.geometry) >= 12


@needs_font
def test_writings_do_not_touch_and_fit():
    sheet = write(
        [Writing("label", "展品", "Exhibit", (520, 170))] * 9
        + [Writing("banner", "青青子衿", "", (165, 690))]
    )
    boxes = np.array(sheet.places)
    assert boxes.min() >= 0
    assert boxes.max() <= 1
    for k, a in enumerate(boxes):
        for b in boxes[k + 1 :]:
            assert a[2] < b[0] or b[2] < a[0] or a[3] < b[1] or b[3] < a[1]


@pytest.mark.door
@needs_font
def test_labels_say_what_the_exhibits_are_called(room, content):
    blank = raise_room(content.plan, content.hall.title, content.exhibits, blank=True)
    assert blank.sheet.picture.shape == room.sheet.picture.shape
    assert (blank.sheet.picture != room.sheet.picture).any()
    renamed = content.hall.title.model_copy(update={"zh": "另一厅"})
    other = raise_room(content.plan, renamed, content.exhibits)
    assert (other.sheet.picture != room.sheet.picture).any()


@pytest.fixture
def no_fonts(monkeypatch, tmp_path):
    lettering._font.cache_clear()
    monkeypatch.setattr(lettering, "font_folders", lambda: [tmp_path])
    yield
    lettering._font.cache_clear()


def test_a_missing_font_is_named_with_its_package(no_fonts):
    with pytest.raises(MissingFontError, match=r"NotoSerifCJK.*apt-get install fonts-noto-cjk"):
        write([Writing("label", "展品", "Exhibit", (520, 170))])


def test_build_says_which_font_is_missing(no_fonts, tmp_path, capsys):
    house = make_house(tmp_path / "house")
    assert main(["build", "--room", "--content", str(house), "--data", str(tmp_path / "data")]) == 1
    error = capsys.readouterr().err
    assert "fonts-noto-cjk" in error
    assert len(error.strip().splitlines()) == 1


def test_without_the_font_the_hall_opens_with_blank_boards(no_fonts, tmp_path):
    shown = shown_room(load(make_house(tmp_path / "house")), tmp_path / "data")
    assert shown.lacking is not None
    assert shown.glb.startswith(b"glTF")


CHANGES = {
    "a wall moved": ("plan.toml", "to = [1, -3]", "to = [0.9, -3]"),
    "another height": ("plan.toml", "height = 0.2", "height = 0.25"),
    "another title": ("hall.toml", 'zh = "厅"', 'zh = "堂"'),
    "an exhibit renamed": ("exhibits/chest/exhibit.toml", 'en = "Chest"', 'en = "Box"'),
    "an exhibit moved": ("exhibits/chest/exhibit.toml", "z = -1.0", "z = -1.1"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_the_key_follows_what_is_seen(change, tmp_path):
    house = make_house(tmp_path / "house")
    before = room_key(load(house))
    name, old, new = CHANGES[change]
    text = (house / name).read_text("utf-8")
    assert old in text
    (house / name).write_text(text.replace(old, new), "utf-8")
    assert room_key(load(house)) != before


def test_the_key_ignores_what_is_not_seen(tmp_path):
    house = make_house(tmp_path / "house")
    before = room_key(load(house))
    (house / "exhibits/chest/text.en.md").write_text("Another text.", "utf-8")
    assert room_key(load(house)) == before


def test_a_baked_room_is_shown_while_it_fits(tmp_path):
    house, data = make_house(tmp_path / "house"), tmp_path / "data"
    content = load(house)
    assert room_folder(content, data) is None
    store_room(house / "room", room_key(content))
    assert room_folder(content, data) == content.folder / "room"
    assert shown_room(content, data).baked
    assert not check(house)
    store_room(house / "room", "0" * 16)
    assert room_folder(content, data) is None
    assert not shown_room(content, data).baked
    assert any("stale" in problem.what for problem in check(house))
    store_room(data / f"room-{room_key(content)}", room_key(content))
    assert shown_room(content, data).baked


def test_half_a_bake_is_none(tmp_path):
    house = make_house(tmp_path / "house")
    store_room(house / "room", room_key(load(house)))
    (house / "room/room.glb").unlink()
    assert room_folder(load(house), tmp_path) is None
    assert [str(problem) for problem in check(house)] == [
        "room/room.glb: is missing – run: hall build --room"
    ]


def test_environment_is_warm_above_and_grey_below():
    picture = np.asarray(Image.open(io.BytesIO(environment_jpeg(painted())))).astype(float)
    assert picture.shape == (256, 512, 3)
    above, below = picture[:60].mean((0, 1)), picture[-60:].mean((0, 1))
    assert above.mean() > below.mean()
    assert above[0] > above[2] + 10
    assert np.ptp(below) < 12


# Backdrops.


def coloured(path: Path, colour: str, *, stand: bool = False) -> None:
    glb = GlbFile()
    look = glb.material({"pbrMetallicRoughness": {"baseColorFactor": [*linear(colour).tolist(), 1.0]}})
    square = np.array([[-0.5, 0, 0], [0.5, 0, 0], [0.5, 1.2, 0], [-0.5, 1.2, 0]], float)
    glb.mesh("dress", square, np.array([[0, 1, 2], [0, 2, 3]]), look)
    if stand:
        dark = glb.material({"pbrMetallicRoughness": {"baseColorFactor": [0.0, 0.0, 0.0, 1.0]}})
        glb.mesh("stand", 3 * square, np.array([[0, 1, 2], [0, 2, 3]]), dark)
    path.write_bytes(glb.bytes("dress", []))


def test_main_colour_is_that_of_the_dress(tmp_path):
    coloured(tmp_path / "dress.glb", "#A63A2E", stand=True)
    found = main_colour(tmp_path / "dress.glb")
    assert found is not None
    assert hex_of(found) == "#A63A2E"


@pytest.mark.parametrize(
    ("colour", "pale", "dark"),
    [("#A63A2E", 73, 67), ("#2F4B6B", 58, 10), ("#C9A24A", 55, 79), ("#C7D8DA", 2, 62), ("#E6DCC6", 14, 69)],
)
def test_colour_differences_of_the_palette(colour, pale, dark):
    for name, value in (("pale", pale), ("dark", dark)):
        assert difference(linear(colour), linear(BACKDROPS[name])) == pytest.approx(value, abs=1.5)


def test_dress_that_sinks_into_its_backdrop_is_a_problem(tmp_path):
    house = make_house(tmp_path / "house")
    plan = (house / "plan.toml").read_text("utf-8")
    toml = house / "exhibits/chest/exhibit.toml"
    place = toml.read_text("utf-8").replace(
        "x = 0.0\nz = -1.0", 'x = -3.0\nz = 0.0\nfacing = 90\non = "booth"'
    )
    toml.write_text(place, "utf-8")
    coloured(house / "exhibits/chest/media/chest.glb", "#2F4B6B")
    for backdrop, said in (("dark", True), ("pale", False)):
        text = plan.replace("height = 0.2", f'height = 0.2\nbackdrop = "{backdrop}"')
        (house / "plan.toml").write_text(text, "utf-8")
        found = [str(problem) for problem in check(house) if "backdrop" in problem.what]
        assert bool(found) == said
        if said:
            assert "#2F4B6B" in found[0]
            assert "ΔE 10" in found[0]
            assert 'backdrop = "pale" (ΔE 58)' in found[0]


def dress_at(away: float, backdrop: str) -> str:
    """A grey between black and white that is `away` (ΔE) from the backdrop, as near as 8 bits allow."""
    greys = [f"#{level:02X}{level:02X}{level:02X}" for level in range(256)]
    return min(greys, key=lambda g: abs(difference(linear(g), linear(BACKDROPS[backdrop])) - away))


@pytest.mark.parametrize("backdrop", ["pale", "dark"])
@pytest.mark.parametrize(("away", "said"), [(39.0, True), (41.0, False)])
def test_the_limit_of_backdrops_is_forty(backdrop, away, said, tmp_path):
    house = make_house(tmp_path / "house")
    toml, plan = house / "exhibits/chest/exhibit.toml", house / "plan.toml"
    place = 'x = -3.0\nz = 0.0\nfacing = 90\non = "booth"'
    toml.write_text(toml.read_text("utf-8").replace("x = 0.0\nz = -1.0", place), "utf-8")
    text = plan.read_text("utf-8").replace("height = 0.2", f'height = 0.2\nbackdrop = "{backdrop}"')
    plan.write_text(text, "utf-8")
    colour = dress_at(away, backdrop)
    assert difference(linear(colour), linear(BACKDROPS[backdrop])) == pytest.approx(away, abs=0.5)
    coloured(house / "exhibits/chest/media/chest.glb", colour)
    found = [problem for problem in check(house) if "backdrop" in problem.what]
    assert bool(found) == said
