"""The shipped coat walks: every part of its models goes by the clips that were baked with them."""

import pytest
from bench.browser import PATIENCE, enter, soon, stand_before

pytestmark = [pytest.mark.browser, pytest.mark.nightly]

# A number a mesh of the node that tells where its vertices are.
WHERE = """
async (node) => {
  const {meshesOf} = await import("/static/viser/viser_adapter.js");
  const own = meshesOf(node).filter(({name}) => name && name !== "base");
  return Object.fromEntries(own.map(({name, geometry}) =>
    [name, geometry.attributes.position.array.reduce((sum, value, k) => sum + value * (1 + k % 7), 0)]));
}
"""
# Whether the figure is drawn by the shader that puts it behind its place.
BEHIND = """
async (node) => {
  const {meshesOf, renderer} = await import("/static/viser/viser_adapter.js");
  const figure = meshesOf(node).find(({name}) => name.startsWith("figure"));
  return renderer().properties.get(figure.material).currentProgram?.cacheKey.includes("behind 0.008") ?? false;
}
"""


@pytest.mark.parametrize(("address", "node"), [("", "/exhibits/walking"), ("&exhibit=walking", "/closeup")])
def test_cloth_and_figure_walk_together(shipped_hall, chromium, address, node):
    page = chromium.new_page(viewport={"width": 480, "height": 270})
    enter(page, f"{shipped_hall.url}/?lang=en{address}")
    if not address:
        stand_before(page, "walking")
    page.wait_for_function("(node) => hall.playing().includes(node)", arg=node, timeout=PATIENCE)
    before = page.evaluate(WHERE, node)
    # Coat, its bands, and who wears it; close by its shoes, bodice and trousers are apart.
    assert len(before) == (6 if address else 3)

    def all_moved() -> bool:
        now = page.evaluate(WHERE, node)
        return all(abs(now[name] - before[name]) > 1e-3 for name in before)

    soon(page, all_moved)
    soon(page, lambda: page.evaluate(BEHIND, node))
    page.close()
