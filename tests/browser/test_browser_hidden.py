"""What walls hide is not drawn, and nothing else is left out."""

from __future__ import annotations

import numpy as np
import pytest
from bench.browser import soon
from plain_page import plain_page

pytestmark = [pytest.mark.browser]

HIDES = """
async (cases) => {
  const {hides} = await import("/static/picture/hidden.js");
  return cases.map(([walls, eye, box]) => hides(walls, eye, box));
}
"""
DRAWN = """
(node) => {
  const masks = [];
  window.__viserMutable.nodeRefFromName[node ?? "/exhibits/box"]?.traverse((mesh) => {
    if (mesh.isMesh) masks.push(mesh.layers.mask === 1);
  });
  return masks.length ? masks.some(Boolean) : null;
}
"""
ABOUT = """
async ([kind, [a, b, c]]) => {
  const {boxAbout} = await import("/static/picture/hidden.js");
  const geometry = {boundingSphere: {center: {x: 0, y: 0, z: 0}, radius: 0.5}};
  return boxAbout({...kind, geometry, matrixWorld: {elements: [a, 0, 0, 0, 0, b, 0, 0, 0, 0, c, 0, 1, 1, 1, 1]}});
}
"""
WALL = "[[wall]]\nfrom = [-2.0, 0.0]\nto = [2.0, 0.0]\nthickness = 0.05\n"
TRIANGLES = "() => window.__viserMutable.scene.__r3f.root.getState().gl.info.render.triangles"


@pytest.fixture(scope="module")
def page(chromium, tmp_path_factory):
    """The plain hall: a wall across z = 0 from x = -2 to 2, a box of .4 m radius at (2.5, 3)."""
    with plain_page(chromium, tmp_path_factory.mktemp("hidden")) as page:
        yield page


def seen_by_rays(walls: np.ndarray, eye: np.ndarray, box: np.ndarray, count: int = 24) -> bool:
    """Whether one of count² straight lines from the eye to the box (low x, low z, high x, high z) meets no wall."""
    x, z = np.meshgrid(np.linspace(box[0], box[2], count), np.linspace(box[1], box[3], count))
    ends = np.stack([x.ravel(), z.ravel()], axis=1)

    def side(a, b, p):
        return np.sign((b - a)[..., 0] * (p - a)[..., 1] - (b - a)[..., 1] * (p - a)[..., 0])

    free = np.ones(len(ends), bool)
    for a, b in walls.reshape(-1, 2, 2):
        apart = side(a, b, eye) * side(a, b, ends) < 0
        between = side(eye, ends, a) * side(eye, ends, b) <= 0
        free &= ~(apart & between)
    return bool(free.any())


def test_nothing_that_can_be_seen_is_hidden(page):
    """Random walls, eyes and boxes: what is said to be hidden is met by no free ray, and most of what is gets told."""
    rng = np.random.default_rng(7)
    cases, seen = [], []
    for _ in range(3000):
        walls = rng.uniform(-6, 6, (rng.integers(1, 6), 4))
        if rng.random() < 0.5:  # some that hang together, as walls do
            walls[1:, :2] = walls[:-1, 2:]
        eye, low = rng.uniform(-6, 6, 2), rng.uniform(-6, 6, 2)
        box = np.r_[low, low + rng.uniform(0.2, 2.5, 2)]
        seen.append(seen_by_rays(walls, eye, box))
        told = [[*wall.tolist(), None] for wall in walls]
        cases.append([told, [float(eye[0]), 1.6, float(eye[1])], [*box.tolist(), 1.8]])
    hidden = np.array(page.evaluate(HIDES, cases))
    seen = np.array(seen)
    assert not (hidden & seen).any()
    assert hidden.sum() > 0.5 * (~seen).sum() > 50


@pytest.mark.parametrize(
    ("wall", "eye", "box", "hidden"),
    [
        ([-2, 0, 2, 0, None], [0, 1.6, 3], [-0.5, -3, 0.5, -2, 1.8], True),
        ([-2, 0, 2, 0, None], [0, 1.6, 3], [-0.5, -3, 0.5, -2, 9.0], True),  # it reaches the ceiling
        ([-2, 0, 2, 0, 1.9], [0, 1.6, 3], [-0.5, -3, 0.5, -2, 1.8], True),
        ([-2, 0, 2, 0, 1.7], [0, 1.6, 3], [-0.5, -3, 0.5, -2, 1.8], False),  # its head looks over the wall
        ([-2, 0, 2, 0, 1.9], [0, 2.1, 3], [-0.5, -3, 0.5, -2, 1.8], False),  # the eye does
        ([-2, 0, 2, 0, None], [0, 1.6, 3], [-0.5, 1, 0.5, 2, 1.8], False),  # before the wall
        ([-2, 0, 2, 0, None], [0, 1.6, 3], [-0.5, -1, 0.5, 1, 1.8], False),  # in it
        ([-2, 0, 2, 0, None], [0, 1.6, 3], [2.5, -3, 5.5, -2, 1.8], False),  # beside it
        ([-2, 0, 2, 0, None], [0, 1.6, 0], [-0.5, -3, 0.5, -2, 1.8], False),  # the eye stands in its line
        ([2, 0, -2, 0, None], [0, 1.6, 3], [-0.5, -3, 0.5, -2, 1.8], True),  # drawn the other way round
    ],
)
def test_a_wall_hides_what_stands_behind_it(page, wall, eye, box, hidden):
    assert page.evaluate(HIDES, [[[wall], eye, box]]) == [hidden]


def test_two_walls_that_meet_hide_what_lies_across_their_corner(page):
    walls = [[-2, 0, 0.1, 0.2, None], [0.1, 0.2, 2, 0, None]]
    assert page.evaluate(HIDES, [[walls, [0, 1.6, 3], [-0.5, -3, 0.5, -2, 1.8]]]) == [True]
    apart = [walls[0], [0.15, 0.2, 2, 0, None]]
    assert page.evaluate(HIDES, [[apart, [0, 1.6, 3], [-0.5, -3, 0.5, -2, 1.8]]]) == [False]


def test_the_box_behind_the_wall_costs_nothing_until_one_walks_round_it(page):
    def looks(x: float, z: float) -> int:
        page.evaluate("([x, z]) => hall.goTo(x, z, Math.atan2(x - 2.5, z - 3))", [x, z])
        page.wait_for_timeout(700)
        return page.evaluate(TRIANGLES)

    behind = looks(-1.5, -1.0)
    soon(page, lambda: page.evaluate(DRAWN) is False)
    beside = looks(6.0, -3.0)
    soon(page, lambda: page.evaluate(DRAWN) is True)
    assert 0 < behind < beside
    looks(-1.5, -1.0)
    soon(page, lambda: page.evaluate(DRAWN) is False)


@pytest.mark.parametrize(
    ("old", "new"),
    [("from = [-2.0, 0.0]", "from = [1.9, 0.0]"), ("thickness = 0.05", 'kind = "lattice"'), (WALL, "")],
    ids=["shortened", "a lattice", "the last one"],
)
def test_a_wall_that_is_taken_out_hides_nothing_any_more(page, old, new):
    page.evaluate("() => hall.goTo(-1.5, -1.0, Math.atan2(-4, -4))")
    soon(page, lambda: page.evaluate(DRAWN) is False)
    plan = page.content_folder / "plan.toml"
    text = plan.read_text("utf-8")
    assert old in text
    plan.write_text(text.replace(old, new), "utf-8")
    soon(page, lambda: page.evaluate(DRAWN) is True)
    plan.write_text(text, "utf-8")


def test_of_hall_and_studio_the_one_is_drawn_where_one_is(page):
    """The studio stands half a kilometre to the east: who looks there pays nothing for it, nor in it for the hall."""
    page.evaluate("() => hall.goTo(0.9, 3.0, -Math.PI / 2)")
    soon(page, lambda: page.evaluate(DRAWN) and page.evaluate(DRAWN, "/studio") is False)
    page.evaluate("() => document.querySelector('[data-testid=list]').click()")
    page.locator("[data-testid=list-item-box]").click()
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
    soon(page, lambda: page.evaluate(DRAWN, "/studio") and page.evaluate(DRAWN) is False)
    page.keyboard.press("Escape")
    soon(page, lambda: page.evaluate(DRAWN) and page.evaluate(DRAWN, "/studio") is False)


@pytest.mark.parametrize(
    ("kind", "scales", "reach"),
    [
        ({}, [1, 1, 1], 0.5),
        ({}, [0.1, 1, 3], 1.5),
        ({"isInstancedMesh": True}, [1, 1, 1], None),
        ({"isSkinnedMesh": True}, [1, 1, 1], None),
    ],
)
def test_the_box_about_a_mesh_holds_all_of_it(page, kind, scales, reach):
    """However its node is scaled; where it lies is not told of copies, and of what bones move."""
    box = page.evaluate(ABOUT, [kind, scales])
    if reach is None:
        assert box is None
    else:
        assert np.allclose(np.array(box)[2:4] - box[:2], 2 * reach)
