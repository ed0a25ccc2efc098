"""What is worn beneath is drawn behind what is worn over it: thinned cloth lets it through by a few millimetres."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import trimesh
from bench.browser import soon
from PIL import Image
from plain_page import plain_page

from sim_core.gltf import GlbFile

pytestmark = [pytest.mark.browser]

EYE = 1.6  # [m] from which height a visitor looks
PARTS = (  # node, material, radius [m], colour: each comes 1 mm through what is worn over it
    ("inner", "silk_hall", 0.402, (0.0, 1.0, 0.0)),
    ("inner 2", "silk_hall", 0.3, (0.0, 1.0, 0.0)),
    ("coat", "silk_hall", 0.401, (1.0, 0.0, 0.0)),
    ("figure", "linen", 0.403, (0.0, 0.0, 1.0)),
    ("shoes", "shoes", 0.1, (0.0, 0.0, 1.0)),
    ("inner afar", "silk_hall", 0.402, (0.0, 1.0, 0.0)),
    ("coat afar", "silk_hall", 0.401, (1.0, 0.0, 0.0)),
)
ASKED = """
async ([name, metres]) => {
  const {drawBehind} = await import("/static/picture/behind.js");
  let found = null;
  window.__viserMutable.nodeRefFromName["/exhibits/box"].traverse((mesh) => {
    if (mesh.isMesh && (mesh.userData.name ?? mesh.name) === name) found = mesh.material;
  });
  drawBehind(found, metres);
  return found.userData.behind.value;
}
"""
BEHIND = """
() => {
  const found = {};
  window.__viserMutable.nodeRefFromName["/exhibits/box"]?.traverse((mesh) => {
    if (mesh.isMesh) found[mesh.userData.name ?? mesh.name] = mesh.material.userData.behind?.value ?? 0;
  });
  return found;
}
"""


def balls(path: Path, parts: tuple = PARTS) -> None:
    glb = GlbFile()
    for name, material, radius, colour in parts:
        ball = trimesh.creation.icosphere(3 if "afar" not in name else 2, radius)
        look = {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0}
        paint = glb.material({"name": material, "pbrMetallicRoughness": look})
        glb.mesh(name, ball.vertices + [0, EYE, 0], ball.faces.astype(np.int32), paint)
    if parts is PARTS:
        glb.levels(range(5), range(5, 7), 6.0)
    path.write_bytes(glb.bytes("dressed", []))


@pytest.fixture(scope="module")
def page(chromium, tmp_path_factory):
    with plain_page(chromium, tmp_path_factory.mktemp("behind"), balls) as page:
        yield page


def test_each_layer_lies_behind_those_over_it_and_the_figure_behind_all(page):
    soon(page, lambda: len(page.evaluate(BEHIND)) >= len(PARTS))
    found = page.evaluate(BEHIND)
    assert found["coat"] == found["coat afar"] == 0
    assert 0 < found["inner"] == found["inner 2"] == found["inner afar"] < found["figure"] == found["shoes"]


def test_who_is_drawn_further_behind_as_he_moves_stays_so(page):
    """Of two that ask for it the one that asks for more is heard, whoever comes first."""
    soon(page, lambda: len(page.evaluate(BEHIND)) >= len(PARTS))
    assert page.evaluate(ASKED, ["figure", 0.02]) == 0.02
    assert page.evaluate(ASKED, ["figure", 0.001]) == 0.02


@pytest.mark.parametrize("away", [1.7, 7.7])
def test_what_comes_through_by_two_millimetres_is_not_seen(page, away):
    """In the middle of the balls: at their rim the larger ones are seen, as they should be."""
    page.evaluate("(x) => hall.goTo(x, 3.0, -Math.PI / 2)", 2.5 - away)

    def channels() -> set[int]:
        picture = Image.open(BytesIO(page.screenshot())).convert("RGB")
        x, y = picture.width // 2, picture.height // 2
        middle = picture.crop((x - 5, y - 5, x + 5, y + 5))
        colours = np.asarray(middle, int).reshape(-1, 3)
        return set(colours.argmax(1)) if np.ptp(colours, axis=1).min() > 60 else set()

    soon(page, lambda: channels() == {0})


def test_cloths_on_a_stand_lie_beside_each_other(page):
    hung = tuple(part for part in PARTS if part[1] == "silk_hall" and "afar" not in part[0])
    balls(page.content_folder / "exhibits/box/box.glb", (*hung, ("stand", "lacquer", 0.2, (0.0, 0.0, 1.0))))
    soon(page, lambda: "stand" in page.evaluate(BEHIND))
    page.wait_for_timeout(1000)
    assert set(page.evaluate(BEHIND).values()) == {0}
