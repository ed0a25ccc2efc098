"""Contact sheet of all shipped weaves, Figure 1, and the plot of speed against error.

python tests/bench/bench_weave.py --sheet docs/pictures/weaves.jpg
"""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from sim_core.errors import WeaveError
from sim_core.weave import ParticleCell, Weave, lit_cloth, solve, surface_maps
from sim_core.weave.figure1 import figure_one, figure_one_picture
from sim_core.weave.words import weave_of

FOLDER = Path(__file__).parents[2] / "assets" / "weaves"
SIDE, COLUMNS = 300, 4


def draw(path: Path) -> None:
    """The lit face of every weave of assets/weaves, its file's name below; beside it figure1 of the paper's route."""
    files = sorted(FOLDER.glob("*.toml"))
    rows = -(-len(files) // COLUMNS)
    sheet = Image.new("RGB", (SIDE * COLUMNS, (SIDE + 18) * rows), (24, 24, 24))
    pen = ImageDraw.Draw(sheet)
    for k, file in enumerate(files):
        weave = Weave.load(file)
        try:
            geometry = solve(weave, particles=True)
        except WeaveError:
            geometry = solve(weave)
        stage = "B" if isinstance(geometry, ParticleCell) else "A"
        maps = surface_maps(weave, geometry, pixels=2 * SIDE)
        picture = Image.fromarray(lit_cloth(maps)).resize((SIDE, SIDE), Image.Resampling.BOX)
        x, y = k % COLUMNS * SIDE, k // COLUMNS * (SIDE + 18)
        sheet.paste(picture, (x, y))
        wide = maps.size[0] * 1e3
        pen.text(
            (x + 4, y + SIDE + 3), f"{file.stem}, {wide:.1f} mm across, stage {stage}", fill=(220, 220, 220)
        )
    path.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(path, quality=88)
    weave, _ = weave_of("twill:2/1")
    picture = figure_one_picture(figure_one(weave, solve(weave, particles=True)))
    Image.fromarray(picture).save(path.with_name(f"{path.stem}-figure1{path.suffix}"), quality=88)


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
