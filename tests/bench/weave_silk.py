"""How the shipped silks look: which way they gleam, how a damask's figure stands against its ground, what is open, and
what a repeat of twelve million crossings costs. Part of bench_weave.py."""

from __future__ import annotations

from pathlib import Path
from time import process_time

import numpy as np

from sim_core.weave import Weave, lit_cloth, solve, surface_maps
from sim_core.weave.maps import FiguredMaps, SurfaceMaps, drawn_maps

FOLDER = Path(__file__).parents[2] / "assets" / "weaves"
TILT = np.radians(40)
ACROSS, ALONG = np.array([np.sin(TILT), 0.0, np.cos(TILT)]), np.array([0.0, np.sin(TILT), np.cos(TILT)])
SHADE = np.array([-0.35, 0.5, 0.75])
GLEAMING = ("satin", "satin-8", "twill")
DAMASKS = ("lian-duan", "roundel-ling", "lozenge-qi")
LARGE = {"height": 200.0, "width": 200.0}  # [mm], 4,000 ends x 3,000 picks at 200 x 150 per cm of a fine silk


def mirrored(maps: SurfaceMaps, lamp: np.ndarray, alpha: float = 0.15) -> float:
    """Mean highlight of the normal map alone: GGX of one width, the eye above, no shadows, as the study measured it."""
    normal = maps.normal / 127.5 - 1
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    half = lamp + [0, 0, 1]
    half /= np.linalg.norm(half)
    up = np.clip(normal @ half, 0, 1)
    shine = alpha**2 / (np.pi * (up**2 * (alpha**2 - 1) + 1) ** 2)
    return float((shine * np.clip(normal @ lamp, 0, 1)).mean())


def contrast(maps: FiguredMaps, lamp: np.ndarray) -> float:
    """Luminance of the figure over that of the ground, medians."""
    light = ((lit_cloth(maps, light=tuple(lamp)) / 255) ** 2.2) @ [0.2126, 0.7152, 0.0722]
    return float(np.median(light[maps.number > 0]) / np.median(light[maps.number == 0]))


def measure() -> dict:
    """The figures by topic, each a list of rows."""
    found: dict[str, list[dict]] = {"gleam": [], "damask": [], "open": [], "figured": []}
    for path in sorted(FOLDER.glob("*.toml")):
        weave = Weave.load(path)
        geometry = solve(weave, particles=True)
        maps = drawn_maps(weave, geometry, pixels=1024)
        found["open"].append({"weave": path.stem, "open": 1 - float(maps.opacity.mean()) / 255})
        if path.stem in GLEAMING:
            fine = surface_maps(weave, geometry, pixels=1024)
            ratio = mirrored(fine, ACROSS) / mirrored(fine, ALONG)
            found["gleam"].append({"weave": path.stem, "ratio": ratio})
        if path.stem in DAMASKS and isinstance(maps, FiguredMaps):
            each = {
                name: contrast(maps, lamp)
                for name, lamp in (("across", ACROSS), ("shade", SHADE), ("along", ALONG))
            }
            found["damask"].append({"weave": path.stem, **each})
    found["figured"].append(large())
    return found


def large() -> dict:
    """Processor seconds of a repeat of 4,000 x 3,000 crossings: its draft, its cells, maps of 1,024 to 4,096 pixels."""
    told = Weave.load(FOLDER / "lian-duan.toml").to_dict()
    told["figure"]["parameters"] = [list(pair) for pair in LARGE.items()]
    told |= {"ends_per_m": 20_000.0, "picks_per_m": 15_000.0}
    for side in ("warp", "weft"):
        told[side] |= {
            "diameter": 26e-6,
            "tex": 0.42e-6,
            "stiffness": 0.0,
            "tension": 0.01,
            "flattening": 2.4,
        }
    row: dict = {}
    begin = process_time()
    weave = Weave.from_dict(told)
    row["draft"], row["picks"], row["ends"] = process_time() - begin, *weave.draft.lift.shape
    begin = process_time()
    geometry = solve(weave, particles=True)
    row["cells"], begin = process_time() - begin, process_time()
    for pixels in (1024, 2048, 4096):
        drawn_maps(weave, geometry, pixels=pixels)
    return row | {"maps": process_time() - begin}


def show(found: dict) -> None:
    """Print them."""
    print(f"\n{'highlight, lamp across / along the floats':<44}")
    for row in found["gleam"]:
        print(f"  {row['weave']:<20}{row['ratio']:>8.2f}")
    print(f"{'figure / ground, median luminance':<44}{'across':>8}{'shade':>8}{'along':>8}")
    for row in found["damask"]:
        print(f"  {row['weave']:<42}{row['across']:>8.2f}{row['shade']:>8.2f}{row['along']:>8.2f}")
    print("open: " + ", ".join(f"{row['weave']} {row['open']:.1%}" for row in found["open"]))
    for row in found["figured"]:
        print(
            f"{row['ends']:,} x {row['picks']:,} crossings: draft {row['draft']:.1f} s, cells {row['cells']:.1f} s, "
            f"maps of 1,024, 2,048 and 4,096 pixels {row['maps']:.1f} s"
        )
