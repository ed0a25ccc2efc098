"""Hard cases without a collider: stiffness, bad starts, gales, gravity, torn pins, masses, broken meshes, rest."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from cloth_course import STRETCH, UNIQUE, Outcome, Setting, calm, course, longest, unique

from sim_core.cloth import Contact, Material, Sheet
from sim_core.cloth.scenes import GF_CM, equilateral_sheet, hang_edge, scene
from sim_core.cloth.sheet import mended
from sim_core.metrics import intersections

LAYERED = Contact(thickness=0.002)
BLOWN = Contact(thickness=0.002, spring=0.1)  # what snaps back from twice its length needs a stiffer shell
# Stretch and bending a hundred times as stiff along the warp, which hangs down, or along the weft.
ONE_WAY = replace(GF_CM, stretch_warp=4900.0, shear=10.0, bend_warp=4.9e-3)
OTHER_WAY = replace(GF_CM, stretch=4900.0, stretch_warp=49.0, shear=10.0, bend=4.9e-3, bend_warp=4.9e-5)


def settling(first: float, then: float, frames: int) -> Callable[[int], float]:
    """Damping [1/s]: little for so many frames, then much."""
    return lambda frame: first if frame < frames else then


def edge(material: Material = GF_CM, *, gravity: float = 9.81, frames: int = 150) -> Setting:
    """A level sheet let go, held by an edge: it comes to hang flat, and nowhere else."""
    made = hang_edge(0.05, material=material)
    damping = settling(5.0, 5.0, 0)
    return Setting(made.sheet, made.positions, frames, made.pins, gravity=gravity, damping=damping)


def stiff(times: float) -> Outcome:
    return unique(edge(replace(GF_CM, stretch=times * GF_CM.stretch)))


def started(start: Callable[[np.ndarray], np.ndarray]) -> Outcome:
    """The sheet that hangs by an edge from a bad start: every vertex comes to where the flat start brings it.

    Or to a crumple at rest that is an equilibrium of its own: it comes back to it from a knock of a millimetre.
    """
    made = hang_edge(0.04)
    wild = start(made.positions)
    wild[list(made.pins)] = made.positions[list(made.pins)]
    damping = settling(1.0, 4.0, 400)
    flat = Setting(made.sheet, made.positions, 600, made.pins, damping=damping, watch=False)
    given, reference = replace(flat, start=wild, watch=True), course(flat).end
    one = course(given)
    off = 1e3 * float(np.linalg.norm(one.end - reference, axis=1).max())
    if off < UNIQUE:
        return unique(given, reference)
    knock = np.random.default_rng(6).normal(0, 5e-4, one.end.shape)
    knock[list(made.pins)] = 0.0
    back = course(replace(flat, start=one.end + knock)).end
    again = 1e3 * float(np.linalg.norm(back - one.end, axis=1).max())
    share = longest(made.sheet, one.end) / longest(made.sheet, reference)
    kept = one.steady(calm=True) and again < UNIQUE and abs(share - 1) < STRETCH
    figures = (
        f"a crumple {off:.0f} mm off, regained within {again:.2g} mm after a knock, stretch {share:.3f} of it"
    )
    return Outcome(kept, "calm", f"{figures}, {one.told()}", one.fallbacks)


def noise(x: np.ndarray) -> np.ndarray:
    return x + np.random.default_rng(4).normal(0, 0.3, x.shape)


def thrown_about(size: float, seeds: int = 10) -> Outcome:
    """Noise of so many metres, each seed a start of its own: all come to hang as the flat start does."""
    made = hang_edge(0.04)
    pins, damping = list(made.pins), settling(1.0, 4.0, 400)
    flat = Setting(made.sheet, made.positions, 600, made.pins, damping=damping, watch=False)
    reference, off, crossed, kept, fallbacks, lengths = course(flat).end, 0.0, 0, True, 0, []
    for seed in range(seeds):
        wild = made.positions + np.random.default_rng(seed).normal(0, size, made.positions.shape)
        wild[pins] = made.positions[pins]
        one = course(replace(flat, start=wild))
        off = max(off, 1e3 * float(np.linalg.norm(one.end - reference, axis=1).max()))
        crossed = max(crossed, intersections(one.end, made.sheet.faces))
        kept &= one.steady(calm=True)
        fallbacks += one.fallbacks
        lengths.append(one.smoothed)
    kept &= off < UNIQUE and crossed == 0
    figures = f"{seeds} seeds: at most {off:.2g} mm off and {crossed} crossings at the end"
    over = f"starts smoothed over {min(lengths):.2g} to {max(lengths):.2g} m"
    return Outcome(kept, "unique", f"{figures}, {over}", fallbacks)


def inverted(x: np.ndarray) -> np.ndarray:
    """Left and right exchanged, so that every face at the pinned edge is turned inside out."""
    return x * [-1.0, 1.0, 1.0] + [1.0, 0.0, 0.0]


def gale(stretch: float) -> Outcome:
    """60 m/s along and across a flag for a second, then none: the stretch of a quarter of the step, and rest."""
    made = scene("flag", vertices=500, cloth=replace(GF_CM, stretch=stretch))

    def blow(frame: int) -> tuple[float, float, float]:
        return (59.0, 0.0, 10.0) if frame < 25 else (0.0, 0.0, 0.0)

    damping = settling(0.5, 4.0, 25)
    flag = Setting(made.sheet, made.positions, 250, made.pins, blow=blow, damping=damping, free=27)
    return calm(replace(flag, contact=BLOWN), until=26)


def torn() -> Outcome:
    """A corner is torn off at 10 m/s for 0.12 s, brought back and held: the cloth comes to rest."""
    made = scene("hanging", vertices=400, pins="corners")
    home = made.positions[list(made.pins)]

    def drive(frame: int) -> np.ndarray:
        way = min(3, frame + 1) * 0.4 - 1.2 * np.clip((frame - 3) / 37, 0, 1)
        return home + np.array([[0.0, 0.0, 0.0], [0.6 * way, 0.0, -0.8 * way]])

    damping = settling(2.0, 4.0, 40)
    return calm(
        Setting(
            made.sheet,
            made.positions,
            300,
            made.pins,
            contact=LAYERED,
            damping=damping,
            drive=drive,
            free=41,
        )
    )


def single_pin() -> Outcome:
    """All of a square metre hangs by one vertex."""
    made = scene("hanging", vertices=400, pins="corner")
    damping = settling(2.0, 4.0, 60)
    return calm(Setting(made.sheet, made.positions, 300, made.pins, contact=LAYERED, damping=damping))


def heavy() -> Outcome:
    """The lower half a hundred times as heavy: the hem sinks by what the weight makes it, and rests there."""
    rest, faces = equilateral_sheet(0.5, 1.0, 0.05)
    light, lead = replace(GF_CM, stretch=4900.0), replace(GF_CM, stretch=4900.0, density=5.0)
    kind = (rest[faces][:, :, 1].mean(1) > 0.5).astype(int)
    sheet = Sheet.of_corners(rest[faces], faces, [light, lead], kind)
    start = np.column_stack([rest[:, 0], -rest[:, 1], np.zeros(len(rest))])
    pins = np.flatnonzero(rest[:, 1] < 1e-9).tolist()
    found = unique(hung := Setting(sheet, start, 100, pins, damping=settling(8.0, 8.0, 0)))
    s = np.linspace(0, 1, 2001)
    load = 9.81 * (np.where(s < 0.5, 0.05 * (0.5 - s), 0.0) + np.where(s < 0.5, 2.5, 5.0 * (1 - s)))
    grown = [np.real(max(np.roots([2450, 0, -2450, -f]), key=np.real)) for f in load]
    sag = 1e3 * float(np.trapezoid(np.array(grown) - 1, s))
    measured = 1e3 * (-course(replace(hung, watch=False)).end[rest[:, 1] > 0.999, 1].mean() - 1)
    figures = f"hem sinks {measured:.2f} mm (analytic {sag:.2f}), {found.figures}"
    return replace(found, kept=found.kept and abs(measured - sag) < 1.0, figures=figures)


def broken_mesh(kind: str) -> Outcome:
    """A mesh with a needle, a face without area or double vertices, mended, hangs as the sound one does."""
    sound, sound_faces = equilateral_sheet(0.5, 0.5, 0.05)
    rest, faces = sound, sound_faces
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

    def hung(points: np.ndarray, index: np.ndarray) -> Setting:
        start = np.column_stack([points[:, 0], -points[:, 1], np.zeros(len(points))])
        pins = np.flatnonzero(points[:, 1] < 1e-9).tolist()
        return Setting(Sheet.of(points, index, GF_CM), start, 100, pins, damping=settling(8.0, 8.0, 0))

    calm_end = course(hung(sound, sound_faces)).end
    order = [int(np.argmin(((sound - p) ** 2).sum(1))) for p in rest]
    there = np.linalg.norm(sound[order] - rest, axis=1) < 1e-9
    given = hung(rest, faces)
    reference = np.where(there[:, None], calm_end[order], course(replace(given, watch=False)).end)
    return unique(given, reference)


def at_rest(frames: int = 100_000) -> Outcome:
    """15 x 15 vertices hang for so many frames: no creep, no energy."""
    rest, faces = equilateral_sheet(0.35, 0.35 * np.sqrt(0.75), 0.025)
    sheet = Sheet.of(rest, faces, GF_CM)
    start = np.column_stack([rest[:, 0], -rest[:, 1], np.zeros(len(rest))])
    pins = np.flatnonzero(rest[:, 1] < 1e-9).tolist()
    rested = course(Setting(sheet, start, 250, pins, damping=settling(5.0, 5.0, 0))).end
    long = Setting(sheet, rested, frames, pins, damping=settling(5.0, 5.0, 0), watch=False)
    found = unique(long, rested)
    return replace(found, figures=f"after {frames} frames of {len(rest)} vertices {found.figures}")


HUNG: dict[str, Callable[[], Outcome]] = {
    "stiffness x 1": lambda: stiff(1),
    "stiffness x 10": lambda: stiff(10),
    "stiffness x 100": lambda: stiff(100),
    "anisotropy 100 : 1": lambda: unique(edge(ONE_WAY)),
    "anisotropy 1 : 100": lambda: unique(edge(OTHER_WAY)),
    "Poisson's ratio 0.49": lambda: unique(edge(replace(GF_CM, poisson=0.49))),
    "random start, 0.3 m": lambda: started(noise),
    "random starts, 0.1 m": lambda: thrown_about(0.1),
    "random starts, 0.3 m": lambda: thrown_about(0.3),
    "random starts, 1 m": lambda: thrown_about(1.0),
    "inverted start": lambda: started(inverted),
    "wind of 60 m/s, soft": lambda: gale(49.0),
    "wind of 60 m/s, stiff": lambda: gale(4900.0),
    "gravity x 10": lambda: unique(edge(gravity=98.1, frames=200)),
    "pin pulled at 10 m/s": torn,
    "single pin": single_pin,
    "mass ratio 100 : 1": heavy,
    "needle triangle": lambda: broken_mesh("needle"),
    "zero-area triangle": lambda: broken_mesh("zero area"),
    "duplicate vertices": lambda: broken_mesh("duplicates"),
    "at rest, 100 000 frames": at_rest,
}
