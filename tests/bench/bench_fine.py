"""Coarse to fine: an outfit sewn and posed on a coarse mesh and brought to rest on a fine one, against all on the fine
one; prints a table, writes JSON.

    python tests/bench/bench_fine.py [--outfit assets/outfits/beizi.toml] [--edge 0.006] [--coarse 0.015]
        [--kept FOLDER] [--without scatter all-fine] [--json FILE]

Of each way: processor seconds (of its runs, and of all of `dress` with checks and figures), energy at rest (membrane,
bending, weight [J]), points inside what it lies on, crossings of the cloth with itself, area strain, movement a frame
at the end. Then how far the drapes of the outermost layer lie apart, two-sided between surfaces: coarse to fine from
all fine; beside it what a drape scatters by, all fine once more on a mesh 2 % coarser. Garments in --kept are not
dressed again. One process, one core; what is not compiled yet compiles in the first run: let one at --edge 0.03
--coarse 0.06 go first.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sim_core import metrics
from sim_core.cloth.sheet import energies
from sim_core.garment import Garment, dress, garment_sheet, load_outfit

ROOT = Path(__file__).resolve().parents[2]
BESIDE = 1.02  # times the step: another mesh of the same step
SPACING = 0.006  # [m] of the samples that measure the distance of two drapes
GRAVITY = 9.81
WAYS = ("carried", "all-fine", "scatter")


def dressed(way: str, arguments: argparse.Namespace) -> Garment:
    """The outermost layer, dressed one way, or of an earlier bench."""
    edge = arguments.edge * (BESIDE if way == "scatter" else 1.0)
    coarse = arguments.coarse if way == "carried" else edge
    kept = arguments.kept and arguments.kept / f"{arguments.outfit.stem}.{1000 * edge:.2f}mm.{way}.npz"
    if kept and kept.is_file():
        return Garment.load(kept)
    outfit = load_outfit(arguments.outfit).coarser(edge)
    outfit = replace(outfit, layers=tuple(replace(layer, coarse=coarse) for layer in outfit.layers))
    begun = time.process_time()
    garment = dress(outfit, progress=lambda share, label: told(way, share, label))[-1]
    garment = garment.noted(dress_cpu=round(time.process_time() - begun, 1))
    if kept:
        kept.parent.mkdir(parents=True, exist_ok=True)
        garment.save(kept)
    return garment


def told(way: str, share: float, label: str) -> None:
    """How far it is, on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{way:<9} {100 * share:3.0f} % {label:<20}", end="", file=sys.stderr, flush=True)


def figures(garment: Garment) -> dict[str, Any]:
    """What is told of one garment."""
    errors, sheet = garment.provenance["errors"], garment_sheet(garment)
    stretch, bend, _ = energies(sheet.stencil, garment.positions, np.zeros_like(garment.positions))
    weight = GRAVITY * float(sheet.mass @ garment.positions[:, 1])
    return {
        "edge_m": garment.provenance["edge"],
        "vertices": len(garment.positions),
        "cpu_s": garment.provenance["seconds"]["drape_cpu"],
        "dress_cpu_s": garment.provenance["dress_cpu"],
        "substeps": garment.provenance["substeps"],
        "membrane_j": stretch,
        "bending_j": bend,
        "weight_j": weight,
        "inside": sum(errors[f"inside_{what}"] for what in ("vertices", "midpoints", "centroids")),
        "crossings": errors["self_intersections"],
        "strain_p95": errors["area_strain_p95"],
        "strain_max": errors["area_strain_max"],
        "rest_p99_m": errors["rest_p99_m"],
    }


def apart(a: Garment, b: Garment) -> dict[str, float]:
    """Two-sided distance of two drapes [m]."""
    ways = [
        metrics.surface_distance(
            metrics.sample_surface(one.positions, one.faces, SPACING), other.positions, other.faces
        )
        for one, other in ((a, b), (b, a))
    ]
    both = np.concatenate(ways)
    return {
        "mean_m": float(both.mean()),
        "p95_m": float(np.percentile(both, 95)),
        "max_m": float(both.max()),
    }


def row(way: str, one: dict[str, Any]) -> str:
    """A line of the table."""
    return (
        f"{way:<9} {one['vertices']:8d} {one['cpu_s']:7.0f} {one['dress_cpu_s']:7.0f} {one['membrane_j']:9.5f}"
        f" {one['bending_j']:8.5f} {one['weight_j']:8.4f} {one['inside']:6d} {one['crossings']:9d}"
        f" {100 * one['strain_p95']:6.2f}% {100 * one['strain_max']:6.1f}% {1e6 * one['rest_p99_m']:7.1f}"
    )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--outfit", type=Path, default=ROOT / "assets/outfits/beizi.toml")
    parser.add_argument("--edge", type=float, default=0.006, help="[m] mesh step")
    parser.add_argument("--coarse", type=float, help="[m] step it is sewn and posed at; left out: the usual")
    parser.add_argument("--kept", type=Path, help="folder of garments that an earlier bench dressed")
    parser.add_argument("--without", nargs="+", choices=WAYS[1:], default=[])
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    print(
        f"{'':9} {'vertices':>8} {'cpu s':>7} {'in all':>7} {'membrane':>9} {'bending':>8} {'weight J':>8}"
        f" {'inside':>6} {'crossings':>9} {'strain':>7} {'max':>7} {'p99 µm':>7}"
    )
    garments: dict[str, Garment] = {}
    found: dict[str, Any] = {}
    for way in WAYS:
        if way in arguments.without:
            continue
        garments[way] = dressed(way, arguments)
        found[way] = figures(garments[way])
        print(row(way, found[way]), flush=True)
    for way in ("carried", "scatter"):
        if way in garments and "all-fine" in garments:
            found[f"{way}_from_all_fine"] = far = apart(garments[way], garments["all-fine"])
            lengths = ", ".join(f"{name[:-2]} {1000 * value:.1f} mm" for name, value in far.items())
            print(f"{way} from all fine: {lengths}")
    if arguments.json:
        arguments.json.write_text(
            json.dumps({"outfit": arguments.outfit.stem, "ways": found}, indent=1), "utf-8"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
