"""What a cantilever on regular and irregular meshes errs by, part by part: the patches, free sides, and the clamp.

    python tests/bench/cloth_cantilever.py [--quick] [--readme]

Every strip is 40 mm wide and of 100 mm free length, bent without Poisson's effect (`tests/bent_strips.py`). "alone":
the patches as `bending.py` has them, "balanced": as `balance.py` changes them; lattices of rows are balanced here,
which `Sheet.of` does not. --readme writes the table into the room's DETAILS.md.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from bent_strips import MESHES, cantilever, elastica_curve, gives_way, sag, sheet_of_strip, tip_of  # noqa: E402

from sim_core.cloth import Material, Sheet  # noqa: E402

DETAILS = Path(__file__).parents[2] / "sim_core" / "cloth" / "DETAILS.md"
BEGIN, END = (
    "<!-- cantilever: python tests/bench/cloth_cantilever.py --readme -->",
    "<!-- end of cantilever -->",
)
EDGES = (0.005, 0.0025, 0.00125)
FREE, WIDTH, DENSITY = 0.1, 0.04, 0.15
BEND = DENSITY * 9.81 * FREE**3 / 8
CLOTH = Material(DENSITY, 3e3, 0.0, BEND)
HEAD = (
    "| mesh | edge | inside, alone | balanced | with free sides, alone | balanced | small sag, alone | balanced "
    "| heavy elastica: end off, alone | balanced | balanced, pins alone hold it |",
    "|-|-|-|-|-|-|-|-|-|-|-|",
)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="the coarsest edge only")
    parser.add_argument("--readme", action="store_true", help="write the table into the room's DETAILS.md")
    args = parser.parse_args()
    lines = list(HEAD)
    for name in MESHES:
        for edge in EDGES[:1] if args.quick else EDGES:
            lines.append(row(name, edge))
            print(lines[-1], flush=True)
    if args.readme:
        head, rest = DETAILS.read_text("utf-8").split(BEGIN)
        DETAILS.write_text(head + BEGIN + "\n" + "\n".join(lines) + "\n" + END + rest.split(END)[1], "utf-8")
    return 0


def row(name: str, edge: float) -> str:
    mesh = MESHES[name](FREE + 0.02, WIDTH, edge)
    alone, balanced = (sheet_of_strip(mesh, CLOTH, balanced=way) for way in (False, True))
    cells = [name, f"{1e3 * edge:g} mm"]
    for part in (inside, with_sides):
        cells += [f"{100 * max(0.0, part(sheet, edge)):.2f} %" for sheet in (alone, balanced)]
    cells += [f"{100 * sag(sheet, 0.02):+.2f} %" for sheet in (alone, balanced)]
    cells += [f"{heavy(sheet, clamped=False):.2f} mm" for sheet in (alone, balanced)]
    cells.append(f"{heavy(balanced, clamped=True):.2f} mm")
    return "| " + " | ".join(cells) + " |"


def inside(sheet: Sheet, edge: float) -> float:
    """The share of its energy that it gives way by, bent along the strip, its whole rim held."""
    deep = 3.2 * edge
    size = sheet.rest.max(0)
    held = ((sheet.rest < deep) | (sheet.rest > size - deep)).any(1)
    return gives_way(sheet, np.diag([1.0, 0.0]), held, float(np.prod(size - 2 * deep)))


def with_sides(sheet: Sheet, edge: float) -> float:
    """The same, its two ends held."""
    length = sheet.rest[:, 0].max()
    held = (sheet.rest[:, 0] < 0.02) | (sheet.rest[:, 0] > length - 0.02)
    return gives_way(sheet, np.diag([1.0, 0.0]), held, (length - 0.04) * WIDTH)


def heavy(sheet: Sheet, *, clamped: bool) -> float:
    """How far [mm] the end is from the elastica of rho g L^3 / B = 8.

    clamped: what lies up to 20 mm is pinned flat and the elastica begins there. Else it begins at 0, of 120 mm, and
    pins hold the first 20 mm as it runs: no clamp errs.
    """
    length = FREE if clamped else sheet.rest[:, 0].max()
    curve = elastica_curve(BEND, DENSITY, length)
    clamp = 0.02 if clamped else 0.0
    x = cantilever(sheet, curve, sheet.rest[:, 0] <= 0.02 + 1e-9, clamp)
    return float(1e3 * np.linalg.norm(tip_of(sheet, x) - curve[1][-1] - [clamp, 0.0]))


if __name__ == "__main__":
    sys.exit(main())
