"""One hard case, run frame by frame and watched: energy, stretch, what is inside the collider, what crosses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_core import metrics
from sim_core.cloth import Air, Contact, Live, Sheet, Solid
from sim_core.cloth.sheet import energies
from sim_core.cloth.step import FRAME

CALM = 1e-6  # [J] of motion left: nothing moves by a millimetre a second any more
RISE = 0.01  # share of the energy a run has lost that may come back: leapfrog's own error of one step
UNIQUE = 1.0  # [mm]
STRETCH = 0.1

Drive = Callable[[int], np.ndarray | None]
Blow = Callable[[int], Sequence[float]]


@dataclass(frozen=True)
class Outcome:
    """What a case came to: kept or not, the rule that applies, figures in words, frames the implicit scheme took."""

    kept: bool
    rule: str
    figures: str
    fallbacks: int = 0


@dataclass(frozen=True)
class Setting:
    """A scene for `course`: what is simulated, in which surroundings, for how many frames.

    damping: [1/s] of each frame; drive: where the pins are led by a frame's end, None: they rest; blow: the wind of a
    frame; free: the first frame from which nothing does work on the cloth any more.
    """

    sheet: Sheet
    start: np.ndarray
    frames: int
    pins: Sequence[int] = ()
    collider: Solid | None = None
    contact: Contact | None = None
    gravity: float = 9.81
    damping: Callable[[int], float] = lambda _: 2.0
    drive: Drive = lambda _: None
    blow: Blow | None = None
    free: int = 0
    substeps: int | None = None
    certify: bool = False
    watch: bool = True  # crossings and energy, which cost more than a small cloth's frame

    def finer(self, per_frame: int) -> "Setting":
        """The same by so many steps a frame."""
        return replace(self, substeps=per_frame, watch=False, certify=False)


@dataclass(frozen=True)
class Course:
    """A watched run: end (V, 3) [m], energies per frame [J], the longest edge, samples inside, crossings."""

    end: np.ndarray
    moving: float
    stretch: float
    rise: float
    inside: int
    crossed: int
    before: int
    worst_crossed: int
    steps: tuple[int, ...]
    fallbacks: int
    uncertified: int | None
    smoothed: float = 0.0  # [m] over which a hopeless start was smoothed first

    @property
    def per_frame(self) -> float:
        """Steps a frame, on the mean."""
        return sum(self.steps) / max(len(self.steps), 1)

    @property
    def finite(self) -> bool:
        return bool(np.isfinite(self.end).all())

    def steady(self, *, calm: bool) -> bool:
        """What every case must keep: finite, nothing inside, no energy from nowhere; calm: at rest, no new crossing."""
        kept = self.finite and self.inside == 0 and self.rise <= RISE
        return kept and (not calm or (self.moving < CALM and self.crossed <= self.before))

    def told(self) -> str:
        words = [f"KE {self.moving:.1e} J", f"energy back {100 * self.rise:.2g} %"]
        if self.inside:
            words.append(f"**{self.inside} inside**")
        words.append(f"crossings {self.before} then {self.crossed}")
        if self.smoothed:
            words.append(f"the start smoothed over {self.smoothed:.2g} m")
        if self.uncertified is not None:
            words.append(f"uncertified frames {self.uncertified}")
        return ", ".join(words)


def longest(sheet: Sheet, x: np.ndarray) -> float:
    ends, rest2 = sheet.stencil.edges, sheet.stencil.length2
    return float(np.sqrt((((x[ends[:, 0]] - x[ends[:, 1]]) ** 2).sum(1) / rest2).max()))


def inside(sheet: Sheet, x: np.ndarray, solid: Solid, clearance: float) -> int:
    """Vertices, midpoints and centroids deeper than a tenth of the clearance."""
    samples = np.concatenate([x, x[sheet.edges].mean(1), x[sheet.faces].mean(1)])
    return int((solid.distance(samples) < -0.1 * clearance).sum())


def course(given: Setting) -> Course:
    """Runs it; crossings are counted at every frame, energy in those in which nothing does work."""
    sheet, contact = given.sheet, given.contact or Contact()
    live = Live(
        sheet,
        given.start,
        pins=given.pins,
        collider=given.collider,
        contact=contact,
        gravity=(0.0, -given.gravity, 0.0),
        air=Air() if given.blow else None,
        substeps=given.substeps,
        integrator="explicit" if given.substeps else "auto",
        certify=given.certify,
    )
    x, worst, deep, crossings, energy = given.start, 1.0, 0, [0], []
    before = x
    if given.watch:
        crossings = [metrics.intersections(x, sheet.faces)]
    steps: list[int] = []
    for frame in range(given.frames):
        live.damping, before = given.damping(frame), x
        wind = None if given.blow is None else given.blow(frame)
        x = live.step(targets=given.drive(frame), wind=wind)
        steps.append(live.substeps)
        if not np.isfinite(x).all():
            break
        worst = max(worst, longest(sheet, x))
        if given.watch:
            crossings.append(metrics.intersections(x, sheet.faces))
            if given.collider is not None:
                deep += inside(sheet, x, given.collider, contact.clearance)
            if frame >= given.free:
                height = given.gravity * float(sheet.mass @ x[:, 1])
                energy.append(height + sum(energies(sheet.stencil, x, live.velocities)))
    found = live.certificate
    # By the way of the last frame: velocities at the end of a step hold half of what bending gives every second one.
    v = (x - before) / FRAME
    return Course(
        x,
        0.5 * float((sheet.mass * (v * v).sum(1)).sum()),
        worst,
        _rise(np.array(energy)),
        deep,
        crossings[-1],
        crossings[min(given.free, len(crossings) - 1)],
        max(crossings),
        tuple(steps),
        live.fallbacks,
        None if found is None else found.uncertified,
        live.smoothed,
    )


def _rise(energy: np.ndarray) -> float:
    """The most that ever came back, as a share of all that was lost."""
    if len(energy) < 2:
        return 0.0
    back = float((energy - np.minimum.accumulate(energy)).max())
    lost = float(energy[0] - energy.min())
    return back / max(lost, 1e-6)


def unique(given: Setting, reference: np.ndarray | None = None, *, rule: str = "unique") -> Outcome:
    """Against the same with a quarter of the step: stretch within 10 %, and every vertex rests within 1 mm of it.

    reference (V, 3) [m]: where it must come to rest instead, for a start of its own.
    """
    one = course(given)
    two = None
    if reference is None:
        two = course(given.finer(2 * round(2 * one.per_frame)))
        reference = two.end
    off = 1e3 * float(np.linalg.norm(one.end - reference, axis=1).max())
    kept = one.steady(calm=True) and off < UNIQUE
    figures = f"{off:.2g} mm off, "
    if two is not None:
        kept &= abs(one.stretch / two.stretch - 1) < STRETCH
        figures += f"stretch {one.stretch:.3f} (refined {two.stretch:.3f}), "
    else:
        share = longest(given.sheet, one.end) / longest(given.sheet, reference)
        kept &= abs(share - 1) < STRETCH
        figures += f"stretch at rest {share:.3f} of it, "
    return Outcome(kept, rule, figures + one.told(), one.fallbacks)


def calm(
    given: Setting,
    *,
    most: float | None = None,
    until: int | None = None,
    also: Callable[[Course], tuple[bool, str]] | None = None,
) -> Outcome:
    """Kinetic energy goes to zero and self-intersections do not grow; stretch within 10 % of a quarter of the step.

    most: an analytic bound of the stretch instead; until: the frame by which the longest edge has been, where steps
    are so much shorter before it that a quarter of the mean would be none of theirs; also: what else must hold, and
    its words.
    """
    one = course(given)
    if most is None:
        steps = one.steps[:until]
        quarter = 2 * round(2 * sum(steps) / len(steps))
        fine = course(replace(given, frames=len(steps)).finer(quarter)).stretch
        kept, figures = (
            abs(one.stretch / fine - 1) < STRETCH,
            f"stretch {one.stretch:.3f} (refined {fine:.3f}), ",
        )
    else:
        kept, figures = (
            one.stretch < most * (1 + STRETCH),
            f"stretch {one.stretch:.3f} (at most {most:.3f}), ",
        )
    kept &= one.steady(calm=True)
    if also is not None:
        good, words = also(one)
        kept, figures = kept and good, f"{words}, {figures}"
    return Outcome(kept, "calm", figures + one.told(), one.fallbacks)
