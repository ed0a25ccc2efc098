"""Contact sheet of all shipped weaves under three lights, Figure 1, and the plot of speed against error.

python tests/bench/bench_weave.py --sheet docs/pictures/weaves.jpg
"""

import tomllib
from pathlib import Path
from unicodedata import normalize

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from sim_core.weave import ParticleCell, Weave, lit_cloth, solve
from sim_core.weave.files import weave_of
from sim_core.weave.maps import (
    FiguredMaps,
    SurfaceMaps,
    drawn_maps,
    figure_one,
    figure_one_picture,
    surface_maps,
)

FOLDER = Path(__file__).parents[2] / "assets" / "weaves"
SIDE, COLUMNS, FOOT, GAP = 132, 4, 40, 4
NEAR, FAR = 2.2, 22.0  # [mm] shown of a weave's yarns, and of one without a figure from farther away
TILT = np.radians(40)
# The eye is above: a lamp tilted across the warp, one at the upper left, and one tilted along the warp.
LIGHTS = ((np.sin(TILT), 0.0, np.cos(TILT)), (-0.35, 0.5, 0.75), (0.0, np.sin(TILT), np.cos(TILT)))


def draw(path: Path) -> None:
    """Every weave of assets/weaves under three lights, its yarns above and its figure below; and Figure 1 beside it."""
    files = sorted(FOLDER.glob("*.toml"))
    wide, high = 3 * (SIDE + GAP) + 3 * GAP, 2 * (SIDE + GAP) + FOOT
    rows = -(-len(files) // COLUMNS)
    sheet = Image.new("RGB", (wide * COLUMNS + GAP, high * rows + GAP), (24, 24, 24))
    pen = ImageDraw.Draw(sheet)
    small, large = ImageFont.load_default(12), ImageFont.load_default(14)
    for k, file in enumerate(files):
        weave = Weave.load(file)
        title = tomllib.loads(file.read_text("utf-8"))["title"]["en"]
        title = normalize("NFKD", title).encode("ascii", "ignore").decode()  # the font has no accents
        geometry = solve(weave, particles=True)
        stage = (
            "particles" if isinstance(getattr(geometry, "cells", [geometry])[0], ParticleCell) else "beams"
        )
        maps = drawn_maps(weave, geometry, pixels=1024)
        far = weave.figure is not None or max(weave.draft.lift.shape) > 16
        shown = 1e3 * (min(weave.size) if weave.figure else max(weave.size)) if far else FAR
        cell = maps.cells[-1] if isinstance(maps, FiguredMaps) else surface_maps(weave, geometry, pixels=1024)
        x, y = k % COLUMNS * wide + GAP, k // COLUMNS * high + GAP
        for column, lamp in enumerate(LIGHTS):
            for row, (what, millimetres) in enumerate(((cell, NEAR), (maps, shown))):
                place = (x + column * (SIDE + GAP), y + row * (SIDE + GAP))
                sheet.paste(swatch(what, lamp, millimetres), place)
        foot = y + 2 * (SIDE + GAP)
        pen.text((x + 1, foot - 2), f"{file.stem}: {title}", fill=(235, 235, 230), font=large)
        below = f"above {NEAR:.1f} mm, below {shown:.0f} mm across; {stage}"
        pen.text((x + 1, foot + 16), below, fill=(165, 165, 160), font=small)
    path.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(path, quality=84)
    weave, _ = weave_of("twill:2/1")
    picture = figure_one_picture(figure_one(weave, solve(weave, particles=True), pixels=300))
    Image.fromarray(picture).save(path.with_name(f"{path.stem}-figure1{path.suffix}"), quality=90)


def swatch(
    maps: SurfaceMaps, lamp: tuple[float, float, float], millimetres: float, side: int = SIDE
) -> Image.Image:
    """A square piece of a lit cloth so many millimetres wide, as wide as high on the loom; side: its pixels."""
    scale = side / millimetres / 1e-3  # pixels a metre
    high, wide = (max(1, round(size * scale)) for size in maps.size[::-1])
    tile = Image.fromarray(lit_cloth(maps, light=lamp)).resize((wide, high), Image.Resampling.BOX)
    picture = Image.new("RGB", (side, side))
    for x in range(0, side, wide):
        for y in range(side - high, -high, -high):
            picture.paste(tile, (x, y))
    return picture


def plot(found: dict, path: Path) -> None:
    """Seconds against the error of the crimp, both on logarithmic axes, drawn without a plotting library."""
    wide, high, edge = 640, 420, 50
    picture = Image.new("RGB", (wide, high), "white")
    pen = ImageDraw.Draw(picture)
    points = {
        "residual 1e-1 to 1e-5 (8 x 8 satin)": [
            (r["seconds"], max(r["error"], 1e-8)) for r in found["residual"]
        ],
        "plain against elastica, P = 8": [
            (r["seconds"], abs(r["error"])) for r in found["plain"] if r["per"] == 8
        ],
        "plain against elastica, P = 16": [
            (r["seconds"], abs(r["error"])) for r in found["plain"] if r["per"] == 16
        ],
    }
    every = np.log10(np.array([p for line in points.values() for p in line]))
    low, high_end = np.floor(every.min(axis=0)), np.ceil(every.max(axis=0))

    def at(point):
        part = (np.log10(point) - low) / np.maximum(high_end - low, 1)
        return edge + part[0] * (wide - 2 * edge), high - edge - part[1] * (high - 2 * edge)

    pen.rectangle((edge, edge, wide - edge, high - edge), outline="black")
    for axis in (0, 1):
        for power in range(int(low[axis]), int(high_end[axis]) + 1):
            mark = 10.0 ** np.where(np.arange(2) == axis, power, low)
            x, y = at(mark)
            pen.text((x - 10, y + 4) if axis == 0 else (4, y - 6), f"1e{power}", fill="black")
    for colour, (name, line) in zip(("#b03030", "#2050a0", "#208040"), points.items(), strict=True):
        for point in line:
            x, y = at(np.array(point))
            pen.ellipse((x - 4, y - 4, x + 4, y + 4), fill=colour)
        pen.text((edge + 8, edge + 6 + 14 * list(points).index(name)), name, fill=colour)
    pen.text((wide // 2 - 60, high - 18), "seconds (one core)", fill="black")
    pen.text((4, 20), "error of the crimp", fill="black")
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.save(path)
