"""Patterns, the garment file, stand, levels of detail and GLB, on small and quick garments."""

import json
import struct
import zipfile
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image
from plain_garments import Maps, plain_maps

from sim_core import metrics
from sim_core.body import Beneath, Surface
from sim_core.cloth import Contact, Holds, Phase
from sim_core.cloth.contact import solid_mesh
from sim_core.errors import FileProblem, OutlineError, SimCoreError
from sim_core.garment import Clothed, Garment, Pattern, Settled, Stand, choose_detail, opaque, write_glb
from sim_core.mesh import panel_mesh
from sim_core.weave import Weave, solve
from sim_core.weave.maps import FiguredMaps, figured_maps

SHEET = 'name = "test"\nedge = 0.05\nsize = [0.4, 1.0]\n'


def arched(edge: float = 0.02) -> Garment:
    """A strip bent over the bar as a half pipe with straight legs."""
    outline = np.array([[0, 0], [0.3, 0], [0.3, 1.0], [0, 1.0]], float)
    panel = panel_mesh(outline, edge=edge)
    s, r = panel.vertices[:, 1] - 0.5, 0.02
    angle = np.clip(s / r, -np.pi / 2, np.pi / 2)
    down = np.maximum(np.abs(s) - r * np.pi / 2, 0)
    x = np.column_stack([0.15 - panel.vertices[:, 0], 1.5 + r * np.cos(angle) - down, r * np.sin(angle)])
    x[:, 2] += 0.02 * down * np.sin(40 * panel.vertices[:, 0])
    settled = Settled(Contact(), Phase(1.0), Holds.of(len(x)), Beneath(stand=Stand()))
    faces, weld = panel.faces.astype(np.int32), np.arange(len(x), dtype=np.int32)
    cut = Pattern("strip", outline, edge).to_dict()
    one = np.zeros(len(faces), np.int32)
    return Garment(
        "strip", panel.vertices, faces, weld, one, x, cut=cut, settled=settled, provenance={"edge": edge}
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["empty", "needs name"]),
        ("   \n", ["empty"]),
        ("name = ", ["not valid TOML"]),
        (SHEET + "sise = 3\n", ["sise", "unknown key", "known: name"]),
        ('name = "x"\nedge = 0.01\n', ["size", "outline"]),
        (SHEET + "outline = [[0,0],[1,0],[0,1]]\n", ["either size", "or outline"]),
        ('name = "x"\nsize = [0.4, 1.0]\n', ["edge"]),
        ('name = "x"\nedge = -1\nsize = [0.4, 1.0]\n', ["edge", "-1"]),
        ('name = "x"\nedge = 0.05\nsize = [0.4, nan]\n', ["size"]),
        ('name = "x"\nedge = 0.05\nsize = [0.4, 900.0]\n', ["size", "20 m"]),
        ('name = "x"\nedge = 0.05\noutline = [[0,0],[1,1]]\n', ["outline", "3"]),
        ('name = "x"\nedge = 0.05\noutline = [[0,0],[1,1],[1,0],[0,1]]\n', ["outline", "cross"]),
        ('name = "x"\nedge = 0.05\noutline = [[0,0],[1,1],[2,2]]\n', ["outline"]),
        (SHEET + 'dye = "red"\n', ["dye", "red"]),
    ],
)
def test_bad_patterns_name_file_key_and_remedy(tmp_path: Path, text: str, words: list[str]) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(text, "utf-8")
    with pytest.raises(FileProblem) as caught:
        Pattern.load(path)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    assert all(word in message for word in words), message


def test_missing_pattern_is_named(tmp_path: Path) -> None:
    with pytest.raises(
        FileProblem, match=r"none\.toml: No such file or directory – give the path of a pattern"
    ):
        Pattern.load(tmp_path / "none.toml")


def test_patterns_mesh_in_their_own_axes(tmp_path: Path) -> None:
    path = tmp_path / "ok.toml"
    path.write_text(SHEET + 'dye = "#ff8000"\n', "utf-8")
    pattern = Pattern.load(path)
    panel = pattern.mesh()
    assert np.ptp(panel.vertices, axis=0) == pytest.approx([0.4, 1.0])
    assert pattern.dye == pytest.approx((1.0, 128 / 255, 0.0))
    with pytest.raises(OutlineError):
        Pattern("bow", np.array([[0, 0], [1, 1], [1, 0], [0, 1]], float), 0.05).check()


def test_garment_file_round_trip(tmp_path: Path) -> None:
    garment = arched(0.05).noted(note="纱", numbers=[1, 2.5])
    garment.save(tmp_path / "g.npz")
    back = Garment.load(tmp_path / "g.npz")
    assert back.digest() == garment.digest()
    assert (back.name, back.weave, back.material, back.provenance, back.dye) == (
        garment.name,
        garment.weave,
        garment.material,
        garment.provenance,
        garment.dye,
    )
    assert back.origins == ()
    replace(garment, origins=((0.1, -0.25),)).save(tmp_path / "g.npz")
    assert Garment.load(tmp_path / "g.npz").origins == ((0.1, -0.25),)
    moved = Garment(**{**garment.__dict__, "positions": garment.positions + 1e-15})
    assert moved.digest() != garment.digest()


def test_on_a_grid_a_file_is_a_third_smaller_and_nothing_has_moved(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(4)
    rough = ball.vertices + np.random.default_rng(1).normal(0.0, 0.002, ball.vertices.shape)
    body = Surface(rough, np.asarray(ball.faces, np.int32))
    garment = replace(arched(0.05), settled=Settled(Contact(), Phase(1.0), Holds.of(1), Beneath((body,))))
    step = 2.0**-23
    kept = garment.on_grid(step)
    assert np.abs(kept.positions - garment.positions).max() <= step / 2
    assert kept.on_grid(step).digest() == kept.digest()
    kept.save(tmp_path / "kept.npz")
    garment.save(tmp_path / "whole.npz")
    sizes = {}
    for name in ("kept", "whole"):
        with zipfile.ZipFile(tmp_path / f"{name}.npz") as held:
            sizes[name] = held.getinfo("surface0_vertices.npy").compress_size
    assert sizes["kept"] < 0.7 * sizes["whole"]
    back = Garment.load(tmp_path / "kept.npz")
    assert back.digest() == kept.digest()
    assert back.settled is not None
    assert kept.settled is not None
    assert back.settled.beneath.digest() == kept.settled.beneath.digest()


def test_what_two_layers_lie_on_is_written_once(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(3)
    body = Surface(
        np.asarray(ball.vertices, float), np.asarray(ball.faces, np.int32), (np.arange(9, dtype=np.int32),)
    )
    other = replace(body, vertices=body.vertices + [1e-12, 0.0, 0.0])
    inner, outer = (
        replace(
            arched(0.05),
            settled=Settled(Contact(), Phase(1.0), Holds.of(1), Beneath(surfaces, closing=0.012)),
        )
        for surfaces in ((body, other), (other, body))
    )
    outer.save(tmp_path / "garment.npz")
    inner.save(tmp_path / "whole.npz")
    inner.save(tmp_path / "beneath-1.npz", beside=("garment.npz", outer))
    assert (tmp_path / "beneath-1.npz").stat().st_size < (tmp_path / "whole.npz").stat().st_size / 2
    own, back = (Garment.load(tmp_path / name).settled for name in ("whole.npz", "beneath-1.npz"))
    assert own is not None
    assert back is not None
    assert back.beneath.digest() == own.beneath.digest()
    (tmp_path / "garment.npz").unlink()
    with pytest.raises(FileProblem, match=r"garment.npz: no such file – bake the garment again"):
        Garment.load(tmp_path / "beneath-1.npz")
    told = own.to_header() | {"surfaces": [{"thicker": 0, "hulls": 0, "file": "../garment.npz", "number": 0}]}
    with pytest.raises(ValueError, match="no file beside it"):
        Settled.names(told)


def test_bad_garment_files_are_named(tmp_path: Path) -> None:
    path = tmp_path / "g.npz"
    with pytest.raises(FileProblem, match="no such file"):
        Garment.load(path)
    arched(0.05).save(path)
    whole = path.read_bytes()
    for content in (b"", b"not an archive", whole[: len(whole) // 2]):
        path.write_bytes(content)
        with pytest.raises(FileProblem, match=r"g.npz: not a garment file .* bake"):
            Garment.load(path)
    arrays: dict[str, Any] = _arrays(arched(0.05))
    for other in (2, 99):  # 2 did not say what it was settled with
        np.savez(path, header=np.frombuffer(json.dumps({"format": other}).encode(), np.uint8), **arrays)
        with pytest.raises(FileProblem, match="another format – bake the garment again"):
            Garment.load(path)


def _arrays(garment: Garment) -> dict[str, np.ndarray]:
    return {
        name: getattr(garment, name) for name in ("pattern", "pattern_faces", "weld", "panel", "positions")
    }


def test_inconsistent_garments_are_refused() -> None:
    good = arched(0.05)
    for change, word in (
        ({"pattern_faces": good.faces + len(good.pattern)}, "pattern_faces"),
        ({"positions": good.positions[:-1]}, "weld"),
        ({"weld": good.weld[:-1]}, "must agree"),
        ({"weld": np.minimum(good.weld, 3)}, "not every one"),
        ({"panel": good.panel + 1}, "panel"),
        ({"dyes": (None, None)}, "dyes"),
        ({"positions": np.full_like(good.positions, np.nan)}, "not finite"),
        ({"pattern": good.positions}, "pattern"),
    ):
        with pytest.raises(SimCoreError, match=word):
            Garment(**{**good.__dict__, **change})


def test_stand_shows_what_it_collides_with() -> None:
    stand = Stand()
    for part in stand.parts():
        vertices, faces = solid_mesh(part, 24)
        shape = trimesh.Trimesh(vertices, faces, process=False)
        assert shape.is_watertight
        assert shape.volume > 0
        assert np.abs(part.distance(vertices)).max() < 1e-9
    vertices, faces = stand.mesh()
    assert vertices[:, 1].min() == pytest.approx(0.0, abs=1e-9)
    assert stand.collider().distance(vertices).max() < 1e-9
    assert 1.5 < vertices[:, 1].max() < 1.6
    with pytest.raises(SimCoreError, match="stand.bar_radius"):
        Stand(bar_radius=-1.0)


def test_a_level_is_coarser_measured_and_clear_of_the_stand() -> None:
    fine = arched(0.02)
    coarse = choose_detail(fine, 0.006)
    assert len(coarse.faces) < len(fine.faces) / 4
    apart = coarse.provenance["detail"]["hausdorff"]
    again = metrics.hausdorff(fine.positions, fine.faces, coarse.positions, coarse.faces, spacing=0.003)
    assert apart["max_m"] == pytest.approx(again.max, rel=0.2)
    assert 0 < apart["mean_m"] < apart["p99_m"] <= apart["max_m"] < 0.03
    inside = metrics.penetration(coarse.positions, coarse.faces, *Stand().mesh(48))
    assert inside.total == 0


def test_cheapest_detail_within_the_budget() -> None:
    fine = arched(0.02)
    chosen = choose_detail(fine, 0.001)
    facts = chosen.provenance["detail"]
    assert facts["hausdorff"]["p99_m"] <= 0.001 < facts["tried"][-1]["p99_m"]
    assert len(chosen.faces) == facts["triangles"] < len(fine.faces)
    strict = choose_detail(fine, 1e-6)
    assert strict.digest() == fine.digest()
    assert strict.provenance["detail"]["tried"]


def test_the_level_of_what_moves_is_measured_in_all_moments_however_few() -> None:
    """The only one that is bent lies between those that the mesh is fitted to."""
    fine = arched(0.02)
    x = fine.positions
    bent = x + np.column_stack([np.zeros(len(x)), np.zeros(len(x)), 0.03 * np.sin(30 * x[:, 1])])
    found = [
        len(choose_detail(fine, 0.004, moments=film).faces)
        for film in ([bent, x, x], [x, bent, x], [x, x, x])
    ]
    assert found[2] < found[0] <= 1.5 * found[1]
    assert found[1] < len(fine.faces)
    for wrong, words in (
        (np.r_[x, x[:2]], "vertices"),
        (np.full_like(x, np.nan), "moments"),
        ("abc", "moments"),
    ):
        with pytest.raises(SimCoreError, match=rf"moments\[1\].*{words}|{words}\[1\]"):
            choose_detail(fine, 0.004, moments=[x, wrong, x])


def chunks(path: Path) -> tuple[dict, bytes]:
    data = path.read_bytes()
    magic, version, size = struct.unpack_from("<4sII", data)
    assert (magic, version, size) == (b"glTF", 2, len(data))
    length, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    assert length % 4 == 0
    second, kind = struct.unpack_from("<I4s", data, 20 + length)
    assert kind == b"BIN\0"
    assert 28 + length + second == len(data)
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def accessor(document: dict, blob: bytes, number: int) -> np.ndarray:
    entry = document["accessors"][number]
    view = document["bufferViews"][entry["bufferView"]]
    assert view["byteOffset"] % 4 == 0
    kind = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[entry["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[entry["type"]]
    return np.frombuffer(blob, kind, entry["count"] * width, view["byteOffset"]).reshape(-1, width)


@pytest.mark.parametrize("precision", ["close", "hall"])
def test_glb_holds_what_it_says(tmp_path: Path, precision) -> None:
    garment, path = arched(0.04), tmp_path / "g.glb"
    size = write_glb(path, [Clothed(garment, plain_maps(120))], precision=precision)
    assert size == path.stat().st_size < 1_500_000
    document, blob = chunks(path)
    assert [node["name"] for node in document["nodes"]] == ["strip", "stand"]
    for entry in document["meshes"]:
        primitive = entry["primitives"][0]
        position = accessor(document, blob, primitive["attributes"]["POSITION"])
        told = document["accessors"][primitive["attributes"]["POSITION"]]
        assert told["min"] == pytest.approx(position.min(0).tolist())
        assert told["max"] == pytest.approx(position.max(0).tolist())
        index = accessor(document, blob, primitive["indices"]).ravel()
        assert index.max() < len(position)
        normal = accessor(document, blob, primitive["attributes"]["NORMAL"])
        assert np.linalg.norm(normal, axis=1) == pytest.approx(np.ones(len(normal)), abs=1e-5)
    uv = accessor(document, blob, document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"])
    assert uv == pytest.approx(garment.pattern * 1000, abs=1e-3)
    write_glb(tmp_path / "laid.glb", [Clothed(replace(garment, origins=((0.1, 1.0),)), plain_maps(120))])
    laid, data = chunks(tmp_path / "laid.glb")
    uv = accessor(laid, data, laid["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"])
    assert uv == pytest.approx((garment.pattern - [0.1, 1.0]) * 1000, abs=1e-3)
    cloth, lacquer = document["materials"]
    assert cloth["doubleSided"] is True
    assert cloth["alphaMode"] == "BLEND"
    assert "KHR_materials_sheen" in cloth["extensions"]
    assert "alphaMode" not in lacquer
    if precision == "close":
        scale = cloth["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"][
            "scale"
        ]
        assert scale == pytest.approx([1 / 4.0, 1 / 5.0])  # tiles of 4 x 5 mm over coordinates in mm
    else:
        assert "baseColorTexture" not in cloth["pbrMetallicRoughness"]
        assert cloth["pbrMetallicRoughness"]["baseColorFactor"][3] == pytest.approx(120 / 255, abs=1e-3)


def test_only_dense_cloth_hides_what_lies_beneath() -> None:
    dense, sheer = arched(0.05), arched(0.04)
    positions, faces = opaque([Clothed(dense, plain_maps()), Clothed(sheer, plain_maps(120))])
    assert np.array_equal(positions, np.concatenate([dense.positions, sheer.positions]))
    assert np.array_equal(faces, dense.faces)
    _, over = opaque([Clothed(sheer, plain_maps(120)), Clothed(dense, plain_maps())])
    assert np.array_equal(over, dense.faces + len(sheer.positions))


@pytest.mark.parametrize("precision", ["close", "hall"])
def test_dense_cloth_is_opaque_and_its_pores_are_dark(tmp_path: Path, precision) -> None:
    dense = plain_maps(120)
    dense.opacity[:] = 255
    dense.opacity[:8, :8] = 0
    write_glb(tmp_path / "g.glb", [Clothed(arched(0.04), dense)], precision=precision)
    document, blob = chunks(tmp_path / "g.glb")
    cloth = document["materials"][0]
    assert "alphaMode" not in cloth
    assert cloth["pbrMetallicRoughness"]["baseColorFactor"][3] == 1.0
    if precision == "close":
        source = document["textures"][cloth["pbrMetallicRoughness"]["baseColorTexture"]["index"]]["source"]
        view = document["bufferViews"][document["images"][source]["bufferView"]]
        start = view.get("byteOffset", 0)
        picture = np.asarray(Image.open(BytesIO(blob[start : start + view["byteLength"]])))
        assert picture.shape[2] == 3
        assert picture[:8, :8].mean() < 0.75 * picture[8:, 8:].mean()


def test_pictures_of_a_closed_cloth_are_small_and_what_its_maps_say(tmp_path: Path) -> None:
    """JPEG at full chroma: of a woven relief a level or two is lost."""
    maps = plain_maps()
    run = np.linspace(0, 8 * np.pi, maps.normal.shape[0])
    maps.normal[..., 0] = np.rint(128 + 16 * np.sin(run)[:, None])
    maps.normal[..., 1] = np.rint(128 + 16 * np.cos(run)[None, :])
    write_glb(tmp_path / "g.glb", [Clothed(arched(0.05), maps)], precision="close")
    document, blob = chunks(tmp_path / "g.glb")
    source = document["textures"][document["materials"][0]["normalTexture"]["index"]]["source"]
    assert document["images"][source]["mimeType"] == "image/jpeg"
    view = document["bufferViews"][document["images"][source]["bufferView"]]
    start = view.get("byteOffset", 0)
    picture = np.asarray(Image.open(BytesIO(blob[start : start + view["byteLength"]]))).astype(float)
    off = np.abs(picture - maps.normal)
    assert off.mean() < 2.0
    assert np.percentile(off, 99) < 6.0


def test_glb_is_read_by_another_library(tmp_path: Path) -> None:
    garment = arched(0.04)
    write_glb(tmp_path / "g.glb", [Clothed(garment, plain_maps(120))], precision="close")
    scene = trimesh.load(tmp_path / "g.glb")
    assert isinstance(scene, trimesh.Scene)
    strip = scene.geometry["strip"]
    assert isinstance(strip, trimesh.Trimesh)
    assert strip.faces.shape == garment.faces.shape
    assert scene.bounds[1][1] == pytest.approx(1.558, abs=0.01)
    assert "stand" in scene.geometry


def test_opaque_cloth_is_opaque_and_dye_is_the_mean_colour(tmp_path: Path) -> None:
    garment = Garment(**{**arched(0.05).__dict__, "dye": (0.7, 0.2, 0.1)})
    write_glb(tmp_path / "g.glb", [Clothed(garment, plain_maps())], precision="close")
    document, blob = chunks(tmp_path / "g.glb")
    cloth = document["materials"][0]
    assert "alphaMode" not in cloth
    view = document["bufferViews"][document["images"][0]["bufferView"]]
    picture = np.asarray(
        Image.open(BytesIO(blob[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]))
    )
    assert picture.shape == (32, 32, 3)
    linear = ((picture[0, 0] / 255 + 0.055) / 1.055) ** 2.4
    shown = linear * np.array(cloth["pbrMetallicRoughness"]["baseColorFactor"][:3])
    wanted = ((np.array([0.7, 0.2, 0.1]) + 0.055) / 1.055) ** 2.4
    assert shown == pytest.approx(wanted, rel=0.03)


def test_wrong_precision_and_maps_are_named(tmp_path: Path) -> None:
    with pytest.raises(SimCoreError, match="precision"):
        write_glb(tmp_path / "g.glb", [Clothed(arched(0.05), plain_maps(120))], precision="middle")  # pyright: ignore[reportArgumentType]
    wrong = Maps(plain_maps(120).albedo, plain_maps(120).normal, np.zeros((4, 4), np.uint8), (0.004, 0.004))
    with pytest.raises(SimCoreError, match="maps"):
        write_glb(tmp_path / "g.glb", [Clothed(arched(0.05), wrong)])
    assert not (tmp_path / "g.glb").exists()


def picture_of(document: dict, blob: bytes, reference: dict) -> np.ndarray:
    """The picture that a texture reference of a material names, as it is stored."""
    view = document["bufferViews"][
        document["images"][document["textures"][reference["index"]]["source"]]["bufferView"]
    ]
    start = view.get("byteOffset", 0)
    return np.asarray(Image.open(BytesIO(blob[start : start + view["byteLength"]])))


@pytest.fixture(scope="module")
def lozenges() -> FiguredMaps:
    """A figured silk of small lozenges, of one colour."""
    told = Weave.load(Path(__file__).parents[2] / "assets" / "weaves" / "lozenge-qi.toml").to_dict()
    told["figure"]["parameters"] = [["width", 10.0], ["height", 16.0], ["lines", 2.0]]
    weave = Weave.from_dict(told)
    return figured_maps(weave, solve(weave), pixels=256)


@pytest.mark.parametrize("precision", ["close", "hall"])
def test_a_figured_silk_shows_its_repeat_and_the_way_it_gleams(tmp_path: Path, precision, lozenges) -> None:
    write_glb(tmp_path / "g.glb", [Clothed(arched(0.04), lozenges)], precision=precision)
    document, blob = chunks(tmp_path / "g.glb")
    cloth = document["materials"][0]
    gleam = cloth["extensions"]["KHR_materials_anisotropy"]
    across = picture_of(document, blob, gleam["anisotropyTexture"])[..., :2] / 127.5 - 1
    assert np.abs(np.linalg.norm(across, axis=2) - 1).max() < 0.02
    # Neighbours that run alike are not told in opposite ways: filtered, they would cancel.
    beside = (across * np.roll(across, 1, axis=1)).sum(axis=2)
    assert (beside < -0.9).mean() < 0.002
    assert set(cloth["extensions"]) <= set(document["extensionsUsed"])
    tile = [1 / (1e3 * side) for side in lozenges.size]
    colour = cloth["pbrMetallicRoughness"]["baseColorTexture"]
    assert colour["extensions"]["KHR_texture_transform"]["scale"] == pytest.approx(tile)
    extras = cloth.get("extras", {}).get("silk")
    if precision == "hall":
        assert extras is None
        return
    assert extras["repeat"] == pytest.approx(list(lozenges.size))
    assert extras["cells"] == [pytest.approx(list(cell.size)) for cell in lozenges.cells]
    lacquer = cloth["extensions"]["KHR_materials_clearcoat"]
    assert lacquer["clearcoatFactor"] == 0  # seen by nobody but our page
    number = picture_of(document, blob, lacquer["clearcoatTexture"])
    np.testing.assert_array_equal(number, lozenges.crossings[::-1])
    assert len(document["images"]) == 6  # colour, normal, gleam, number, two cells


@pytest.mark.parametrize("dye", [(0.2, 0.3, 0.6), (0.95, 0.9, 0.85), (0.1, 0.05, 0.05)])
def test_a_dye_is_the_mean_colour_whatever_the_cloth_was_woven_in(tmp_path: Path, dye, lozenges) -> None:
    garment = arched(0.04)
    dyed = replace(garment, dyes=(dye,) * len(garment.panels))
    write_glb(tmp_path / "g.glb", [Clothed(dyed, lozenges)], precision="close")
    document, blob = chunks(tmp_path / "g.glb")
    surface = document["materials"][0]["pbrMetallicRoughness"]
    picture = picture_of(document, blob, surface["baseColorTexture"]) / 255
    light = np.where(picture <= 0.04045, picture / 12.92, ((picture + 0.055) / 1.055) ** 2.4)
    shown = light.mean((0, 1)) * surface["baseColorFactor"][:3]
    wanted = np.array([c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in dye])
    assert shown == pytest.approx(wanted, rel=0.12)  # of what is brighter than white a little is cut off
