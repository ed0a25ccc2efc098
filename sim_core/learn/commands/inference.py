"""`simcore learn infer`: a coarse sheet simulated, or brought along, and made fine frame by frame."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sim_core.errors import FileProblem, SimCoreError
from sim_core.learn.commands.parts import progress, weights_of
from sim_core.validation.files import check_target, read_npz, written_whole

if TYPE_CHECKING:
    from sim_core.learn.data import Recipe

__all__ = ["infer"]


def infer(args: argparse.Namespace) -> int:
    """Writes the coarse and the fine film."""
    from sim_core.learn.data import DESIGNS, Pair, coarse_film, recipes
    from sim_core.learn.rows import followed, row_of

    check_target(args.out)
    if args.case > DESIGNS[args.scene].sequences:
        raise SimCoreError(f"--case: {args.case} – there are 1 to {DESIGNS[args.scene].sequences}")
    row = row_of(weights_of(args.weights, args.scene))
    recipe: Recipe = recipes(args.scene, frames=args.frames, seed=args.seed)[args.case - 1]
    told, coarse_ms = progress(), 0.0
    if args.coarse is None:
        told(0.0, "coarse")
        film, coarse_ms = coarse_film(recipe)
        coarse = film[1 + recipe.run_in :].astype(np.float32)
    else:
        coarse = _brought(args.coarse)
    pair, frames, spent = Pair.of(recipe), [], []
    for number, (fine, seconds) in enumerate(followed(row, pair, coarse)):
        frames.append(fine.astype(np.float32))
        spent.append(seconds)
        if number % 25 == 0:
            told(number / len(coarse), "fine")
    told(1.0, "")
    fine, faces, fine_faces = np.stack(frames), pair.coarse.faces, pair.fine.faces
    with written_whole(args.out) as stream:
        np.savez_compressed(stream, coarse=coarse, fine=fine, coarse_faces=faces, fine_faces=fine_faces)
    net_ms = 1000.0 * float(np.median(spent))
    facts = {
        "scene": args.scene,
        "case": args.case,
        "frames": len(fine),
        "coarse_vertices": coarse.shape[1],
        "fine_vertices": fine.shape[1],
        "coarse_ms": round(coarse_ms, 3),
        "net_ms": round(net_ms, 3),
        "total_ms": round(coarse_ms + net_ms, 3),
        "file": str(args.out),
    }
    sys.stdout.write(json.dumps(facts, indent=2) + "\n" if args.json else _words(facts))
    return 0


def _brought(path: Path) -> np.ndarray:
    """The coarse film (T, C, 3) of a file."""
    meant = "an array `coarse` (frames, vertices, 3) [m]"
    found = read_npz(path, ("coarse",), "a coarse film", f"give a file with {meant}")["coarse"]
    if found.ndim != 3 or found.shape[2] != 3 or not len(found):
        raise FileProblem(f"{path}: coarse has shape {found.shape} – {meant} is meant")
    return found


def _words(facts: dict[str, Any]) -> str:
    coarse = f"{facts['coarse_ms']:.2f} ms coarse, " if facts["coarse_ms"] else ""
    return (
        f"{facts['file']}: {facts['frames']} frames of {facts['scene']}, {facts['coarse_vertices']:,} vertices made "
        f"{facts['fine_vertices']:,}; a frame takes {coarse}{facts['net_ms']:.2f} ms by the network\n"
    )
