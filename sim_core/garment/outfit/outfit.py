"""`Outfit`: what is dressed on whom, layer by layer from the skin outwards."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from sim_core.body.mannequin import Mannequin
from sim_core.body.motion import Loop, Motion
from sim_core.body.pose import T_POSE, Pose
from sim_core.body.stand import Stand
from sim_core.cloth import Contact
from sim_core.errors import SimCoreError
from sim_core.garment.outfit.steps import Step
from sim_core.garment.pattern import Cloth, Pattern
from sim_core.garment.placement import Placement
from sim_core.validation.files import shown
from sim_core.weave import Loom, Weave

__all__ = ["Layer", "Outfit", "Program"]

FILE_NAME = re.compile(r"\w([\w -]{0,78}\w)?")
FINE = 0.009  # [m] mesh steps below which cloth is sewn and posed on a coarser mesh of the step
COARSE = 0.015  # [m]; at twice that, folds are so coarse that finer ones pass through each other in them
UNTANGLE = 40  # steps after each frame in which cloth that passed through itself is taken apart again


@dataclass(frozen=True)
class Program:
    """How a layer is dressed: steps, how it touches from the first on, and how far its cloth is simplified.

    start: the wearer's pose at first; sag: strain under the cloth's own weight it is softened to; fold: bending length
    in mesh edges it is stiffened to; limit: shares by which an edge may be shorter, and longer, before it is held;
    even: whether mass is shared out for longer time steps.
    """

    steps: tuple[Step, ...]
    contact: Contact = field(default_factory=lambda: Contact(untangle=UNTANGLE))
    start: Pose | None = None
    sag: float = 0.0013
    fold: float = 1.3
    limit: tuple[float, float] = (0.04, 0.04)
    even: bool = True


@dataclass(frozen=True)
class Layer:
    """One garment of an outfit. weaves: the cloth's first, then those of panels by name; edge [m]: its mesh step;
    seed: of the folds' irregularity; loom: remembers what its weaves are like, one for all layers of an outfit;
    origin, origins [m]: where a corner of the weave's repeat lies in the axes of its panels, and of single ones (of a
    mirrored pattern's other half as far to the other side);
    coarse [m]: the mesh step it is sewn and posed at (None: COARSE for cloth finer than FINE that is not tied, else its
    own);
    closing [m]: gaps beneath it are filled that no ball of that radius enters, so that no fold is pinched there;
    accessory: whether it goes with the garment beneath, which is what one comes to see (None: not told)."""

    name: str
    pattern: Pattern
    weave: Weave
    place: Placement
    program: Program
    edge: float
    weaves: Mapping[str, Weave] = field(default_factory=dict)
    seed: int = 0
    loom: Loom = field(default_factory=Loom, repr=False, compare=False)
    coarse: float | None = None
    closing: float = 0.0
    origin: tuple[float, float] = (0.0, 0.0)
    origins: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    accessory: bool | None = None

    def __post_init__(self) -> None:
        if not FILE_NAME.fullmatch(self.name):
            raise SimCoreError(
                f"layer {shown(self.name)}: its name names a file, too – use letters, digits, _, - and inner spaces"
            )

    def weave_of(self, panel: str) -> Weave:
        """What a panel is cut from."""
        return self.weaves.get(panel, self.weave)

    def origin_of(self, panel: str) -> tuple[float, float]:
        """Where a corner of the weave's repeat lies in a panel's axes [m]."""
        return self.origins.get(panel, self.origin)

    def panel_origins(self) -> tuple[tuple[float, float], ...]:
        """`origin_of` each panel of the whole cloth; in the other half of a mirrored pattern as far from the middle."""
        origins = [self.origin_of(panel.name) for panel in self.pattern.panels] or [self.origin]
        return (*origins, *((-x, y) for x, y in origins)) if self.pattern.mirror else tuple(origins)

    @property
    def placed(self) -> bool:
        """Whether its cloth was laid with care: a repeat's corner elsewhere than at the axes' zero."""
        return self.origin != (0.0, 0.0) or bool(self.origins)

    @cached_property
    def first(self) -> Layer:
        """What is sewn and posed: the same on a coarser mesh, or itself where that is not finer than it need be.

        Nor where it is tied, unless `coarse` says so: a knot between other vertices pulls folds through each other.
        """
        tied = len(self.pattern.ties) > 0 or any(step.belt is not None for step in self.program.steps)
        coarse = self.coarse or (COARSE if self.edge < FINE and not tied else self.edge)
        return replace(self, edge=coarse) if coarse > self.edge else self

    @cached_property
    def cut(self) -> Cloth:
        """Its pattern, meshed once; of a mirrored one the half that is drawn."""
        return self.pattern.cloth(self.edge)

    @cached_property
    def cloth(self) -> Cloth:
        """The whole of it."""
        return self.pattern.whole(self.cut)

    def yarns(self, panel: str = "") -> Any:
        """The yarns at rest of what a panel is cut from, as `sim_core.weave.solve` gives them; each weave once."""
        return self.loom.yarns(self.weave_of(panel))


@dataclass(frozen=True)
class Outfit:
    """Layers from the skin outwards on a wearer in a pose, or on a stand; motion: how the wearer moves once dressed;
    source: the file it was read from."""

    name: str
    layers: tuple[Layer, ...]
    wearer: Mannequin | None = None
    stand: Stand | None = None
    pose: Pose = T_POSE
    motion: Motion | Loop | None = None
    title: Mapping[str, str] = field(default_factory=dict)
    source: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        if not self.layers:
            raise SimCoreError(f"outfit {self.name}: no layer – a [[layer]] names a pattern and a weave")
        if (self.wearer is None) == (self.stand is None):
            raise SimCoreError(f"outfit {self.name}: give a wearer or a stand, one of both")

    def key(self, number: int) -> str:
        """How errors name a layer, 0 next to the skin: file and key."""
        return f"{self.source or f'outfit {self.name}'}: layer.{number + 1}"

    def coarser(self, edge: float) -> Outfit:
        """The same with every layer meshed at `edge` [m]."""
        return replace(self, layers=tuple(replace(layer, edge=edge) for layer in self.layers))

    def poses(self) -> tuple[Pose, ...]:
        """The wearer's poses at the begin and at the end of every frame of 1/25 s of its motion, from its pose on; of
        a motion that repeats one whole loop, in place.

        Raises SimCoreError where there is no wearer or no motion, or a joint would be turned beyond its limit.
        """
        if self.wearer is None or self.motion is None:
            raise SimCoreError(
                f'outfit {self.name}: nobody moves – give it a wearer and motion = "motions/….toml"'
            )
        if isinstance(self.motion, Loop):
            return self.motion.course(self.pose, self.wearer)
        return self.motion.poses(self.pose)

    def repeats(self) -> int:
        """How many frames of `poses` repeat for ever, those at the end; 0 of a motion that is gone through once.

        A motion that ends in the pose it was begun in repeats.
        """
        poses = self.poses()
        if self.wearer is not None and isinstance(self.motion, Loop):
            return len(self.motion.times()) - 1
        return len(poses) - 1 if len(poses) > 1 and poses[-1] == poses[0] else 0

    def to_dict(self) -> dict[str, Any]:
        """What decides the result, as plain values."""
        return {
            "name": self.name,
            "wearer": self.wearer and self.wearer.digest(),
            "stand": self.stand and repr(self.stand),
            "pose": self.pose.table(),
            "layers": [
                {
                    "name": layer.name,
                    "pattern": layer.pattern.to_dict(),
                    "weave": layer.weave.to_dict(),
                    "weaves": {name: weave.to_dict() for name, weave in layer.weaves.items()},
                    "edge": layer.edge,
                    **({} if layer.coarse is None else {"coarse": layer.coarse}),
                    **({"closing": layer.closing} if layer.closing else {}),
                    **({"origin": layer.origin, "origins": dict(layer.origins)} if layer.placed else {}),
                    "seed": layer.seed,
                    "place": repr(layer.place),
                    "program": repr(layer.program),
                }
                for layer in self.layers
            ],
        }
