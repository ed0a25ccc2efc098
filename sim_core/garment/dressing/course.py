"""From dressing steps to runs of the cloth engine; one begins where seams are welded, ties join or touch changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from sim_core.body.motion import eased
from sim_core.body.pose import Pose
from sim_core.cloth import Contact, Phase
from sim_core.cloth.step import FRAME
from sim_core.garment.outfit import Belt, Layer, Step
from sim_core.garment.pattern import Spot, Tie

__all__ = ["Course", "Moves", "Timed", "brought_to_rest", "courses", "frames"]

ROUGHLY = 8.0  # times what cloth may move at rest: about what is stirred up when its halves are let go
SWAY = 0.8  # of the damping: critical for a metre of cloth, whose sway is what is left in the end
Pinned = Spot | str


@dataclass(frozen=True)
class Timed:
    """A step in which time passes: what is pinned in it, which key of the wearer it goes from and to, and the shares
    of their first distance that seams or ties may have at its begin and end."""

    step: Step
    pins: tuple[Pinned, ...]
    keys: tuple[int, int]
    sewing: tuple[float, float]

    def phase(self, vertices: Callable[[Pinned], tuple[int, ...]], *, moving: bool) -> Phase:
        """As the engine takes it; vertices: of a sheet, by what is pinned."""
        step = self.step
        pins = sorted({vertex for pin in self.pins for vertex in vertices(pin)})
        return Phase(
            step.seconds,
            step.gravity,
            step.damping,
            step.friction,
            step.label,
            step.speed,
            step.still,
            tuple(pins),
            self.sewing,
            (float(self.keys[0]), float(self.keys[1])) if moving else None,
        )


@dataclass(frozen=True)
class Course:
    """One run of the engine. closed: whether seams are welded; ties, belts: those that hold in it."""

    closed: bool
    contact: Contact
    ties: tuple[Tie, ...] = ()
    belts: tuple[Belt, ...] = ()
    steps: tuple[Timed, ...] = ()

    def count(self) -> int:
        """Frames it takes at most."""
        return sum(frames(timed.step) for timed in self.steps)


@dataclass(frozen=True)
class Moves:
    """The wearer's poses, one for each key, and how far each is on its way from the first to the last, 0 to 1."""

    poses: tuple[Pose, ...]
    shares: tuple[float, ...] = (0.0,)

    @property
    def still(self) -> bool:
        """Whether the wearer keeps one pose."""
        return len(self.poses) == 1


def frames(step: Step) -> int:
    """Frames of 1/25 s a step takes at most."""
    return max(1, round(step.seconds / FRAME)) if step.timed else 0


@dataclass
class _State:
    """Where the reading of the steps is."""

    contact: Contact
    closed: bool = False
    drawn: bool = False  # whether seams or ties of this run have been drawn together
    ties: tuple[Tie, ...] = ()
    belts: tuple[Belt, ...] = ()
    pins: tuple[Pinned, ...] = ()
    poses: list[Pose] = field(default_factory=list)
    way: list[int] = field(default_factory=lambda: [0])  # of each key, how many pose steps are behind it


def courses(layer: Layer, pose: Pose) -> tuple[tuple[Course, ...], Moves]:
    """The runs of a layer whose wearer ends in `pose`, and the wearer's poses."""
    program = layer.program
    state = _State(program.contact, poses=[program.start or pose])
    if program.start is not None and not any(step.do == "pose" for step in program.steps):
        state.poses = [pose]
    runs: list[Course] = []
    timed: list[Timed] = []

    def cut() -> None:
        if timed:
            runs.append(Course(state.closed, state.contact, state.ties, state.belts, tuple(timed)))
            timed.clear()

    for step in program.steps:
        touched = step.touch.of(state.contact)
        if touched != state.contact:
            cut()
            state.contact = touched
        if step.do == "weld":
            cut()
            state.closed, state.drawn = True, False
        elif step.do == "pin":
            state.pins += step.spots
        elif step.do == "release":
            state.pins = tuple(pin for pin in state.pins if step.spots and pin not in step.spots)
        else:
            joining = _joining(layer.pattern.ties, step)
            if (
                step.do == "close" and not joining and step.belt is None
            ):  # a pattern without ties has nothing to close
                continue
            if set(joining) - set(state.ties):
                cut()
                state.ties, state.drawn = (*state.ties, *(t for t in joining if t not in state.ties)), False
            if step.belt is not None:
                cut()
                state.belts, state.drawn = (*state.belts, step.belt), False
            timed.append(_timed(step, state, pose))
    cut()
    return tuple(runs), Moves(tuple(state.poses), _shares(state.poses))


def brought_to_rest(runs: Sequence[Course], *, roughly: bool) -> tuple[Course, ...]:
    """The step in which a layer comes to rest, for cloth that did so on a coarser mesh; roughly: until it moves ROUGHLY
    times as much as it may in the end.

    Its folds fall a little further, which sets all of it swaying: SWAY of the damping is about critical for that. Ties
    and belts of the finer mesh lie between other vertices and are drawn to their length once more.
    """
    last = runs[-1]
    end = last.steps[-1]
    step, sewing = end.step, (1.0, 0.0) if last.ties or last.belts else end.sewing
    if step.damping is not None:
        step = replace(step, damping=SWAY * step.damping)
    if roughly and step.still:
        step = replace(step, still=ROUGHLY * step.still)
    return (replace(last, steps=(replace(end, step=step, sewing=sewing),)),)


def _joining(ties: Sequence[Tie], step: Step) -> tuple[Tie, ...]:
    """The ties that a step closes, none where it closes none."""
    if step.do != "close" and not step.ties or step.belt is not None and not step.ties:
        return ()
    return tuple(tie for tie in ties if not step.ties or tie.name in step.ties)


def _timed(step: Step, state: _State, pose: Pose) -> Timed:
    first = len(state.poses) - 1
    if step.do == "pose":
        begin, end, count = state.poses[-1], step.pose or pose, frames(step)
        state.poses += [begin.towards(end, eased(k / count)) for k in range(1, count + 1)]
    draws = step.do == "sew" or (bool(state.ties or state.belts) and not state.drawn)
    sewing = (0.0, 0.0)
    if draws and not state.drawn:
        sewing, state.drawn = (1.0, 0.0), True
    elif not state.closed and not state.drawn:
        sewing = (1.0, 1.0)
    return Timed(step, state.pins, (first, len(state.poses) - 1), sewing)


def _shares(poses: Sequence[Pose]) -> tuple[float, ...]:
    """How far each pose is on the way from first to last, by the turns of the joints."""
    if len(poses) == 1:
        return (1.0,)
    ways = [_apart(a, b) for a, b in zip(poses, poses[1:], strict=False)]
    whole = sum(ways) or 1.0
    out = [0.0]
    for way in ways:
        out.append(out[-1] + way / whole)
    return tuple(min(1.0, share) for share in out)


def _apart(a: Pose, b: Pose) -> float:
    return float(abs(a.quaternions() - b.quaternions()).sum())
