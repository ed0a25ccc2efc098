"""The cheapest mesh and scheme whose measured error stays within a budget, from the table the bench makes.

`fidelity.json` holds, scene by scene, meshes from coarse to fine with their error against the finest (mesh and time
error together, mean over the vertices, at a stated time before chaos) and their cost. An error of another sheet is
read off at the same edge length and taken SAFETY times, because pins, sizes and materials differ.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from sim_core.errors import WrongArgument

FILE = Path(__file__).with_name("fidelity.json")
SAFETY = 4.0


@dataclass(frozen=True)
class Choice:
    """What to run: edge [m], vertices, integrator; its expected error [mm] and cost [ms a frame]; why in words."""

    edge: float
    vertices: int
    integrator: str
    error_mm: float
    ms: float
    why: str


@lru_cache(maxsize=1)
def table() -> dict[str, Any]:
    """The shipped table: per scene `seconds`, `area` [m2] and rows of edge_mm, integrator, substeps, error_mm, ms."""
    return json.loads(FILE.read_text("utf-8"))


def choose(scene: str, *, error_mm: float, area: float | None = None) -> Choice:
    """The cheapest row of the table within `error_mm` [mm, mean over the vertices] for a sheet of `area` [m2].

    area: the scene's own if left out. Raises WrongArgument for a scene the table does not know, and for a budget
    that not even its finest mesh keeps.
    """
    known = table()
    if scene not in known:
        raise WrongArgument(f"error: no table for {scene!r} – there is one for {', '.join(sorted(known))}")
    if not (math.isfinite(error_mm) and error_mm > 0):
        raise WrongArgument(f"error {error_mm} mm – a budget is above 0")
    part = known[scene]
    area = float(part["area"]) if area is None else area
    rows = sorted(part["rows"], key=lambda r: r["ms"])
    within = [r for r in rows if SAFETY * r["error_mm"] <= error_mm]
    if not within:
        least = SAFETY * min(r["error_mm"] for r in rows)
        raise WrongArgument(f"error {error_mm} mm – the finest mesh in the table keeps {least:.2g} mm")
    best = within[0]
    edge = best["edge_mm"] / 1000
    count = round(area * 2 / math.sqrt(3) / edge**2)
    why = (
        f"edges of {best['edge_mm']:g} mm, {best['integrator']}: measured error {best['error_mm']:.2g} mm after "
        f"{part['seconds']:g} s, taken {SAFETY:g} times; the next cheaper row "
    )
    cheaper = [r for r in rows if r["ms"] < best["ms"]]
    why += f"has {cheaper[-1]['error_mm']:.2g} mm" if cheaper else "does not exist"
    return Choice(edge, count, best["integrator"], best["error_mm"], best["ms"] * area / part["area"], why)
