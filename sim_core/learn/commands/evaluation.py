"""`simcore learn evaluate`: rows measured on sequences that are held back."""

from __future__ import annotations

import argparse
import json
import sys
from functools import cache
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

from sim_core.errors import SimCoreError
from sim_core.learn.commands.parts import Takes, in_wind, never_seen, progress, takes_of, weights_of

if TYPE_CHECKING:
    from sim_core.learn.data import Take
    from sim_core.learn.inference import RivalTrained, Trained
    from sim_core.learn.pooling import Pooled
    from sim_core.learn.rows import Measured, Row

__all__ = ["CURVED", "NETWORKS", "PLAIN", "ROWS", "evaluate"]

REFERENCE, COARSE = "reference", "coarse"
PLAIN = (REFERENCE, COARSE, "linear", "biharmonic", "local_frames")
CURVED = ("curvature_linear", "curvature_biharmonic")  # from what the published pooling keeps
NETWORKS = ("mfsr", "mesh_conv", "paper", "ours")
# Physics that is quicker than the reference, on so large a share of its vertices: measured where it is named.
PHYSICS = {"physics": 1.0, "physics_70": 0.7, "physics_50": 0.5, "physics_35": 0.35}
IN_WIND = 100  # frames of a flag in a wind of one's own
ROWS = (*PLAIN, *PHYSICS, *CURVED, *NETWORKS)

Given = dict[str, tuple[Path, "Trained | RivalTrained"]]


def evaluate(args: argparse.Namespace) -> int:
    """Measures rows on the sequences held back."""
    from sim_core.learn.rows import coarse_measured, led_physics, measured, reference

    given = _given(args)
    wanted = args.rows or (*_plain(args), *(row for row in NETWORKS if row in given))
    for row in wanted:
        if row in NETWORKS and row not in given:
            raise SimCoreError(f"--rows {row} – give its --weights, which `simcore learn train` makes")
        if row in CURVED and not args.share:
            raise SimCoreError(f"--rows {row} – it begins with pooled vertices: give --share")
        if (row == COARSE or row in PHYSICS) and args.share:
            raise SimCoreError(f"--rows {row} – with --share no coarse sheet is simulated: leave it out")
    takes = takes_of(args, frames=args.frames)
    if args.wind:
        if args.share:
            raise SimCoreError("--wind – with --share no coarse sheet is simulated: leave it out")
        in_wind(takes, args.wind, args.frames or IN_WIND)
    for path, trained in given.values():
        never_seen(path, trained, takes.test)
    makers, told, found = _Makers(args, takes, given), progress(), {}
    coarse_ms = 0.0 if args.share else median([take.film.coarse_ms for take in takes.test])
    for number, name in enumerate(wanted):

        def share(part: float, words: str, number: int = number) -> None:
            told((number + part) / len(wanted), words)

        share(0.0, name)
        if name == REFERENCE:
            found[name], now = reference(takes.test, args.floor, share)
            coarse_ms = 0.0 if args.share else now
        elif name == COARSE:
            found[name] = coarse_measured(takes.test)
        elif name in PHYSICS:
            found[name] = led_physics(takes.test, PHYSICS[name], args.floor, share)
        else:
            row, tested = makers.made(name)
            found[name] = measured(row, tested, told=share)
    told(1.0, "")
    summary = {
        "scene": args.scene,
        **({"share": args.share} if args.share else {}),
        "tested": [take.name for take in takes.test],
        **({"wind": list(args.wind)} if args.wind else {}),
        "rows": {name: _facts(name, one, coarse_ms) for name, one in found.items()},
        **({"gate": _gate(found, takes.test)} if REFERENCE in found and _claimed(found) else {}),
    }
    sys.stdout.write(json.dumps(summary, indent=2) + "\n" if args.json else _table(summary))
    return 0


def _plain(args: argparse.Namespace) -> tuple[str, ...]:
    """Rows without a network; of reconstruction those of both poolings, but no coarse sheet: none was simulated."""
    return (*(name for name in PLAIN if name != COARSE), *CURVED) if args.share else PLAIN


def _given(args: argparse.Namespace) -> Given:
    """Row -> file and weights. Raises SimCoreError for weights of another scene or another task."""
    found: Given = {}
    for path in args.weights:
        trained = weights_of(path, args.scene, args.share)
        if trained.row in found:
            raise SimCoreError(f"{path}: a second network of the row {trained.row} – give one at a time")
        found[trained.row] = path, trained
    return found


class _Makers:
    """Rows by name, each with the takes it is measured on; poolings are made for who asks for them."""

    def __init__(self, args: argparse.Namespace, takes: Takes, given: Given) -> None:
        self.share, self.takes, self.given = args.share, takes, given

    def made(self, name: str) -> tuple[Row, list[Take]]:
        """The row, and what it is tested on."""
        from sim_core.learn.data import POOLINGS, pooled_takes
        from sim_core.learn.rows import Biharmonic, Linear, LocalFrames, row_of

        gauss, quadric = POOLINGS
        if name in self.given:
            trained = self.given[name][1]
            test = pooled_takes(self.takes.test, trained.pooled) if self.share else self.takes.test
            return row_of(trained), test
        pooling = gauss if name in CURVED else quadric
        kind = name.removeprefix("curvature_")
        if kind == "local_frames":
            return LocalFrames.fitted(self._takes(pooling, "train")), self._takes(pooling, "test")
        return {"linear": Linear, "biharmonic": Biharmonic}[kind](name), self._takes(pooling, "test")

    def _takes(self, pooling: str, part: str) -> list[Take]:
        from sim_core.learn.data import pooled_takes

        own = getattr(self.takes, part)
        return pooled_takes(own, self._pooled(pooling)) if self.share else own

    @cache  # noqa: B019 – it lives as long as the command
    def _pooled(self, pooling: str) -> dict[str, Pooled]:
        from sim_core.learn.data import pooled_by_kind

        return pooled_by_kind(self.takes.train, pooling, self.share)


def _facts(name: str, found: Measured, coarse_ms: float) -> dict[str, Any]:
    if name == REFERENCE:
        return found.told() | {"net_ms": 0.0, "total_ms": round(found.milliseconds, 3)}
    return found.told() | {"total_ms": round(coarse_ms + found.milliseconds, 3)}


def _claimed(found: dict[str, Measured]) -> list[Measured]:
    """Rows whose errors the reference has to be good for: those that are not physics of the fine sheet."""
    return [one for name, one in found.items() if name != REFERENCE and name not in PHYSICS]


def _gate(found: dict[str, Measured], tested: list[Take]) -> dict[str, Any]:
    """Of each sequence how many frames count, were measured, and would be measured of it whole; passed where half of
    each counts, None where too few were measured to say."""
    from sim_core.learn.data import looked_at
    from sim_core.learn.rows import counting

    counts = counting(found[REFERENCE], _claimed(found))
    whole = {take.name: len(looked_at(len(take.film.fine))) for take in tested}
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
