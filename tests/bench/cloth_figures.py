"""What the turns of peers amount to: errors from their own limit and from ours, ratios, and a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from cloth_sweeps import told

from sim_core.metrics import intersections

NEAR = 2.0  # [mm] mean: how near its own limit a peer's setting has to be to be compared


def distance(a: np.ndarray, b: np.ndarray) -> dict[str, float]:
    """Mean, 99 % and largest distance [mm] of vertices (V, 3); infinite where one is not finite.

    Of films (T, V, 3): those of the frame in which the mean is largest; `end`: the mean in the last.
    """
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        return {"mean": float("inf"), "p99": float("inf"), "max": float("inf")}
    gap = 1e3 * np.linalg.norm(a - b, axis=-1)
    if gap.ndim == 2:
        worst = int(gap.mean(1).argmax())
        return {**distance(a[worst], b[worst]), "end": float(gap[-1].mean())}
    return {"mean": float(gap.mean()), "p99": float(np.percentile(gap, 99)), "max": float(gap.max())}


def crossed(film: np.ndarray, faces: np.ndarray) -> dict[str, int] | None:
    """(edge, face) pairs that pass through each other: the most in a frame of a film (T, V, 3), and in the last.

    None for what is no film, or not finite.
    """
    if film.ndim != 3 or not np.isfinite(film).all():
        return None
    counts = [intersections(frame, faces) for frame in film]
    return {"most": max(counts), "end": counts[-1]}


def cheapest(rows: Sequence[dict], within: float = NEAR) -> dict | None:
    """The row of least milliseconds whose mean distance from its own limit is within so many mm; None: there is none.

    The limit itself is no candidate: its distance from itself says nothing.
    """
    near = [row for row in rows if not row["is_limit"] and row["own"]["mean"] <= within]
    return min(near, key=lambda row: row["cpu_ms"], default=None)


def deciding(kept: Any, engines: Sequence[str]) -> dict[str, list[dict]]:
    """Per engine its cheapest kept setting within NEAR of its limit and the settings beside it in its sweep."""
    found = {}
    for engine in engines:
        peer = engine_summary(kept, engine, None, "default", every=True)
        near = peer and peer.get("cheapest_within_2mm")
        if near:
            order = [s for s in kept.sweeps[engine][:-2]]
            at = order.index(near["setting"]) if near["setting"] in order else len(order)
            found[engine] = [near["setting"], *order[max(at - 1, 0) : at], *order[at + 1 : at + 2]]
    return found


def row_of(
    turns: Sequence[dict],
    own: dict,
    from_ours: dict,
    *,
    is_limit: bool,
    setting: dict,
    mine: str,
    every: bool,
    spent: float | None = None,
) -> dict:
    """Figures of one setting: medians over all frames of all turns, ratios as medians of the turns that have ours.

    mine: the name of our cheapest setting; spent: its median milliseconds in all turns, for turns older than it is.
    Milliseconds are of those turns too, if there are any (every: of all).
    """
    shared = [turn for turn in turns if "ours" in turn]
    turns = turns if every or not shared else shared
    frames = np.concatenate([turn["cpu_ms"] for turn in turns])
    walls = np.concatenate([turn["ms"] for turn in turns])
    ratios, cheap = (
        [float(np.median(t["cpu_ms"]) / np.median(t["ours"][name])) for t in shared if name in t["ours"]]
        for name in ("default", mine)
    )
    if not cheap and shared and spent:
        cheap = [float(np.median(frames) / spent)]
    return {
        "setting": setting,
        "turns": len(turns),
        "cpu_ms": float(np.median(frames)),
        "cpu_ms_quartiles": [float(np.percentile(frames, q)) for q in (25, 75)],
        "wall_ms": float(np.median(walls)),
        "turns_beside_ours": len(shared),
        "ratio": float(np.median(ratios)) if ratios else None,
        "ratio_range": [min(ratios), max(ratios)] if ratios else None,
        "ratio_cheapest": float(np.median(cheap)) if cheap else None,
        "ratio_cheapest_range": [min(cheap), max(cheap)] if cheap else None,
        "own": own,
        "from_ours": from_ours,
        "is_limit": is_limit,
        "build_seconds": turns[0]["build_seconds"],
        "compile_seconds": max(turn["compile_seconds"] for turn in turns),
    }


def engine_summary(
    kept: Any, engine: str, reference: np.ndarray | None, mine: str, *, every: bool = False
) -> dict | None:
    """Rows of one peer with its limit; None: nothing of it was run; {"error"}: it cannot run or has no limit yet.

    reference: our own limit (None: distances from it are those from the peer's); mine: our cheapest setting.
    """
    sweep = [(s, kept.key(engine, s)) for s in kept.sweeps[engine]]
    run = [(s, key) for s, key in sweep if key in kept.turns]
    good = [(s, key) for s, key in run if "error" not in kept.turns[key][0]]
    if not good:
        return {"error": kept.turns[run[0][1]][0]["error"]} if run else None
    if any(key not in kept.turns for _, key in sweep[sweep.index(good[-1]) :]):
        return {"error": f"its limit, {told(sweep[-1][0])}, has not been run – run the bench again"}
    ends, turns = [kept.end(key) for _, key in good], own_turns(kept, mine)
    spent = float(np.median(np.concatenate(turns))) if turns else None
    reference = ends[-1] if reference is None else reference
    rows = [
        row_of(
            kept.turns[key],
            distance(end, ends[-1]),
            distance(end, reference),
            is_limit=key == good[-1][1],
            setting=setting,
            mine=mine,
            every=every,
            spent=spent,
        )
        for (setting, key), end in zip(good, ends, strict=True)
    ]
    floor = distance(ends[-2], ends[-1]) if len(ends) > 1 else None
    for row, end in zip(rows, ends, strict=True):
        row["crossings"] = crossed(end, kept.faces)
    found = cheapest(rows)
    candidates = [r for r in rows if not r["is_limit"]]
    rested = min(
        (r for r in candidates if r["own"].get("end", np.inf) <= NEAR),
        key=lambda r: r["cpu_ms"],
        default=None,
    )
    best = min(candidates, key=lambda r: r["own"]["mean"], default=None)
    return {
        "version": kept.turns[good[-1][1]][0]["version"],
        "limit": told(good[-1][0]),
        "floor": floor,
        "limit_from_ours": distance(ends[-1], reference),
        "rows": rows,
        "cheapest_within_2mm": found,
        "cheapest_at_rest": rested,
        "best": best,
        "refused": [
            {"setting": told(s), "why": kept.turns[k][0]["error"]} for s, k in run if (s, k) not in good
        ],
    }


def own_turns(kept: Any, name: str) -> list[list[float]]:
    """Milliseconds of every frame of one of our settings, turn by turn."""
    return [t["ours"][name] for every in kept.turns.values() for t in every if name in t.get("ours", {})]


def _mine(kept: Any, name: str, run: dict, end: np.ndarray) -> dict:
    """One of our settings: milliseconds of all kept turns, or of this run where there are none."""
    turns = own_turns(kept, name)
    frames = np.concatenate([*turns, *([] if turns else [run["cpu_ms"]])])
    return {
        "name": name,
        "substeps": run["substeps"],
        "turns": len(turns),
        "cpu_ms": float(np.median(frames)),
        "cpu_ms_quartiles": [float(np.percentile(frames, q)) for q in (25, 75)],
        "error": distance(run["positions"], end),
        "crossings": crossed(run["positions"], kept.faces),
    }


def summary(kept: Any, engines: Sequence[str], own: dict[str, dict], runs: Sequence[dict]) -> dict:
    """All figures of a scene, told as a table. own: a run of each of our settings; runs: ours up to the reference."""
    *rows, coarser, finest = runs
    end = finest["positions"]
    settings = [_mine(kept, name, run, end) for name, run in own.items()]
    near = [row for row in settings if row["error"]["mean"] <= NEAR]
    mine = min(near, key=lambda row: row["cpu_ms"], default=settings[0])
    found: dict[str, Any] = {
        "ours": {
            "settings": settings,
            "cheapest_within_2mm": mine,
            "rows": [
                {
                    "substeps": run["substeps"],
                    "cpu_ms": float(np.median(run["cpu_ms"])),
                    "wall_ms": float(np.median(run["ms"])),
                    "error": distance(run["positions"], end),
                }
                for run in rows
            ],
            "floor": distance(coarser["positions"], end),
        },
        "peers": {},
    }
    print(
        f"ours: limit at {finest['substeps']:.0f} steps, floor {found['ours']['floor']['mean']:.1e} mm mean"
    )
    for row in settings + found["ours"]["rows"]:
        error = row["error"]
        print(
            f"    {row.get('name', ''):<14}{row['substeps']:<12.0f}{row['cpu_ms']:>13.1f} ms"
            f"{error['mean']:>40.5f} / {error['p99']:.5f}"
        )
    for engine in engines:
        peer = engine_summary(kept, engine, end, mine["name"])
        if peer is not None:
            found["peers"][engine] = peer
            tell(engine, peer)
    return found


def told_ratio(value: float | None) -> str:
    """A ratio; one that was not measured is a dash."""
    return "–" if value is None else f"{value:.1f}"


def tell(engine: str, peer: dict) -> None:
    """The rows of one peer on standard output."""
    if "error" in peer:
        print(f"{engine}: not compared – {peer['error']}")
        return
    floor = f"{peer['floor']['mean']:.2f} mm" if peer["floor"] else "unknown"
    print(
        f"{engine} ({peer['version']}): limit at {peer['limit']}, the next finer setting {floor} from it, "
        f"itself {peer['limit_from_ours']['mean']:.2f} mm mean from ours"
    )
    print(
        "    setting     turns   cpu ms (quartiles)     x ours, our cheapest     own limit: mean / p99 mm"
        "    ours: mean / p99"
    )
    for r in peer["rows"]:
        low, high = r["cpu_ms_quartiles"]
        own = "the limit" if r["is_limit"] else f"{r['own']['mean']:.3f} / {r['own']['p99']:.3f}"
        print(
            f"    {told(r['setting']):<12}{r['turns']:>3}{r['cpu_ms']:>10.0f} ({low:.0f}–{high:.0f})"
            f"{told_ratio(r['ratio']):>8}{told_ratio(r['ratio_cheapest']):>8}"
            f"{own:>26}{r['from_ours']['mean']:>14.3f} / {r['from_ours']['p99']:.3f}"
        )
    near = peer["cheapest_within_2mm"]
    if near:
        print(
            f"    within 2 mm of its own limit at {told(near['setting'])}: {told_ratio(near['ratio'])} times ours, "
            f"{told_ratio(near['ratio_cheapest'])} times our cheapest within 2 mm"
        )
    elif peer["best"]:
        b = peer["best"]
        print(f"    never within 2 mm; best {b['own']['mean']:.2f} mm mean in {b['cpu_ms']:.0f} ms")
