"""What `simcore bench cloth` measures of the engine: time and error, mesh error, growth, chaotic horizon, layers.

Times are processor milliseconds of single frames of 1/25 s, of all rounds together: median and quartiles. On a machine
that does other things as well they say more than the clock on the wall.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from cloth_cases import filmed
from cloth_runs import distance, simulate

from sim_core.cloth.scenes import Scene, grid_film, hang_edge, scene
from sim_core.cloth.step import FRAME, Pace
from sim_core.metrics import intersections

Told = Callable[[str], None]
GROWTH_STEPS = 200  # substeps a frame while only their cost counts
LAYERS = 0.003  # [m]


@dataclass(frozen=True)
class Setting:
    """What a scene is run with: integrator, substeps a frame (None: adaptive), share of the stable step, precision."""

    integrator: str = "auto"
    substeps: int | None = None
    courant: float | None = None
    precision: str = "double"

    def pace(self, made: Scene) -> Pace:
        """The pace for a scene, whose own share is taken where none is given."""
        return Pace(self.precision, self.courant or made.courant)

    def told(self, made: Scene) -> str:
        """A few words for people."""
        steps = f"share {self.pace(made).courant:g}" if self.substeps is None else f"{self.substeps} steps"
        kind = "implicit" if self.integrator == "implicit" else self.precision
        return f"{kind}, {steps}"


def spread(frames_ms: Sequence[float]) -> dict[str, float | list[float]]:
    """Median and quartiles of the frames' milliseconds."""
    low, middle, high = np.percentile(frames_ms, (25, 50, 75))
    return {"ms": float(middle), "quartiles_ms": [float(low), float(high)]}


def timed(
    made: Scene,
    seconds: float,
    settings: Sequence[Setting],
    *,
    rounds: int,
    finest: int,
    undamped: bool,
    tell: Told,
) -> dict:
    """Rows of settings, which take turns, with errors against the limit of most substeps.

    The floor is what half of them still changes.
    """
    tell(f"limit at {finest} steps")
    reference = simulate(made, seconds, substeps=finest, undamped=undamped).positions
    floor = distance(simulate(made, seconds, substeps=finest // 2, undamped=undamped).positions, reference)
    runs: dict[Setting, list] = {s: [] for s in settings}
    for turn in range(rounds):
        for s in settings:
            tell(f"{s.told(made)}, round {turn + 1} of {rounds}")
            how = {"substeps": s.substeps, "integrator": s.integrator, "pace": s.pace(made)}
            runs[s].append(simulate(made, seconds, undamped=undamped, **how))
    rows = [
        spread([ms for one in ran for ms in one.frames_ms])
        | {
            "setting": s.told(made),
            "integrator": s.integrator,
            "precision": s.precision,
            "courant": s.pace(made).courant,
            "adaptive": s.substeps is None,
            "own": s == Setting(),
            "substeps": ran[0].substeps,
            "fallbacks": ran[0].fallbacks,
            "error_mm": distance(ran[0].positions, reference),
        }
        for s, ran in runs.items()
    ]
    return {
        "vertices": len(made.positions),
        "seconds": seconds,
        "frames": round(seconds / FRAME),
        "rounds": rounds,
        "reference_substeps": finest,
        "floor_mm": floor,
        "rows": rows,
    }


def meshes(
    make: Callable[[float], Scene],
    size: tuple[float, float],
    seconds: float,
    edges: Sequence[float],
    tell: Told,
) -> dict:
    """Distance of coarser meshes from the finest at the same material points, and the order of convergence.

    The order is that of the steps from mesh to mesh, each of half the edge: it needs no limit. `left_mm`: what the
    finest mesh still errs by, if errors go on falling at the last order (at least 1).
    """
    films, rows = [], []
    for edge in edges:
        tell(f"edges of {1e3 * edge:g} mm")
        made = make(edge)
        film, ms, _ = filmed(made, max(1, round(seconds / FRAME)))
        films.append(grid_film(made.sheet, size, film[-1:])[0])
        rows.append({"edge_mm": 1e3 * edge, "vertices": len(made.positions), "ms": ms})
    steps = [distance(a, b)["mean"] for a, b in zip(films[:-1], films[1:], strict=True)]
    orders = [float(np.log2(a / b)) for a, b in zip(steps[:-1], steps[1:], strict=True)]
    left = steps[-1] / (2 ** max(orders[-1], 1.0) - 1)
    for row, film in zip(rows, films, strict=True):
        row["from_finest_mm"] = distance(film, films[-1])
    return {
        "seconds": seconds,
        "rows": rows,
        "steps_mm": steps,
        "order": orders,
        "left_mm": left,
    }


def growth(counts: Sequence[int], rounds: int, tell: Told) -> dict:
    """Processor microseconds a substep for sheets of more and more vertices, and the exponent of a line through them.

    Meshes take turns; the least of all frames counts, because others may use the machine's memory as well.
    """
    made = [hang_edge(float(np.sqrt(2 / np.sqrt(3) / count))) for count in counts]
    best = [float("inf")] * len(counts)
    for turn in range(rounds):
        for k, one in enumerate(made):
            tell(f"{len(one.positions)} vertices, round {turn + 1} of {rounds}")
            ran = simulate(one, FRAME * (12 if counts[k] < 30_000 else 4), substeps=GROWTH_STEPS)
            best[k] = min(best[k], 1e3 * min(ran.frames_ms) / GROWTH_STEPS)
    rows = [
        {"vertices": len(m.positions), "us": us, "ns_per_vertex": 1e3 * us / len(m.positions)}
        for m, us in zip(made, best, strict=True)
    ]
    line = np.polyfit(np.log([r["vertices"] for r in rows]), np.log([r["us"] for r in rows]), 1)
    return {"rows": rows, "exponent": float(line[0])}


def horizon(seconds: float, vertices: int, tell: Told) -> dict:
    """How far two runs of the flag with steps of dt and dt/2 are apart, as time goes on."""
    tell("runs of 256 and 512 steps a frame")
    made = scene("flag", vertices=vertices)
    films = [filmed(made, round(seconds / FRAME), "explicit", n)[0] for n in (256, 512)]
    apart = [distance(a, b)["mean"] for a, b in zip(*films, strict=True)]
    rows = [
        {"seconds": frame * FRAME, "apart_mm": apart[frame - 1]}
        for frame in (5, 8, 10, 12, 15, 20, 25, 38, 50)
        if frame <= len(apart)
    ]
    gone = [(k + 1) * FRAME for k, gap in enumerate(apart) if gap > 1.0]
    return {"rows": rows, "horizon_s": gone[0] if gone else None}


def layers(cases: Sequence[int], frames: int, vertices: int | None, tell: Told) -> dict:
    """The teapot without and with self-contact: processor milliseconds and what crosses itself at the end."""
    rows = []
    for case in cases:
        for apart in (0.0, LAYERS):
            tell(f"case {case}, {'with' if apart else 'without'}")
            made = scene("teapot", case, frames=frames, vertices=vertices).layered(apart)
            spent = [time.process_time()]
            end = made.drape(on_frame=lambda *_, spent=spent: spent.append(time.process_time()))
            crossed = intersections(end.positions, made.sheet.faces)
            row = {"case": case, "layers_mm": 1e3 * apart, "crossings": crossed, "stretch": end.worst_stretch}
            rows.append(spread((1e3 * np.diff(spent)[1:]).tolist()) | row)
    return {"frames": frames, "vertices": vertices or 3020, "rows": rows}
