"""Hard cases of layers: stacks of sheets, drawn by chance, that fall on a floor; none may change places in silence."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from cloth_course import Outcome

from sim_core import metrics
from sim_core.cloth import Contact, HalfSpace, Material, Phase, Sheet
from sim_core.cloth.run import Run, Setup
from sim_core.cloth.step import FRAME
from sim_core.errors import SimCoreError

FALLS, FRAMES, STRETCH, BEND = 150, 3, 49.0, 5e-6


@dataclass(frozen=True)
class Family:
    """What stacks are drawn from: sizes and thicknesses [m], vertices a side, gaps in thicknesses, heights [m]."""

    sizes: Sequence[float] = (0.3,)
    thicknesses: Sequence[float] = (1e-3, 2.5e-3)
    side: int = 10
    most: int = 4  # sheets in a stack
    gaps: Sequence[float] = (0.6, 1.1, 2.0, 4.0)
    heights: tuple[float, float] = (0.005, 0.06)
    speeds: Sequence[float] = (1.0, 3.0, 5.0, 8.0)  # [m/s]
    densities: Sequence[float] = (0.03, 0.1, 0.3, 1.0)  # [kg/m2]
    every: Sequence[int] = (1,)
    caps: Sequence[float] = (Contact().cap,)


@dataclass(frozen=True)
class Stack:
    """One of them: its sheet, where its vertices (V, 3) begin [m], how many layers, how fast, and their contact."""

    sheet: Sheet
    start: np.ndarray
    layers: int
    speed: float
    contact: Contact


def drawn(family: Family, rng: np.random.Generator) -> Stack:
    count, size = int(rng.integers(2, family.most + 1)), float(rng.choice(family.sizes))
    thickness, gap = float(rng.choice(family.thicknesses)), float(rng.choice(family.gaps))
    contact = Contact(
        thickness=thickness, every=int(rng.choice(family.every)), cap=float(rng.choice(family.caps))
    )
    axis, side = np.linspace(0, size, family.side), family.side
    flat = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    a = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    one = np.concatenate(
        [np.column_stack([a, a + 1, a + side]), np.column_stack([a + 1, a + side + 1, a + side])]
    )
    faces = np.concatenate([one + len(flat) * k for k in range(count)]).astype(np.int32)
    rest = np.concatenate([flat + [2 * size * k, 0.0] for k in range(count)])
    kinds = [Material(float(rng.choice(family.densities)), STRETCH, bend=BEND) for _ in range(count)]
    sheet = Sheet.of_corners(
        rest[faces], faces, kinds, np.repeat(np.arange(count), len(one)).astype(np.int32)
    )
    lowest, beside = float(rng.uniform(*family.heights)), 4e-4 * size / 0.3
    start = np.concatenate(
        [
            np.column_stack(
                [x + beside * k, np.full(len(flat), lowest + gap * thickness * k), z + 0.5 * beside * k]
            )
            for k, (x, z) in ((k, flat.T) for k in range(count))
        ]
    )
    return Stack(sheet, start, count, float(rng.choice(family.speeds)), contact)


def in_order(stack: Stack) -> bool:
    """Whether after every frame no layer crosses another and none lies beneath its lower one; raises what runs tell."""
    setup = Setup(
        stack.sheet, [Phase(FRAMES * FRAME, (9.81, 9.81))], contact=stack.contact, collider=HalfSpace()
    )
    run = Run(setup)
    state = run.begun(stack.start, np.broadcast_to([0.0, -stack.speed, 0.0], stack.start.shape))
    for _ in range(FRAMES):
        run.frame(state)
        heights = state.positions[:, 1].reshape(stack.layers, -1).mean(1)
        if (np.diff(heights) <= 0).any() or metrics.intersections(state.positions, stack.sheet.faces):
            return False
    return True


def falls(family: Family, seed: int) -> Outcome:
    rng, told, changed = np.random.default_rng(seed), 0, 0
    for _ in range(FALLS):
        try:
            changed += not in_order(drawn(family, rng))
        except SimCoreError:
            told += 1
    figures = f"{FALLS} drawn: {changed} changed places or crossed, {told} told as impossible"
    return Outcome(changed == 0, "order", figures)


FAMILIES = {
    "stacks of unequal sheets": Family(),
    "stacks of 2 to 10 m, 10 vertices a side": Family(
        sizes=(2.0, 5.0, 10.0), thicknesses=(2.5e-3, 1e-2, 2e-2), most=3, heights=(0.03, 0.3)
    ),
    "stacks .1 to .3 mm apart": Family(thicknesses=(1e-4, 2e-4, 3e-4), most=3, gaps=(1.1, 2.0, 4.0)),
    "stacks asked in every 2nd to 5th substep": Family(every=(2, 3, 5), gaps=(1.02, 1.3, 2.0)),
    "stacks that solids may push by 3 to 20 mm": Family(caps=(3e-3, 2e-2), most=3, gaps=(1.02, 1.3, 2.0)),
}

STACKS: dict[str, Callable[[], Outcome]] = {
    name: lambda family=family, seed=seed: falls(family, seed)
    for seed, (name, family) in enumerate(FAMILIES.items())
}
