"""Exhibits that look to different sides of the hall are lit alike, each by a lamp of its own."""

import io

import numpy as np
import pytest
from bench.browser import at_rest, enter
from bench.picture_pairs import BARE, STANDS
from PIL import Image
from plain_hall import EXHIBIT, write_plain_hall
from running_hall import running_hall

pytestmark = [pytest.mark.browser, pytest.mark.slow]

PLACES = {
    "south": (2.5, 3.0, 0.0),
    "east": (-6.0, 4.5, 90.0),
    "north": (-2.0, -3.0, 180.0),
    "west": (6.0, -3.0, 270.0),
}
BELOW, LEFT = slice(190, 225), slice(145, 160)  # of the picture: its face beside the plaque
ALIKE = 0.12  # of the brightest: stands differ by a little, and so does what a face reflects


@pytest.fixture(scope="module")
def seen(chromium, tmp_path_factory):
    """Side -> mean brightness of the face that looks at whoever stands before it, 0..255."""
    import trimesh
    from trimesh.visual.material import PBRMaterial

    work = tmp_path_factory.mktemp("lamp")
    content = write_plain_hall(work / "content")
    box = trimesh.creation.box((0.5, 1.2, 0.5)).apply_translation((0, 0.6, 0))
    cloth = PBRMaterial(baseColorFactor=(150, 120, 110, 255), metallicFactor=0.0, roughnessFactor=0.9)
    box.visual = trimesh.visual.TextureVisuals(np.zeros((len(box.vertices), 2)), material=cloth)
    told = EXHIBIT.replace(', "turn_slowly"', "")
    home = content / "exhibits" / "box"
    (home / "box.glb").write_bytes(box.export(file_type="glb"))
    for side, (x, z, facing) in PLACES.items():
        there = content / "exhibits" / side
        there.mkdir()
        for file in home.iterdir():
            (there / file.name).write_bytes(file.read_bytes())
        place = f"x = {x}, z = {z}, facing = {facing}"
        (there / "exhibit.toml").write_text(told.replace("x = 2.5, z = 3.0, facing = 0.0", place), "utf-8")
    for file in home.iterdir():
        file.unlink()
    home.rmdir()
    with running_hall(content, work) as hall:
        page = chromium.new_page(viewport={"width": 320, "height": 240})
        enter(page, f"{hall.url}/?lang=en")
        page.add_style_tag(content=BARE)
        stands = page.evaluate(STANDS)
        yield {side: brightness(page, stands[side]) for side in PLACES}
        page.close()


def brightness(page, stand: list[float]) -> float:
    page.evaluate("(there) => hall.goTo(...there)", stand)
    page.wait_for_timeout(1500)
    at_rest(page)
    shot = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"), float)
    return float(shot[BELOW, LEFT].mean())


def test_every_side_is_lit_alike(seen):
    assert max(seen.values()) < 250, "nothing is burnt out"
    assert min(seen.values()) > (1.0 - ALIKE) * max(seen.values()), seen
