"""What is simulated to learn from: sequences of a published scene, of a coarse sheet and a fine one that it leads."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from sim_core.cloth import Pace, Scene, scene
from sim_core.errors import WrongArgument
from sim_core.validation import excerpt, integer

__all__ = ["DESIGNS", "Design", "Recipe", "recipes"]

GUSTS = 0.3  # share of a flag's wind, rms: winds alone would make flags of one rhythm


@dataclass(frozen=True)
class Design:
    """The data of a scene: sequences and frames of each as published, vertices of the coarse sheet and of the fine one;
    run_in: frames before them that are not kept, in which a flag that was let go flat crumples and comes free."""

    sequences: int
    frames: int
    coarse: int
    fine: int
    run_in: int = 0


DESIGNS = {
    "flag": Design(10, 600, 1545, 6182, run_in=50),
    "teapot": Design(16, 400, 755, 3020),
    "hanging": Design(18, 1200, 1640, 6570),
}
COARSE_COURANT, FINE_COURANT = 0.95, 0.7
# Where the middle of each sheet over the teapot is let go, x along the spout [m], and by how much it is turned
# [degrees]: of the published scene's own sixteen, twelve slide off the pot and fall for the rest of their frames.
PLACES = (
    ((-0.006, -0.013), 4), ((0.030, -0.003), 78), ((-0.005, 0.000), 27), ((0.050, 0.029), 52),
    ((0.010, 0.001), 46), ((0.038, 0.007), 13), ((0.034, 0.004), 50), ((0.030, -0.003), 64),
    ((0.003, -0.011), 3), ((0.009, -0.004), 37), ((0.005, 0.011), 61), ((-0.009, 0.001), 30),
    ((0.049, -0.042), 47), ((-0.047, -0.003), 35), ((-0.010, 0.038), 67), ((0.015, 0.035), 87),
)  # fmt: skip


@dataclass(frozen=True)
class Recipe:
    """One sequence: scene, case (from 1) and seed of its gusts; frames kept and those before them; vertices of both
    sheets; courant: the share of the stable step that the fine one takes; wind: another than its case's [m/s]."""

    scene: str
    case: int
    seed: int
    frames: int
    run_in: int
    coarse: int
    fine: int
    courant: float = FINE_COURANT
    wind: tuple[float, float, float] | None = None

    @property
    def name(self) -> str:
        """What its file is called."""
        return f"{self.scene}-{self.case:02d}" + ("" if self.wind is None else "-wind")

    @property
    def length(self) -> int:
        """Frames that are simulated."""
        return self.run_in + self.frames

    def on(self, vertices: int, slow: int = 1) -> Scene:
        """The scene on a sheet of about so many vertices, `slow` times as slow as it is.

        Slow motion is the same motion: forces are a slow-squared-th, so are squares of speeds, and of rates of damping
        a slow-th. Frames are then so many times as dense, and what acts on the cloth from outside may change as often.
        The wind of a slowed scene has to be slowed as it blows.
        """
        found = scene(self.scene, self.case, vertices=vertices, frames=self.length)
        if self.wind is not None:
            if found.air is None:
                raise WrongArgument(f"wind – no wind blows in the scene {self.scene}")
            found = replace(found, air=found.air.blowing(self.wind))
        if self.scene == "flag":
            found = found.gusty(GUSTS, self.seed)
        if self.scene == "teapot":
            found = replace(
                found, positions=_placed(found.sheet.rest, found.positions, *PLACES[self.case - 1])
            )
        if slow == 1:
            return found
        cloth = found.sheet.material
        slowed = replace(
            cloth,
            stretch=cloth.stretch / slow**2,
            bend=cloth.bend / slow**2,
            mass_damping=cloth.mass_damping / slow,
            stiffness_damping=cloth.stiffness_damping * slow,
        )
        return replace(found, sheet=type(found.sheet).of(found.sheet.rest, found.sheet.faces, slowed))

    @property
    def paces(self) -> tuple[Pace, Pace]:
        """Of the coarse sheet, as fast as it goes, and of the fine one."""
        return Pace("single", COARSE_COURANT), Pace("double", self.courant)

    def halved(self) -> Recipe:
        """The same with half the fine sheet's time step."""
        return replace(self, courant=0.5 * self.courant)

    def told(self) -> dict[str, Any]:
        """Its values, as a manifest keeps them."""
        return {key: value for key, value in asdict(self).items() if key != "wind" or value is not None}


def recipes(
    name: str, *, sequences: int | None = None, frames: int | None = None, seed: int = 0
) -> tuple[Recipe, ...]:
    """The sequences of a scene, all of them as published where nothing else is asked for.

    sequences: the first so many; frames of 1/25 s each; seed: of the flags' gusts, another for each sequence.
    Raises WrongArgument for a scene that is none of DESIGNS and for numbers without meaning.
    """
    if not isinstance(name, str) or name not in DESIGNS:
        raise WrongArgument(f"scene {excerpt(name)} – data are made of {', '.join(DESIGNS)}")
    design = DESIGNS[name]
    most = design.sequences
    count = most if sequences is None else integer("sequences", sequences, 1, f"1 to {most}", most=most)
    length = design.frames if frames is None else integer("frames", frames, 1, "1 or more, of 1/25 s each")
    first = integer("seed", seed, 0, "0 or more")
    return tuple(
        Recipe(name, case, 1000 * first + case, length, design.run_in, design.coarse, design.fine)
        for case in range(1, count + 1)
    )


def _placed(rest: np.ndarray, positions: np.ndarray, at: tuple[float, float], turn: float) -> np.ndarray:
    """A level sheet, rest (V, 2) and positions (V, 3) [m], turned about its middle by so many degrees and put there."""
    flat = rest - 0.5 * (rest.min(0) + rest.max(0))
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    x, z = (at + flat @ np.array([[c, s], [-s, c]])).T
    return np.column_stack([x, positions[:, 1], z])
