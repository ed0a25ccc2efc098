"""`simcore learn evaluate`: rows measured on sequences that are held back."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

from sim_core.errors import SimCoreError
from sim_core.learn.commands.parts import Takes, never_seen, progress, reconstructed, takes_of

if TYPE_CHECKING:
    from sim_core.learn.data import Take
    from sim_core.learn.inference import RivalTrained, Trained
    from sim_core.learn.rows import Measured, Row

__all__ = ["CURVED", "NETWORKS", "PLAIN", "ROWS", "evaluate"]

REFERENCE = "reference"
PLAIN = (REFERENCE, "linear", "biharmonic", "local_frames")
CURVED = ("curvature_linear", "curvature_biharmonic")  # from what the published pooling keeps
NETWORKS = ("mfsr", "mesh_conv", "paper", "ours")
ROWS = (*PLAIN, *CURVED, *NETWORKS)

Given = dict[str, tuple[Path, "Trained | RivalTrained"]]


def evaluate(args: argparse.Namespace) -> int:
    """Measures rows on the sequences held back."""
    from sim_core.learn.rows import measured, reference

    given = _given(args)
    wanted = args.rows or (
        *PLAIN,
        *(CURVED if args.share else ()),
        *(row for row in NETWORKS if row in given),
    )
    for row in wanted:
        if row in NETWORKS and row not in given:
            raise SimCoreError(f"--rows {row} – give its --weights, which `simcore learn train` makes")
        if row in CURVED and not args.share:
            raise SimCoreError(f"--rows {row} – it begins with pooled vertices: give --share")
    takes = takes_of(args, frames=args.frames)
    for path, trained in given.values():
        never_seen(path, trained, takes.test)
    makers, told, found = _makers(args, takes, given), progress(), {}
    for number, name in enumerate(wanted):

        def share(part: float, words: str, number: int = number) -> None:
            told((number + part) / len(wanted), words)

        if name == REFERENCE:
            found[name] = reference(takes.test, args.floor, share)
        else:
            row, tested = makers[name]()
            found[name] = measured(row, tested, told=share)
    told(1.0, "")
    summary = {
        "scene": args.scene,
        **({"share": args.share} if args.share else {}),
        "tested": [take.name for take in takes.test],
        "rows": {name: _facts(args, name, one, takes.test) for name, one in found.items()},
        **({"gate": _gate(found, takes.test)} if REFERENCE in found and len(found) > 1 else {}),
    }
    sys.stdout.write(json.dumps(summary, indent=2) + "\n" if args.json else _table(summary))
    return 0


def _given(args: argparse.Namespace) -> Given:
    """Row -> file and weights. Raises SimCoreError for weights of another scene or another task."""
    from sim_core.learn.inference import read_weights

    found: Given = {}
    for path in args.weights:
        trained = read_weights(path)
        if (own := trained.told.get("scene", args.scene)) != args.scene:
            raise SimCoreError(f"{path}: has learned {own} – give weights of {args.scene}")
        if (own := trained.told.get("share")) != args.share:
            raise SimCoreError(
                f"{path}: trained with --share {own} – evaluate with the same"
                if own
                else f"{path}: trained without --share – leave it out"
            )
        if trained.row in found:
            raise SimCoreError(f"{path}: a second network of the row {trained.row} – give one at a time")
        found[trained.row] = path, trained
    return found


def _makers(
    args: argparse.Namespace, takes: Takes, given: Given
) -> dict[str, Callable[[], tuple[Row, list[Take]]]]:
    """By name, what makes a row and the takes it is measured on."""
    from sim_core.learn.data import POOLINGS
    from sim_core.learn.rows import Biharmonic, Linear, LocalFrames, row_of

    gauss, quadric = POOLINGS
    curved = takes
    if args.share:
        curved, _ = reconstructed(takes, args.share, gauss)
        takes, _ = reconstructed(takes, args.share, quadric)
    return {
        "linear": lambda: (Linear(), takes.test),
        "biharmonic": lambda: (Biharmonic(), takes.test),
        "local_frames": lambda: (LocalFrames.fitted(takes.train), takes.test),
        "curvature_linear": lambda: (Linear(CURVED[0]), curved.test),
        "curvature_biharmonic": lambda: (Biharmonic(CURVED[1]), curved.test),
        **{name: lambda own=trained: (row_of(own), takes.test) for name, (_, trained) in given.items()},
    }


def _facts(args: argparse.Namespace, name: str, found: Measured, tested: list[Take]) -> dict[str, Any]:
    if name == REFERENCE:
        return found.told() | {"net_ms": 0.0, "total_ms": round(found.milliseconds, 3)}
    coarse = 0.0 if args.share else median([take.film.coarse_ms for take in tested])
    return found.told() | {"total_ms": round(coarse + found.milliseconds, 3)}


def _gate(found: dict[str, Measured], tested: list[Take]) -> dict[str, Any]:
    """Of each sequence how many frames count, were measured, and would be measured of it whole; passed where half of
    each counts, None where too few were measured to say."""
    from sim_core.learn.rows import EVERY, counting

    counts = counting(found[REFERENCE], [one for name, one in found.items() if name != REFERENCE])
    whole = {take.name: max(1, len(take.film.fine) // EVERY) for take in tested}
    passed = all(2 * count >= whole[name] for name, (count, _) in counts.items())
    may_pass = all(2 * (whole[name] - of + count) >= whole[name] for name, (count, of) in counts.items())
    return {
        "passed": True if passed else None if may_pass else False,
        "sequences": {
            name: {"counting": count, "measured": of, "whole": whole[name]}
            for name, (count, of) in counts.items()
        },
    }


def _table(summary: dict[str, Any]) -> str:
    head = (
        f"{'mm':21}{'mean':>8}{'Hausdorff':>11}{'p95':>8}{'normals':>9}{'strain':>8}{'ms':>8}{'whole':>8}\n"
    )
    share = f" from {summary['share']:g} of the vertices" if "share" in summary else ""
    lines = [f"{summary['scene']}{share}, tested on {', '.join(summary['tested'])}\n", head]
    for name, row in summary["rows"].items():
        lines.append(
            f"{name:21}{row['mean_mm']:8.3f}{row['hausdorff_mm']:11.2f}{row['p95_mm']:8.2f}{row['normal_deg']:8.2f}°"
            f"{row['strain']:8.4f}{row['net_ms']:8.2f}{row['total_ms']:8.2f}\n"
        )
    if gate := summary.get("gate"):
        words = {True: "passed", False: "not passed", None: "not decided: measure more of it (--floor)"}
        counts = ", ".join(
            f"{name} {one['counting']} of {one['whole']}" for name, one in gate["sequences"].items()
        )
        lines.append(
            f"gate {words[gate['passed']]}; frames whose floor is a third of every error: {counts}\n"
        )
    return "".join(lines)
