"""`simcore learn evaluate`: rows measured on sequences that are held back."""

from __future__ import annotations

import argparse
import json
import sys
from statistics import median
from typing import Any

from sim_core.learn.commands.parts import films_of, never_seen, progress

__all__ = ["PLAIN", "ROWS", "evaluate"]

PLAIN = ("reference", "linear", "biharmonic", "local_frames")
ROWS = (*PLAIN, "mfsr", "mesh_conv", "paper", "ours")


def evaluate(args: argparse.Namespace) -> int:
    """Measures rows on the sequences held back."""
    from dataclasses import replace

    from sim_core.errors import SimCoreError
    from sim_core.learn.data import split
    from sim_core.learn.inference import read_weights
    from sim_core.learn.rows import Biharmonic, Linear, LocalFrames, measured, reference, row_of

    given = {trained.row: (path, trained) for path in args.weights for trained in [read_weights(path)]}
    wanted = args.rows or (*PLAIN, *(row for row in ROWS[len(PLAIN) :] if row in given))
    for row in wanted:
        if row not in PLAIN and row not in given:
            raise SimCoreError(f"--rows {row} – give its --weights, which `simcore learn train` makes")
    films = {
        name: (recipe, replace(film, coarse=film.coarse[: args.frames], fine=film.fine[: args.frames]))
        for name, (recipe, film) in films_of(args).items()
    }
    parts = split([recipe for recipe, _ in films.values()])
    for path, trained in given.values():
        never_seen(path, trained, parts.test)
    tested = [films[recipe.name] for recipe in parts.test]
    makers = {
        "linear": Linear,
        "biharmonic": Biharmonic,
        "local_frames": lambda: LocalFrames.fitted([films[recipe.name] for recipe in parts.train]),
    }
    for row, (_, trained) in given.items():
        made = row_of(trained)
        makers[row] = lambda made=made: made
    told, rows = progress(), {}
    for number, name in enumerate(wanted):

        def share(part: float, words: str, number: int = number) -> None:
            told((number + part) / len(wanted), words)

        if name == "reference":
            found = reference(parts.test, args.floor, share)
            rows[name] = found.told() | {"net_ms": 0.0, "total_ms": round(found.milliseconds, 3)}
            continue
        facts = measured(makers[name](), tested, told=share).told()
        coarse = median([film.coarse_ms for _, film in tested])
        rows[name] = facts | {"total_ms": round(coarse + facts["net_ms"], 3)}
    told(1.0, "")
    summary = {"scene": args.scene, "tested": [recipe.name for recipe in parts.test], "rows": rows}
    sys.stdout.write(json.dumps(summary, indent=2) + "\n" if args.json else _table(summary))
    return 0


def _table(summary: dict[str, Any]) -> str:
    head = (
        f"{'mm':14}{'mean':>8}{'Hausdorff':>11}{'p95':>8}{'normals':>9}{'strain':>8}{'ms':>8}{'whole':>8}\n"
    )
    lines = [f"{summary['scene']}, tested on {', '.join(summary['tested'])}\n", head]
    for name, row in summary["rows"].items():
        lines.append(
            f"{name:14}{row['mean_mm']:8.3f}{row['hausdorff_mm']:11.2f}{row['p95_mm']:8.2f}{row['normal_deg']:8.2f}°"
            f"{row['strain']:8.4f}{row['net_ms']:8.2f}{row['total_ms']:8.2f}\n"
        )
    return "".join(lines)
