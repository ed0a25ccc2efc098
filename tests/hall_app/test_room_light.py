"""What the room hands to the light: surfaces with charts, spots, exhibits in the way."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
import shapely
from content_house import make_house
from PIL import Image
from room_font import BLANK, needs_font

from hall_app.check import check
from hall_app.content import load
from hall_app.content.models import difference, open_glb
from hall_app.content.schema import PlanFile
from hall_app.light import SHOULDER, WALL, Sampling, bake_light
from hall_app.room import raise_room
from hall_app.room.bake import bake_room, room_here, room_key, shown_room
from hall_app.room.lighting import exhibit_solids, spots_of, surfaces
from hall_app.room.structure import Regions
from hall_app.room.surface import MATERIALS, linear

ASSETS = Path(__file__).parents[2] / "assets"


@pytest.fixture(scope="module")
def content():
    return load(ASSETS)


@pytest.fixture(scope="module")
def room(content):
    return raise_room(content.plan, content.hall.title, content.exhibits, blank=BLANK)


def test_every_face_of_the_room_has_a_chart_and_exhibits_have_none(room, content, tmp_path):
    solids = exhibit_solids(content, tmp_path)
    found = surfaces(room.patches, solids)
    assert len(solids) == len(content.exhibits)
    assert (found.chart[: room.triangles] >= 0).all()
    assert (found.chart[room.triangles :] == -1).all()
    assert len(found.faces) == room.triangles + sum(len(faces) for _, faces in solids)
    assert set(found.chart[: room.triangles]) == set(range(len(found.density)))
    assert found.faces.max() < len(found.vertices)


def test_charts_keep_lengths(room):
    found = surfaces(room.patches)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        solid = np.linalg.norm(found.vertices[found.faces[:, a]] - found.vertices[found.faces[:, b]], axis=1)
        flat = np.linalg.norm(found.chart_uv[:, a] - found.chart_uv[:, b], axis=1)
        assert np.abs(solid - flat).max() < 2e-6


def test_only_lamps_glow_and_nothing_reflects_more_than_it_gets(room):
    found = surfaces(room.patches)
    materials = np.repeat([p.material for p in room.patches], [len(p.faces) for p in room.patches])
    glowing = found.emission.max(1) > 0
    assert set(materials[glowing]) == {"laylight", "paper", "lantern"}
    assert found.albedo.max() < 1
    assert found.albedo.min() >= 0


def test_exhibits_stand_where_they_stand(content, tmp_path):
    for exhibit, (points, _) in zip(content.exhibits, exhibit_solids(content, tmp_path), strict=True):
        place = exhibit.file.place
        middle = (points.min(0) + points.max(0)) / 2
        assert np.hypot(middle[0] - place.x, middle[2] - place.z) < 0.5
        solid = next(s for s in content.plan.solid if s.id == place.on)
        assert points[:, 1].min() == pytest.approx(solid.height, abs=0.05)


def test_spots_hang_in_the_hall_and_shine_down_on_their_place(content):
    spots, regions = spots_of(content.plan), Regions(content.plan)
    places = [s for s in content.plan.solid if s.kind in ("booth", "dais", "stand")]
    assert len(spots) == len(places)
    for spot in spots:
        x, y, z = spot.position
        ceiling = regions.height_at(x, z)
        assert ceiling is not None
        assert 2.5 < y < ceiling
        assert spot.towards[1] < y - 1
        footprints = [shapely.Point(s.round.x, s.round.z) if s.round else shapely.Point(s.at) for s in places]
        aimed = shapely.Point(spot.towards[0], spot.towards[2])
        assert min(f.distance(aimed) for f in footprints) < 0.1


TONE = 12.0  # ΔE76 between a backdrop as it is seen, by an eye that is used to the walls' light, and its palette tone
WALLS = WALL / linear(MATERIALS["plaster"].colour).mean()
BOOTH = {
    "outline": [[-3, -3], [3, -3], [3, 3], [-3, 3]],
    "height": 4.3,
    "bay": [{"id": "all", "name": {"zh": "厅", "en": "Hall"}, "polygon": [[-3, -3], [3, -3], [3, 3], [-3, 3]]}],
    "laylight": [{"at": [0, 0.5], "size": [3, 3]}],
    "solid": [
        {"id": "b", "kind": "booth", "size": [2.5, 1.6], "at": [0, -2.1], "height": 0.16, "backdrop": "pale"}
    ],
}  # fmt: skip


def tone(colour: np.ndarray, material: str) -> float:
    """ΔE76 of the mean of linear colours (N, 3), as they are seen among the walls, to the material's own."""
    return difference(colour.mean(0) / WALLS, linear(MATERIALS[material].colour))


def test_a_pale_backdrop_keeps_its_tone_under_its_spot(content):
    """Neither its own spot nor the room's light burns it out, nor leaves it in the dark."""
    plan = PlanFile.model_validate(BOOTH)
    room = raise_room(plan, content.hall.title, (), blank=True)
    walls, spots = surfaces(room.patches), spots_of(plan)
    light = bake_light(walls, spots, sampling=Sampling((16, 16, 16)))
    cloth = [k for k, patch in enumerate(room.patches) if patch.material == "pale"]
    assert len(cloth) == 1
    first = sum(len(patch.faces) for patch in room.patches[: cloth[0]])
    high, wide = light.shown.shape[:2]
    x0, y0, x1, y1 = np.round(
        np.r_[light.uv[first : first + 2].min((0, 1)), light.uv[first : first + 2].max((0, 1))]
        * [wide, high, wide, high]
    ).astype(int)
    seen = light.shown[y0:y1, x0:x1].reshape(-1, 3) * linear(MATERIALS["pale"].colour)
    assert tone(seen, "pale") < TONE
    assert np.quantile(seen.max(1), 0.9) < SHOULDER
    assert light.record["rolled_off"] < 0.05


def test_shipped_backdrops_keep_their_tone(content):
    (backdrop,) = {solid.backdrop for solid in content.plan.solid} - {"none"}
    light, uv, faces = shipped_light(f"hall_{backdrop}")
    rng = np.random.default_rng(0)
    corners = uv[faces]
    weights = rng.dirichlet([1, 1, 1], (len(faces), 500))
    at = np.einsum("fnk,fkc->fnc", weights, corners).reshape(-1, 2)
    high, wide = light.shape[:2]
    x, y = np.clip((at * [wide, high]).astype(int), 0, [wide - 1, high - 1]).T
    seen = light[y, x] * linear(MATERIALS[backdrop].colour)
    assert tone(seen, backdrop) < TONE
    assert np.mean(seen.max(1) > SHOULDER) < 0.05


def test_hardly_anything_of_the_shipped_room_burns_out():
    record = json.loads((ASSETS / "room" / "room.json").read_text("utf-8"))
    assert record["light"]["rolled_off"] < 0.05


def shipped_light(mesh: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The shipped light map (H, W, 3) linear, and where a mesh lies in it: (V, 2) and its faces (F, 3)."""
    parts = open_glb(ASSETS / "room" / "room.glb")
    document = parts.document
    material = next(m for m in document["materials"] if m["name"] == "lightmap")
    source = document["textures"][material["pbrMetallicRoughness"]["baseColorTexture"]["index"]]["source"]
    picture = Image.open(io.BytesIO(parts.picture(source))).convert("RGB")
    stored = np.asarray(picture) / 255
    light = 2 * np.where(stored <= 0.04045, stored / 12.92, ((stored + 0.055) / 1.055) ** 2.4)
    primitive = next(m for m in document["meshes"] if m["name"] == mesh)["primitives"][0]
    uv, faces = (
        parts.numbers(primitive["attributes"]["TEXCOORD_1"]),
        parts.numbers(primitive["indices"]),
    )
    return light, uv, faces.reshape(-1, 3).astype(int)


LIT = """
[[laylight]]
at = [0, 0]
size = [3, 3]
[[lantern]]
at = [-2, 2]
"""


@needs_font
@pytest.mark.slow
def test_a_baked_room_carries_its_light_and_is_shown(tmp_path):
    house = make_house(tmp_path / "house")
    with (house / "plan.toml").open("a", encoding="utf-8") as plan:
        plan.write(LIT)
    content, data, told = load(house), tmp_path / "data", []
    target = room_here(content.folder)
    record = bake_room(
        content,
        key=room_key(content),
        target=target,
        work=data / "work",
        data=data,
        progress=lambda share, label: told.append(share),
        rays=(4, 9),
    )
    assert record["light"]["texels"] > 1000
    assert not (data / "work").exists()
    assert told == sorted(told)
    assert told[-1] == 1.0
    shown = shown_room(load(house), data)
    assert shown.baked
    assert check(house) == []
    document = open_glb(target / "room.glb").document
    assert [m["name"] for m in document["meshes"]].count("lightmap") == 1
    environment = np.asarray(Image.open(target / "environment.jpg")).astype(float)
    assert environment[:60].max() > 240  # the laylight above
    assert environment.mean() > 20
    text = (house / "plan.toml").read_text("utf-8")
    (house / "plan.toml").write_text(text.replace("size = [3, 3]", "size = [2, 3]"), "utf-8")
    assert not shown_room(load(house), data).baked
