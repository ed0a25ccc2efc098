"""The law of a mesh's error through measured scenes, and how far it may be trusted: each scene left out in turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from cloth_cases import EDGES, Case
from cloth_flags import FINE
from scipy.stats import nct, norm

from sim_core.cloth.scenes import TRIAL_EDGES, Asked, law_terms

ORDERS = np.arange(1.0, 2.51, 0.05)
RIDGE = (1e-4, 1e-3, 0.05, 0.3, 0.1)  # mean start and slope, those of the pins beside it, curve: few scenes
CONTENT, CONFIDENCE = 0.99, 0.9  # share of scenes that the margin covers, and how surely, after so few


def tolerance(count: int) -> float:
    """Standard deviations that surely hold CONTENT of a normal population of which there are `count` samples."""
    root = np.sqrt(count)
    return float(nct.ppf(CONFIDENCE, count - 1, norm.ppf(CONTENT) * root) / root)


def own_error(edges: np.ndarray, gaps: np.ndarray) -> tuple[float, float]:
    """Error [mm] of the finest mesh and order, from distances (E - 1,) [mm] of the others from it.

    gap = C (h^p - h0^p) on the four finest; p between 1 and 2.5.
    """
    logs = [np.log(gaps[:4] / (edges[1:5] ** p - edges[0] ** p)) for p in ORDERS]
    best = int(np.argmin([np.std(row) for row in logs]))
    return float(np.exp(logs[best].mean()) * edges[0] ** ORDERS[best]), float(ORDERS[best])


def asked(case: Case) -> Asked:
    """The sheet of a case as `choose` sees it."""
    return Asked(case.name, case.size, case.cloth, case.pins or "", case.wind, case.place)


def limit_known(case: Case) -> bool:
    """Whether finer meshes have a limit: not where points hold a sheet, near which it stretches by log(1 / h)."""
    return case.pins in (None, "edge")


def errors(case: Case, row: dict) -> np.ndarray:
    """Errors [mm] of a scene on all meshes but the reference, never falling; with the reference's own if known."""
    own = row["own_mm"] if limit_known(case) else 0.0
    return np.maximum.accumulate(np.array(row["gap_mm"]) + own)


def fitted(kind: str, scenes: list[tuple[Case, dict]]) -> dict:
    """Laws, cost and range of the measured scenes of a kind."""
    sheets = [asked(case) for case, _ in scenes]
    costs = np.array([s.cost_terms(e) for s in sheets for e in EDGES[kind]])
    spent = np.log([ms for _, row in scenes for ms in row["ms"]])
    seen = [s.traits for s in sheets]
    return calm([row for _, row in scenes]) | {
        "laws": [
            law(
                EDGES[kind],
                [s.pins for s in sheets],
                [row | {"error_mm": errors(case, row)} for case, row in scenes],
                k,
            )
            for k in range(len(TRIAL_EDGES) - 2)
        ],
        "cost": np.round(np.linalg.lstsq(costs, spent, rcond=None)[0], 4).tolist(),
        "measured": {k: [round(f(s[k] for s in seen), 4) for f in (min, max)] for k in seen[0]},
    }


def calm(rows: list[dict]) -> dict:
    """The longest edge [mm] of a flag: one mesh finer than the coarsest at which all watched ones agree.

    One finer, because eight flags are few: of six others three did not agree at the coarsest edge.
    """
    after = [row["after"] for row in rows if "after" in row]
    if not after:
        return {}
    bad = min((a["edge_mm"] for scene in after for a in scene if not a["agree"]), default=np.inf)
    kept = max((a["edge_mm"] for scene in after for a in scene if a["edge_mm"] < bad), default=1e3 * FINE[-1])
    finer = [1e3 * edge for edge in EDGES["flag"] if 1e3 * edge < 0.99 * kept]
    return {"calm_mm": round(max(finer), 2)}


def law(edges: Sequence[float], pins: list[str], scenes: list[dict], k: int) -> dict:
    """The law of the k-th three trial runs: how errors fall from there, and the margin, mesh by mesh.

    Left-out scenes are off by a factor whose logarithm has a mean of about 0 and some spread; the margin covers the
    tolerance limit of such a spread, and all of them. Edges from half the finest trial run's on, as far as measured.
    """
    trial, kinds = TRIAL_EDGES[k + 2], sorted(set(pins))
    first = max(1, edges.index(trial) - 2)
    rows, wanted, whose = [], [], []
    for i, (own, row) in enumerate(zip(pins, scenes, strict=True)):
        held = np.array([float(own == p) for p in kinds])
        for edge, error in list(zip(edges[1:], row["error_mm"], strict=True))[first - 1 :]:
            fine, square = law_terms(edge, trial)
            rows.append([1.0, fine, *held, *(fine * held), square])
            wanted.append(np.log(error / row["trial_gap_mm"][k]))
            whose.append(i)
    a, b, who = np.array(rows), np.array(wanted), np.array(whose)
    many = len(kinds)
    ridge = np.diag([*RIDGE[:2], *(many * [RIDGE[2]]), *(many * [RIDGE[3]]), RIDGE[4]])

    def solved(use: np.ndarray) -> np.ndarray:
        return np.linalg.solve(a[use].T @ a[use] + ridge, a[use].T @ b[use])

    off = np.stack([(b - a @ solved(who != i))[who == i] for i in range(len(scenes))])
    found, spread = solved(who >= 0), np.sqrt((off**2).mean(0))
    measured = np.array(edges[first:])
    offered = np.sort(np.concatenate([measured, np.round(np.sqrt(measured[1:] * measured[:-1]), 5)]))
    worst = np.maximum(tolerance(len(scenes)) * spread, off.max(0))
    margin = np.exp(np.interp(np.log(offered), np.log(measured), worst))
    return {
        "trial_edge_mm": 1e3 * trial,
        "edges_mm": np.round(1e3 * offered, 2).tolist(),
        "pins": {
            p: np.round(found[:2] + found[[2 + j, 2 + many + j]], 4).tolist() for j, p in enumerate(kinds)
        },
        "curve": round(float(found[-1]), 4),
        "margin": np.round(margin, 3).tolist(),
        "left_out": np.round(np.exp(off.max(0)), 3).tolist(),
    }
