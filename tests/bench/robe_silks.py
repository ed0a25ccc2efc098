"""One robe in six silks, as the close-up of the page shows it: a contact sheet.

python tests/bench/robe_silks.py [--out docs/pictures/robe-silks.jpg] [--weave NAME …]

The round-collared robe as it is baked, in its own silk, is shown in each cloth: the drape is the same.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT))

from bench.browser import enter, open_browser  # noqa: E402
from bench.pictures import DESK, new_page, open_exhibit  # noqa: E402
from running_hall import running_hall  # noqa: E402

from sim_core.garment import Clothed, Garment, Outfit, load_outfit, opaque, write_glb  # noqa: E402
from sim_core.garment.levels import shown_figure  # noqa: E402
from sim_core.weave import Weave  # noqa: E402

ASSETS = ROOT / "assets"
OUTFIT = ASSETS / "outfits" / "ming-yuanling.toml"
ROBE = ASSETS / "exhibits" / "ming-yuanling" / "baked" / "beneath-1.npz"
SILKS = ("vine-ling", "lian-duan", "cloud-jin", "stripe-juan", "flower-zhuanghua", "cup-luo")
FRAME = (250, 30, 690, 700)  # left, top, right, bottom of the robe in the close-up
FOOT, COLUMNS = 34, 3
EXHIBIT = """\
title = {{ zh = "{name}", en = "{name}" }}
caption = {{ zh = "{name}", en = "{name}" }}
behaviours = ["open_on_click"]
thumbnail = "media/drawing.jpg"
licence = "CC0-1.0"
[place]
x = {x}
z = 6.0
facing = 0.0
[models]
hall = "media/hall.glb"
close = "media/close.glb"
[body]
shape = "round"
radius = 0.3
height = 1.6
"""


def wearer_of(outfit: Outfit, robe: Clothed) -> Any:
    """The figure as far as the robe lets it be seen."""
    assert outfit.wearer is not None
    body = outfit.wearer.posed(outfit.pose), outfit.wearer.faces
    return shown_figure(*body, *opaque([robe]), worn=outfit.wearer.worn())


def hang(folder: Path, number: int, name: str, worn: tuple[Outfit, Garment]) -> None:
    """An exhibit of the robe cut from a silk, in the silk's own colours."""
    home = folder / "exhibits" / f"silk-{number}"
    (home / "media").mkdir(parents=True)
    (home / "exhibit.toml").write_text(EXHIBIT.format(name=name, x=-2.5 + number), "utf-8")
    for language in ("zh", "en"):
        (home / f"text.{language}.md").write_text(name, "utf-8")
    shutil.copy(ASSETS / "exhibits" / "mirror" / "media" / "drawing.jpg", home / "media" / "drawing.jpg")
    outfit, garment = worn
    weave = Weave.load(ASSETS / "weaves" / f"{name}.toml")
    cut = replace(
        garment, weave=weave.to_dict(), weaves={}, dye=None, dyes=tuple(None for _ in garment.panels)
    )
    clothed = Clothed.woven(cut, 1024)
    figure = wearer_of(outfit, clothed)
    for precision in ("hall", "close"):
        write_glb(home / "media" / f"{precision}.glb", [clothed], precision=precision, figure=figure)


def shoot(content: Path, count: int, work: Path) -> list[Image.Image]:
    """The close-up of each exhibit."""
    shots = []
    with running_hall(content, work / "hall") as served, open_browser() as browser:
        page = new_page(browser, DESK)
        enter(page, f"{served.url}/?lang=en")
        for number in range(count):
            open_exhibit(page, f"silk-{number}")
            page.evaluate("document.getElementById('hall-ui').style.opacity = '0'")
            page.wait_for_timeout(2500)
            file = work / f"{number}.png"
            page.screenshot(path=file)
            shots.append(Image.open(file).convert("RGB").crop(FRAME))
            page.keyboard.press("Escape")
            page.wait_for_timeout(600)
    return shots


def sheet(shots: Sequence[Image.Image], names: Sequence[str]) -> Image.Image:
    """Beside one another, each with its silk's name."""
    wide, high = shots[0].size
    rows = -(-len(shots) // COLUMNS)
    made = Image.new("RGB", (COLUMNS * wide, rows * (high + FOOT)), (24, 24, 24))
    pen, font = ImageDraw.Draw(made), ImageFont.load_default(20)
    for k, (shot, name) in enumerate(zip(shots, names, strict=True)):
        x, y = k % COLUMNS * wide, k // COLUMNS * (high + FOOT)
        made.paste(shot, (x, y))
        title = tomllib.loads((ASSETS / "weaves" / f"{name}.toml").read_text("utf-8"))["title"]["en"]
        pen.text((x + 12, y + high + 5), title, (230, 226, 216), font)
    return made


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "pictures" / "robe-silks.jpg")
    parser.add_argument("--weave", nargs="+", default=SILKS, metavar="NAME", help="of assets/weaves")
    arguments = parser.parse_args()
    worn = load_outfit(OUTFIT), Garment.load(ROBE)
    with tempfile.TemporaryDirectory() as place:
        work = Path(place)
        content = work / "content"
        shutil.copytree(ASSETS, content, ignore=shutil.ignore_patterns("exhibits"))
        for number, name in enumerate(arguments.weave):
            hang(content, number, name, worn)
        made = sheet(shoot(content, len(arguments.weave), work), arguments.weave)
    made.save(arguments.out, quality=86)
    print(arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
