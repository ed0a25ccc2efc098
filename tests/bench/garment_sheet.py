"""Every baked garment from four sides, as it was at an earlier revision and as it is: one sheet.

    python tests/bench/garment_sheet.py [--before REVISION] [--content FOLDER] [--out FILE]

Drawn from the close-up models (baked/close.glb) with the project's own rasteriser: shape, folds and colour, each cloth
in the mean of its texture. Left the front, then every quarter turn; the upper row of each garment is the earlier one.
"""

import argparse
import io
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from hall_app.content.models import open_glb  # noqa: E402
from sim_core.gltf import GlbParts  # noqa: E402
from sim_core.picture import Camera, Surface, lighting, render  # noqa: E402

ANGLES = (18.0, 108.0, 198.0, 288.0)  # [deg] about +y from the front
SIZE = (400, 500)  # [pixels] of one view


def mean_colour(parts: GlbParts, material: dict) -> tuple[float, float, float]:
    """sRGB 0..1: the factor, and the mean of the texture where there is one."""
    shown = material["pbrMetallicRoughness"]
    linear = np.array(shown.get("baseColorFactor", [1, 1, 1, 1])[:3], float)
    if "baseColorTexture" in shown:
        texture = parts.document["textures"][shown["baseColorTexture"]["index"]]
        with Image.open(io.BytesIO(parts.picture(texture["source"]))) as picture:
            linear *= ((np.asarray(picture.convert("RGB")) / 255.0) ** 2.2).mean((0, 1))
    red, green, blue = np.clip(linear, 0, 1) ** (1 / 2.2)
    return float(red), float(green), float(blue)


def surfaces_of(model: Path) -> list[Surface]:
    """What a model shows; vertices that are there twice for their texture become one, so that shading is smooth."""
    parts = open_glb(model)
    document = parts.document
    found = []
    for mesh in document["meshes"]:
        for part in mesh["primitives"]:
            points = parts.numbers(part["attributes"]["POSITION"])
            faces = parts.numbers(part["indices"]).astype(np.int64).reshape(-1, 3)
            _, first, weld = np.unique(np.round(points, 6), axis=0, return_index=True, return_inverse=True)
            faces = weld.reshape(-1)[faces]
            whole = (faces != np.roll(faces, 1, axis=1)).all(1)
            material = document["materials"][part["material"]]
            cloth = "silk" in material["name"]
            look = {"sheen": 0.5} if cloth else {"gloss": 0.1}
            if material.get("alphaMode") == "BLEND":
                look |= {"alpha": 0.6, "through": 0.3}
            colour = mean_colour(parts, material)
            found.append(Surface(points[first], faces[whole].astype(np.int32), colour, **look))
    return found


def views(model: Path) -> np.ndarray:
    """The model from all sides, one beside the other."""
    surfaces = surfaces_of(model)
    high = max(float(surface.vertices[:, 1].max()) for surface in surfaces)
    lit, away = lighting(surfaces), 1.28 * high / (2 * math.tan(math.radians(15)))
    pictures = []
    for angle in ANGLES:
        turn = math.radians(angle)
        eye = (away * math.sin(turn), 0.62 * high, away * math.cos(turn))
        pictures.append(render(surfaces, Camera(eye, (0.0, high / 2, 0.0), 30.0), SIZE, lit=lit))
    return np.concatenate(pictures, axis=1)


def earlier(revision: str, path: Path, folder: Path) -> Path:
    """The file as it was, written into `folder`; raises SystemExit with git's words where it was not."""
    name = f"{revision}:{path.relative_to(ROOT).as_posix()}"
    done = subprocess.run(["git", "show", name], cwd=ROOT, capture_output=True)
    if done.returncode:
        sys.exit(done.stderr.decode().strip())
    (folder / path.name).write_bytes(done.stdout)
    return folder / path.name


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--before", default="8f829c5", metavar="REVISION", help="default: 8f829c5")
    parser.add_argument("--content", type=Path, default=ROOT / "assets", help="where it is now")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "pictures" / "garments-before-after.jpg")
    arguments = parser.parse_args()
    rows = []
    for model in sorted(arguments.content.glob("exhibits/*/baked/close.glb")):
        exhibit, own = model.parents[1].name, model.relative_to(arguments.content)
        with tempfile.TemporaryDirectory() as folder:
            then = earlier(arguments.before, ROOT / "assets" / own, Path(folder))
            for when, shown in ((f"before, {arguments.before}", then), ("now", model)):
                picture = Image.fromarray(views(shown))
                ImageDraw.Draw(picture).text((10, 8), f"{exhibit} - {when}", fill=(40, 30, 25))
                rows.append(np.asarray(picture))
                print(exhibit, when, flush=True)
    Image.fromarray(np.concatenate(rows)).save(arguments.out, quality=84, optimize=True)
    print(arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
