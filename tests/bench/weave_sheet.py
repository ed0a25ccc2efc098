"""Contact sheet of all shipped weaves, Figure 1, and the plot of speed against error.

python tests/bench/bench_weave.py --sheet docs/pictures/weaves.jpg
"""

import tomllib
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from sim_core.weave import ParticleCell, Weave, lit_cloth, solve, surface_maps
from sim_core.weave.files import weave_of
from sim_core.weave.maps import figure_one, figure_one_picture

FOLDER = Path(__file__).parents[2] / "assets" / "weaves"
SIDE, COLUMNS, FOOT = 330, 5, 34
WINDOW = 2.6  # [mm] shown of a weave without a figure; of a figured one, its whole repeat
# A figure in one colour is told from its ground by the gleam of its floats alone: two repeats each way, and a lamp that
# stands across the warp.
ACROSS_WARP = {"light": (-0.75, 0.0, 0.65), "gloss": 0.75}


def draw(path: Path) -> None:
    """The lit face of every weave of assets/weaves in true proportions, its names below; and Figure 1 beside it."""
    files = sorted(FOLDER.glob("*.toml"))
    rows = -(-len(files) // COLUMNS)
    sheet = Image.new("RGB", (SIDE * COLUMNS + 8, (SIDE + FOOT) * rows + 8), (24, 24, 24))
    pen = ImageDraw.Draw(sheet)
    small, large = ImageFont.load_default(13), ImageFont.load_default(15)
    for k, file in enumerate(files):
        weave = Weave.load(file)
        title = tomllib.loads(file.read_text("utf-8"))["title"]["en"]
        geometry = solve(weave, particles=True)
        stage = "particles" if isinstance(geometry, ParticleCell) else "beams"
        picture, wide = swatch(weave, geometry)
        x, y = k % COLUMNS * SIDE + 8, k // COLUMNS * (SIDE + FOOT) + 8
        sheet.paste(picture, (x, y))
        pen.text((x + 2, y + SIDE - 8), f"{file.stem}: {title}", fill=(235, 235, 230), font=large)
        pen.text(
            (x + 2, y + SIDE + 9),
            f"{wide:.1f} mm across, relaxed as {stage}",
            fill=(165, 165, 160),
            font=small,
        )
    path.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(path, quality=90)
    weave, _ = weave_of("twill:2/1")
    picture = figure_one_picture(figure_one(weave, solve(weave, particles=True), pixels=300))
    Image.fromarray(picture).save(path.with_name(f"{path.stem}-figure1{path.suffix}"), quality=90)


def swatch(weave: Weave, geometry) -> tuple[Image.Image, float]:
    """A square piece of the lit cloth, as wide as high on the loom, and how many millimetres that is."""
    side = SIDE - 8
    figured = max(weave.draft.lift.shape) > 16
    one_colour = (
        figured and weave.warp.colour == weave.weft.colour and not (weave.warp_colours or weave.extra)
    )
    many = 2 if one_colour else 1
    window = many * max(weave.size) * 1e3 if figured else WINDOW
    across, up = (1 if figured else max(1, round(WINDOW / 1e3 / size)) for size in weave.size)
    maps = surface_maps(weave, geometry, pixels=1024, repeats=(across, up))
    scale = side / window / 1e-3  # pixels a metre
    high, wide = (max(1, round(size * scale)) for size in maps.size[::-1])
    tile = Image.fromarray(lit_cloth(maps, **ACROSS_WARP) if one_colour else lit_cloth(maps)).resize(
        (wide, high), Image.Resampling.BOX
    )
    picture = Image.new("RGB", (side, side))
    for x in range(0, side, wide):
        for y in range(side - high, -high, -high):
            picture.paste(tile, (x, y))
    return picture, window


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
