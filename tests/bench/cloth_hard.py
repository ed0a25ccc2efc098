"""The hard cases: what breaks other engines, each with what it must keep, and the table of the outcome.

    python tests/bench/cloth_hard.py [--only WORDS] [--long] [--readme]

Every case ends finite, keeps its stretch within 10 % of a reference (analytic, or the same with a quarter of the
step) and 0 samples deeper than a tenth of the clearance in a collider. `unique`: the equilibrium is one, and is
regained within 1 mm; `calm`: kinetic energy goes to zero and no new self-intersections appear. --long adds 100 000
frames at rest (minutes); --readme writes the table into the room's README.
"""

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sim_core import metrics
from sim_core.cloth import (
    Capsule,
    Contact,
    HalfSpace,
    Live,
    Material,
    Phase,
    Sheet,
    Solid,
    Union,
    drape,
)
from sim_core.cloth.mending import mended
from sim_core.cloth.scenes import GF_CM, equilateral_sheet, hang_edge, scene

README = Path(__file__).parents[2] / "sim_core" / "cloth" / "README.md"
BEGIN, END = "<!-- hard cases -->", "<!-- end of hard cases -->"


@dataclass(frozen=True)
class Outcome:
    """What a case came to: kept or not, the rule that applies, figures in words, frames the implicit scheme took."""

    kept: bool
    rule: str
    figures: str
    fallbacks: int = 0


def kinetic(sheet: Sheet, v: np.ndarray) -> float:
    return 0.5 * float((sheet.mass * (v * v).sum(1)).sum())


def longest(sheet: Sheet, x: np.ndarray) -> float:
    ends, rest2 = sheet.stencil.edges, sheet.stencil.length2
    return float(np.sqrt((((x[ends[:, 0]] - x[ends[:, 1]]) ** 2).sum(1) / rest2).max()))


def inside(sheet: Sheet, x: np.ndarray, solid: Solid, clearance: float) -> int:
    samples = np.concatenate([x, x[sheet.edges].mean(1), x[sheet.faces].mean(1)])
    return int((solid.distance(samples) < -0.1 * clearance).sum())


def hung(material: Material = GF_CM, *, gravity: float = 9.81, seconds: float = 3.0) -> Outcome:
    """A sheet that hangs by an edge, against the same with a quarter of the step: stretch and resting place."""
    made = hang_edge(0.05, material=material)
    phases = [Phase(seconds, (gravity, gravity), 5.0)]
    one = drape(made.sheet, made.positions, phases, pins=made.pins)
    fine = 4 * round(one.substeps / one.frames)
    two = drape(made.sheet, made.positions, phases, pins=made.pins, substeps=fine, integrator="explicit")
    a, b = longest(made.sheet, one.positions), longest(made.sheet, two.positions)
    off = 1e3 * np.linalg.norm(one.positions - two.positions, axis=1).max()
    kept = abs(a / b - 1) < 0.1 and abs(one.worst_stretch / two.worst_stretch - 1) < 0.1 and off < 1.0
    figures = f"stretch {one.worst_stretch:.3f} (refined {two.worst_stretch:.3f}), rests {off:.2g} mm off"
    return Outcome(kept, "unique", figures, one.fallbacks)


def stiff(times: float) -> Outcome:
    return hung(replace(GF_CM, stretch=times * GF_CM.stretch))


def started(start: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Outcome:
    """A bad start of the sheet that hangs by an edge: does it come to hang as from the flat start?"""
    made = hang_edge(0.1)
    wild = start(made.positions, made.sheet.rest)
    wild[list(made.pins)] = made.positions[list(made.pins)]
    phases = [Phase(4.0, damping=1.0), Phase(4.0, damping=5.0)]
    one = drape(made.sheet, wild, phases, pins=made.pins)
    calm = drape(made.sheet, made.positions, phases, pins=made.pins)
    end = longest(made.sheet, one.positions) / longest(made.sheet, calm.positions)
    low = 1e3 * (one.positions[:, 1].min() - calm.positions[:, 1].min())
    energy = kinetic(made.sheet, one.velocities)
    kept = bool(np.isfinite(one.positions).all()) and abs(end - 1) < 0.1 and energy < 1e-6
    return Outcome(
        kept, "calm", f"end stretch {end:.3f} of it, KE {energy:.1e} J, hem {low:+.0f} mm", one.fallbacks
    )


def gale(stretch: float) -> Outcome:
    """60 m/s along and across a flag: the stretch of a quarter of the step."""
    cloth = replace(GF_CM, stretch=stretch)
    made = scene("flag", vertices=500, frames=25, wind=(59.0, 0.0, 10.0), cloth=cloth)
    kinds = {"pins": made.pins, "air": made.air}
    one = drape(made.sheet, made.positions, made.phases, **kinds)
    fine = 4 * round(one.substeps / one.frames)
    two = drape(made.sheet, made.positions, made.phases, substeps=fine, integrator="explicit", **kinds)
    kept = abs(one.worst_stretch / two.worst_stretch - 1) < 0.1
    figures = f"stretch {one.worst_stretch:.3f} (refined {two.worst_stretch:.3f})"
    return Outcome(kept, "driven: work is done", figures, one.fallbacks)


def pulled() -> Outcome:
    """A corner torn off at 10 m/s for 0.12 s, then held: the rest follows, and hangs as a calm one does."""
    made = scene("hanging", vertices=400, pins="corners")
    live = Live(made.sheet, made.positions, pins=made.pins, damping=2.0)
    place, worst = made.positions[list(made.pins)].copy(), 1.0
    for frame in range(150):
        if frame < 3:
            place[1] += [0.4 * 0.6, 0.0, -0.4 * 0.8]
        elif frame < 40:
            place[1] -= np.array([0.6, 0.0, -0.8]) * 1.2 / 37
        x = live.step(targets=place)
        worst = max(worst, longest(made.sheet, x))
    energy = kinetic(made.sheet, live.velocities)
    kept = bool(np.isfinite(x).all()) and energy < 1e-2 and longest(made.sheet, x) < 1.5
    return Outcome(
        kept, "calm", f"stretch {worst:.2f} on the way, KE {energy:.1e} J after 6 s", live.fallbacks
    )


def heavy() -> Outcome:
    """Half of the sheet a hundred times as heavy: the stretch of the lower half is what its weight makes it."""
    rest, faces = equilateral_sheet(0.5, 1.0, 0.05)
    light, lead = replace(GF_CM, stretch=4900.0), replace(GF_CM, stretch=4900.0, density=5.0)
    kind = (rest[faces][:, :, 1].mean(1) > 0.5).astype(int)
    sheet = Sheet.of_corners(rest[faces], faces, [light, lead], kind)
    start = np.column_stack([rest[:, 0], -rest[:, 1], np.zeros(len(rest))])
    pins = np.flatnonzero(rest[:, 1] < 1e-9).tolist()
    end = drape(sheet, start, [Phase(2.0, damping=8.0)], pins=pins)
    s = np.linspace(0, 1, 2001)
    load = 9.81 * (np.where(s < 0.5, 0.05 * (0.5 - s), 0.0) + np.where(s < 0.5, 2.5, 5.0 * (1 - s)))
    grown = [np.real(max(np.roots([2450, 0, -2450, -f]), key=np.real)) for f in load]
    sag = float(np.trapezoid(np.array(grown) - 1, s))
    found = -end.positions[rest[:, 1] > 0.999, 1].mean() - 1
    kept = abs(found / sag - 1) < 0.1
    return Outcome(kept, "unique", f"sag {1e3 * found:.2f} mm (analytic {1e3 * sag:.2f})", end.fallbacks)


def broken_mesh(kind: str) -> Outcome:
    """A mesh with a needle, a face without area or double vertices, mended, hangs as the sound one does."""
    rest, faces = equilateral_sheet(0.5, 0.5, 0.05)
    if kind == "needle":  # a vertex 0.1 mm beside the middle of an edge
        face = faces[len(faces) // 2]
        middle = rest[face[:2]].mean(0) * 0.996 + rest[face[2]] * 0.004
        rest = np.vstack([rest, middle])
        new = len(rest) - 1
        keep = [f for f in faces.tolist() if f != face.tolist()]
        a, b, c = (int(i) for i in face)
        faces = np.array([*keep, [b, c, new], [c, a, new], [a, b, new]])
    elif kind == "zero area":
        a, b, _ = faces[3]
        rest = np.vstack([rest, rest[[a, b]].mean(0)])
        faces = np.vstack([faces, [a, b, len(rest) - 1]])
    else:  # every face has corners of its own
        rest, faces = rest[faces].reshape(-1, 2), np.arange(3 * len(faces)).reshape(-1, 3)
    rest, faces, _ = mended(rest, faces)
    sound, sound_faces = equilateral_sheet(0.5, 0.5, 0.05)
    ends = []
    for points, index in ((rest, faces), (sound, sound_faces)):
        sheet = Sheet.of(points, index, GF_CM)
        start = np.column_stack([points[:, 0], -points[:, 1], np.zeros(len(points))])
        pins = np.flatnonzero(points[:, 1] < 1e-9).tolist()
        ends.append(drape(sheet, start, [Phase(2.0, damping=8.0)], pins=pins))
    lows = [end.positions[:, 1].min() for end in ends]
    off = 1e3 * abs(lows[0] - lows[1])
    return Outcome(
        off < 1.0,
        "unique",
        f"hem {off:.2g} mm off, {ends[0].substeps // ends[0].frames} substeps",
        ends[0].fallbacks,
    )


def on_a_spike() -> Outcome:
    """A cloth falls level on a spike of 4 mm over a floor: it stays outside both, and comes to rest."""
    rest, faces = equilateral_sheet(0.4, 0.4, 0.02)
    sheet = Sheet.of(rest, faces, replace(GF_CM, friction=0.6))
    start = np.column_stack([rest[:, 0] - 0.2, np.full(len(rest), 0.27), rest[:, 1] - 0.2])
    spike = Union((Capsule((0, 0, 0), (0, 0.25, 0), 0.004), HalfSpace()))
    contact = Contact(clearance=0.003, thickness=0.002)
    end = drape(
        sheet, start, [Phase(1.0, damping=1.0), Phase(2.0, damping=6.0)], collider=spike, contact=contact
    )
    deep, crossed = inside(sheet, end.positions, spike, 0.003), metrics.intersections(end.positions, faces)
    energy = kinetic(sheet, end.velocities)
    kept = deep == 0 and crossed == 0 and energy < 1e-4
    return Outcome(
        kept, "calm", f"{deep} inside, {crossed} self-intersections, KE {energy:.1e} J", end.fallbacks
    )


def ring(radius: float, thick: float, parts: int = 24) -> Solid:
    angle = 2 * np.pi * np.arange(parts + 1) / parts
    at = [(float(radius * np.cos(a)), 0.0, float(radius * np.sin(a))) for a in angle]
    return Union(tuple(Capsule(p, q, thick) for p, q in zip(at[:-1], at[1:], strict=True)))


def through_a_ring() -> Outcome:
    """A cloth of 0.3 m is drawn by its middle through a ring 9 cm wide, at 0.3 m/s."""
    rest, faces = equilateral_sheet(0.3, 0.3, 0.012)
    sheet = Sheet.of(rest, faces, replace(GF_CM, friction=0.2))
    start = np.column_stack([rest[:, 0] - 0.15, np.full(len(rest), 0.02), rest[:, 1] - 0.15])
    middle = np.argsort(((rest - 0.15) ** 2).sum(1))[:7].tolist()
    hoop = ring(0.051, 0.006)
    contact = Contact(clearance=0.003, thickness=0.002, cap=0.003, speed_limit=3.0)
    live = Live(sheet, start, pins=middle, collider=hoop, contact=contact, damping=4.0)
    place, deep, worst = start[middle].copy(), 0, 1.0
    for _ in range(40):
        place[:, 1] -= 0.012
        x = live.step(targets=place)
        deep, worst = max(deep, inside(sheet, x, hoop, 0.003)), max(worst, longest(sheet, x))
    through = float((x[:, 1] < 0.0).mean())
    crossed = metrics.intersections(x, faces)
    kept = deep == 0 and bool(np.isfinite(x).all()) and through > 0.99
    figures = (
        f"{100 * through:.0f} % through, {deep} inside, {crossed} self-intersections, stretch {worst:.2f}"
    )
    return Outcome(kept, "driven: work is done", figures, live.fallbacks)


def layers(count: int = 10) -> Outcome:
    """Ten sheets fall on each other on a floor: none passes another, all come to rest."""
    rest, faces = equilateral_sheet(0.12, 0.12, 0.02)
    rng, size = np.random.default_rng(5), len(rest)
    flat = np.concatenate([rest + [0.5 * k, 0.0] for k in range(count)])
    index = np.concatenate([faces + size * k for k in range(count)])
    start = np.concatenate(
        [
            np.column_stack([rest[:, 0], np.full(size, 0.004 + 0.005 * k), rest[:, 1]])
            + [*rng.normal(0, 0.004, 2), 0] * np.array([1, 0, 1])
            for k in range(count)
        ]
    )
    sheet = Sheet.of(flat, index, GF_CM)
    contact = Contact(clearance=0.002, sample_clearance=0.001, thickness=0.003)
    phases = [Phase(0.4, damping=2.0), Phase(0.6, damping=10.0)]
    end = drape(sheet, start, phases, collider=HalfSpace(), contact=contact)
    mean = end.positions[:, 1].reshape(count, size).mean(1)
    crossed = metrics.intersections(end.positions, index)
    energy = kinetic(sheet, end.velocities)
    kept = crossed == 0 and bool((np.diff(mean) > 0.0005).all()) and energy < 1e-4
    gap = 1e3 * np.diff(mean).min()
    return Outcome(
        kept, "calm", f"{crossed} intersections, least gap {gap:.2f} mm, KE {energy:.1e} J", end.fallbacks
    )


def twisted() -> Outcome:
    """A tube of cloth, 10 cm wide and 30 long, twisted by a full turn and let go: it untwists, nothing passes."""
    around, along, radius, step = 24, 24, 0.05, 0.0125
    grid = np.arange(around * (along + 1)).reshape(along + 1, around)
    side = 2 * np.pi * radius / around
    faces, corner = [], []
    for row in range(along):
        for c in range(around):
            d = (c + 1) % around
            a, b, e, f = grid[row, c], grid[row, d], grid[row + 1, c], grid[row + 1, d]
            u, w = np.array([c * side, row * step]), np.array([side, 0.0])
            h = np.array([0.0, step])
            faces += [(a, b, f), (a, f, e)]
            corner += [(u, u + w, u + w + h), (u, u + w + h, u + h)]
    faces = np.array(faces)
    sheet = Sheet.of_corners(np.array(corner), faces, [GF_CM], np.zeros(len(faces), int))
    angle = 2 * np.pi * np.arange(around) / around
    circle = np.column_stack([radius * np.cos(angle), 0 * angle, radius * np.sin(angle)])
    start = np.concatenate([circle - [0, k * step, 0] for k in range(along + 1)])
    top, low = grid[0].tolist(), grid[-1].tolist()
    contact = Contact(thickness=0.002, speed_limit=5.0)
    live = Live(sheet, start, pins=[*top, *low], contact=contact, gravity=(0, 0, 0), damping=3.0)
    still, worst = start[[*top, *low]].copy(), 0
    for frame in range(160):
        turn = (
            2 * np.pi * min(1.0, (frame + 1) / 50)
            if frame < 60
            else 2 * np.pi * max(0.0, 1 - (frame - 59) / 50)
        )
        place = still.copy()
        x, z = still[around:, 0], still[around:, 2]
        place[around:, 0], place[around:, 2] = (
            np.cos(turn) * x - np.sin(turn) * z,
            np.sin(turn) * x + np.cos(turn) * z,
        )
        there = live.step(targets=place)
        if frame == 59:
            worst = metrics.intersections(there, faces)
    energy, crossed = kinetic(sheet, live.velocities), metrics.intersections(there, faces)
    kept = bool(np.isfinite(there).all()) and energy < 1e-4 and crossed <= worst
    figures = f"self-intersections {worst} twisted, {crossed} after, KE {energy:.1e} J"
    return Outcome(kept, "calm", figures, live.fallbacks)


def at_rest(frames: int) -> Outcome:
    """15 x 15 vertices hang for so many frames: no creep, no energy."""
    rest, faces = equilateral_sheet(0.35, 0.35 * np.sqrt(0.75), 0.025)
    sheet = Sheet.of(rest, faces, GF_CM)
    start = np.column_stack([rest[:, 0], -rest[:, 1], np.zeros(len(rest))])
    pins = np.flatnonzero(rest[:, 1] < 1e-9).tolist()
    live = Live(sheet, start, pins=pins, damping=5.0)
    for _ in range(250):
        first = live.step()
    for _ in range(frames - 250):
        x = live.step()
    creep, energy = 1e3 * np.abs(x - first).max(), kinetic(sheet, live.velocities)
    kept = creep < 0.1 and energy < 1e-10
    return Outcome(
        kept, "unique", f"creep {creep:.1e} mm, KE {energy:.1e} J in {frames} frames", live.fallbacks
    )


def _noise(x: np.ndarray, rest: np.ndarray) -> np.ndarray:
    return x + np.random.default_rng(4).normal(0, 0.3, x.shape)


def _inverted(x: np.ndarray, rest: np.ndarray) -> np.ndarray:
    return x * [1.0, 1.0, -1.0]


CASES: dict[str, Callable[[], Outcome]] = {
    "stiffness x 1": lambda: stiff(1),
    "stiffness x 10": lambda: stiff(10),
    "stiffness x 100": lambda: stiff(100),
    "anisotropy 100 : 1": lambda: hung(replace(GF_CM, stretch_warp=4900.0, shear=10.0)),
    "Poisson's ratio 0.49": lambda: hung(replace(GF_CM, poisson=0.49)),
    "random start, 0.3 m": lambda: started(_noise),
    "inverted start": lambda: started(_inverted),
    "wind of 60 m/s, soft": lambda: gale(49.0),
    "wind of 60 m/s, stiff": lambda: gale(4900.0),
    "gravity x 10": lambda: hung(gravity=98.1, seconds=6.0),
    "pin pulled at 10 m/s": pulled,
    "mass ratio 100 : 1": heavy,
    "needle triangle": lambda: broken_mesh("needle"),
    "zero-area triangle": lambda: broken_mesh("zero area"),
    "duplicate vertices": lambda: broken_mesh("duplicates"),
    "cloth on a spike": on_a_spike,
    "cloth through a ring": through_a_ring,
    "ten stacked layers": layers,
    "twisted cylinder": twisted,
}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default="", help="cases whose name holds this")
    parser.add_argument("--long", action="store_true", help="100 000 frames at rest as well")
    parser.add_argument("--readme", action="store_true", help="write the table into the room's README")
    args = parser.parse_args()
    cases = dict(CASES)
    cases["at rest"] = lambda: at_rest(100_000 if args.long else 2_000)
    lines = ["| case | kept | rule | figures | implicit frames |", "|-|-|-|-|-|"]
    kept = True
    for name, case in cases.items():
        if args.only in name:
            begin = time.perf_counter()
            found = case()
            kept &= found.kept
            mark = "yes" if found.kept else "**no**"
            lines.append(f"| {name} | {mark} | {found.rule} | {found.figures} | {found.fallbacks} |")
            print(lines[-1], f" {time.perf_counter() - begin:.1f} s", flush=True)
    if args.readme:
        text = README.read_text("utf-8")
        head, tail = text.split(BEGIN)[0], text.split(END)[1]
        README.write_text(head + BEGIN + "\n" + "\n".join(lines) + "\n" + END + tail, "utf-8")
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
