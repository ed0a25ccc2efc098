"""A scan in a running hall: its own colours are on it, and its data page tells what was measured."""

import numpy as np
import pytest
from bench.axe import violations
from bench.browser import enter, soon
from scanned_hall import PIXELS

pytestmark = [pytest.mark.browser, pytest.mark.slow]

VIEW = {"width": 900, "height": 600}
# How many triangles the close-up's meshes have, and whether each has a picture and real light on it.
NEAR = """
() => {
  const found = [];
  window.__viserMutable.nodeRefFromName["/closeup"]?.traverse((mesh) => {
    if (!mesh.isMesh) return;
    const { map, type } = mesh.material;
    found.push({ triangles: mesh.geometry.index.count / 3, side: map?.image.width ?? 0, type });
  });
  return found;
}
"""


@pytest.fixture(scope="module")
def page(chromium, scanned_hall):
    page = chromium.new_page(viewport=VIEW)
    page.asked, page.faults = [], []
    page.on("request", lambda request: page.asked.append(request.url))
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    enter(page, f"{scanned_hall.url}/?lang=en&exhibit=robe")
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=120_000)
    yield page
    page.close()


def test_the_close_up_is_the_textured_model_of_the_scan(page):
    soon(page, lambda: page.evaluate(NEAR))
    found = page.evaluate(NEAR)
    assert len(found) == 1
    assert 2_000 <= found[0]["triangles"] <= 80_000
    assert found[0]["side"] == PIXELS["close"]
    assert found[0]["type"] != "MeshBasicMaterial"
    assert not page.faults
    assert not any("robe.obj" in url or "robe.jpg" in url for url in page.asked)


def test_its_colours_are_seen(page):
    """The coat is painted a dark red with yellow lozenges: both are on the screen, where nothing else is red."""
    from io import BytesIO

    from PIL import Image

    shot = np.asarray(Image.open(BytesIO(page.screenshot())).convert("RGB")).astype(int)[:, :450]
    red, green, blue = shot[..., 0], shot[..., 1], shot[..., 2]
    cloth = (red > 1.6 * green) & (red > 1.6 * blue) & (red > 40)
    figure = (red > 90) & (red > 1.15 * green) & (green > 1.3 * blue)
    assert cloth.mean() > 0.01
    assert figure.mean() > 0.005


def test_the_data_page_tells_how_far_the_models_are_from_the_scan(page):
    page.locator("[data-testid=tab-data]").click()
    page.get_by_text("Scanned and measured").wait_for(timeout=30_000)
    page.get_by_text("Close-up model, deviation, 99th percentile").wait_for(timeout=30_000)
    assert page.get_by_text("Triangles of the scan").is_visible()
    assert violations(page, ".panel") == []
