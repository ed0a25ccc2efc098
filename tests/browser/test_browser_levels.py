"""A model of two levels: the fine one from near, the coarse one from afar; other readers see the fine one alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from bench.browser import soon
from plain_page import plain_page

from hall_app.content.models import read_glb
from sim_core.gltf import GlbFile

pytestmark = [pytest.mark.browser]

EDGE = 3.0  # [m]
SHOWN = """
() => {
  const found = [];
  window.__viserMutable.nodeRefFromName["/exhibits/box"]?.traverse((mesh) => {
    if (mesh.isMesh && mesh.visible && mesh.material.name === "paint" && mesh.scale.x > 0) found.push(mesh.name);
  });
  return found;
}
"""


def two_levels(path: Path) -> None:
    glb = GlbFile()
    fine, coarse = trimesh.creation.icosphere(3, 0.4), trimesh.creation.icosphere(1, 0.4)
    paint = glb.material({"name": "paint", "pbrMetallicRoughness": {"metallicFactor": 0.0}})
    for name, ball in (("fine", fine), ("coarse", coarse)):
        glb.mesh(name, ball.vertices + [0, 0.6, 0], ball.faces.astype(np.int32), paint)
    glb.levels(range(1), range(1, 2), EDGE)
    path.write_bytes(glb.bytes("ball", []))


def test_other_readers_see_the_fine_level_alone(tmp_path):
    path = tmp_path / "box.glb"
    two_levels(path)
    info = read_glb(path)
    assert (info.triangles, info.afar) == (1280 + 80, 80)
    assert np.allclose([info.low, info.high], [[-0.4, 0.2, -0.4], [0.4, 1.0, 0.4]], atol=1e-6)
    mesh = trimesh.load_scene(path).to_mesh()
    assert (mesh.area_faces > 0).sum() == 1280


@pytest.fixture(scope="module")
def page(chromium, tmp_path_factory):
    with plain_page(chromium, tmp_path_factory.mktemp("levels"), two_levels) as page:
        yield page


def test_the_level_follows_the_visitor(page):
    """The box stands at (2.5, 3): seen from 1.7 m, from 7.7 m, and from 1.7 m again."""
    for x, name in ((0.9, "fine"), (-5.2, "coarse"), (0.9, "fine")):
        page.evaluate("(x) => hall.goTo(x, 3.0, -90)", x)
        soon(page, lambda name=name: page.evaluate(SHOWN) == [name])
    assert page.evaluate("() => hall.framesDrawn()") > 0


def test_who_stands_at_the_edge_sees_no_change_to_and_fro(page):
    page.evaluate("() => hall.goTo(0.9, 3.0, -90)")
    soon(page, lambda: page.evaluate(SHOWN) == ["fine"])
    eye = page.evaluate("() => window.__viserMutable.camera.position.toArray()")
    middle = page.evaluate(
        "() => window.__viserMutable.nodeRefFromName['/exhibits/box'].matrixWorld.elements.slice(12, 15)"
    )
    up = eye[1] - middle[1]
    seen = []
    for away in (EDGE * 1.02, EDGE * 0.98, EDGE * 1.06, EDGE * 0.98, EDGE * 0.94):
        beside = float(np.sqrt(away**2 - up**2))
        page.evaluate("(x) => hall.goTo(x, 3.0, -90)", 2.5 - beside)
        page.wait_for_timeout(700)
        seen.append(page.evaluate(SHOWN))
    assert seen == [["fine"], ["fine"], ["coarse"], ["coarse"], ["fine"]]
