"""How dressed garments go through their wearer's motion, layer over layer; one that repeats closes without a jump."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_core import metrics
from sim_core.body.motion import RATE, Loop
from sim_core.body.pose import Pose
from sim_core.cloth import Air
from sim_core.garment.dressing import capped, layer_order
from sim_core.garment.garment import Garment
from sim_core.garment.garment_sheet import garment_sheet
from sim_core.garment.outfit import Layer, Outfit
from sim_core.garment.worn.follow_body import following
from sim_core.garment.worn.loop_closure import CLOSING, Lengths, closed, draw
from sim_core.garment.worn.pins import Pins

__all__ = ["Played", "move", "moving_errors"]

DAMPING = 5.0  # [1/s] beside the air's

Mesh = tuple[np.ndarray, np.ndarray]  # vertices (V, 3) [m], faces (F, 3)


@dataclass(frozen=True)
class Played:
    """A motion as wearer and garments went through it, T frames at 1/25 s.

    poses: the wearer's; frames: of each garment, from the skin outwards, vertices (T, V, 3) float32 [m]; loop: whether
    the first frame follows the last; apart [m]: of a loop, how far each garment was from where it began before that was
    blended away.
    """

    poses: tuple[Pose, ...]
    frames: tuple[np.ndarray, ...]
    loop: bool = False
    apart: tuple[float, ...] = ()


def move(
    outfit: Outfit, garments: Sequence[Garment], *, progress: Callable[[float, str], None] | None = None
) -> Played:
    """Carries an outfit's dressed garments through its motion, each over those beneath it, in still air: who walks in
    place meets the wind of walking. They are pinned on both shoulders, as on a museum's figure.

    A motion that does not repeat is played once, from the pose the outfit was dressed in. Of one that repeats the
    wearer comes into it and goes through two rounds; the second is what is returned, a loop. Cloth never comes back to
    just where it was: in the last half second forces draw every vertex to where it was a round before, as simulated
    cloth that touches what it touches, and what is left (`Played.apart`) is blended away, edges led back to their
    lengths. As the first round ended in the instant that the second began with, the loop closes without a jump in place
    or speed.
    Raises SimCoreError where the outfit has no wearer or no motion, or a joint would be turned beyond its limit.
    """
    poses, again = outfit.poses(), outfit.repeats()
    assert outfit.wearer is not None
    lead = len(poses) - 1 - again
    index = np.concatenate([np.arange(len(poses)), np.arange(lead + 1, len(poses))[:again]])
    course = _Course(outfit, np.stack([outfit.wearer.posed(pose) for pose in poses]), index, again)
    gone: list[np.ndarray] = []
    apart = []
    for number, garment in enumerate(garments):

        def told(share: float, number: int = number, name: str = garment.name) -> None:
            if progress is not None:
                progress((number + share) / len(garments), f"{name}, following")

        frames, away = course.followed(garment, gone, told)
        gone.append(frames)
        apart.append(away)
    if not again:
        return Played(poses, tuple(gone))
    chosen = slice(-again - 1, -1)
    kept = tuple(frames[chosen] for frames in gone)
    return Played(tuple(poses[k] for k in index[chosen]), kept, True, tuple(apart))


@dataclass(frozen=True)
class _Course:
    """What an outfit's wearer goes through: its vertices once (T, B, 3) [m], of which frame n is index[n]; the last
    `again` frames are those before them once more (0: none are)."""

    outfit: Outfit
    once: np.ndarray
    index: np.ndarray
    again: int

    def followed(
        self, garment: Garment, beneath: Sequence[np.ndarray], progress: Callable[[float], None]
    ) -> tuple[np.ndarray, float]:
        """Vertices (T, V, 3) of a garment in all frames, the last as a round before, and how far [m] from there it was
        before that was blended away."""
        wearer = self.outfit.wearer
        assert wearer is not None
        pins = Pins.of(garment, wearer, self.outfit.pose)
        body, air = self.once[self.index], _air(self.outfit)
        live = following(garment, body, wearer.faces, beneath=beneath or None, air=air)
        live.damping = DAMPING
        mass = garment_sheet(garment).mass[:, None]
        free = np.setdiff1d(np.arange(len(mass)), pins.vertices)
        held, frames, last = pins.vertices.tolist(), [garment.positions], len(self.index) - 1
        closing = min(round(CLOSING * RATE), self.again)
        for n in range(1, last + 1):
            pulls = None
            if n > last - closing:
                drawn = draw(live, frames[n - 1 - self.again], frames[n - self.again], n - (last - closing))
                pulls = free, (mass * drawn)[free]
            frames.append(live.step(body=float(n), pins=held, targets=pins.places(body[n]), pulls=pulls))
            progress(n / last)
        gone = np.stack(frames).astype(np.float32)
        if not self.again:
            return gone, 0.0
        return closed(gone, self.again, Lengths.of(garment, pins.vertices))


def _air(outfit: Outfit) -> Air:
    """Still air, as it meets who walks in place."""
    speed = 0.0
    if isinstance(outfit.motion, Loop) and outfit.wearer is not None:
        speed = outfit.motion.stride(outfit.wearer) / outfit.motion.period
    return Air((0.0, 0.0, -speed))


def moving_errors(
    outfit: Outfit,
    garments: Sequence[Garment],
    played: Played,
    *,
    progress: Callable[[float, str], None] | None = None,
) -> tuple[dict[str, float], ...]:
    """The worst of all frames, of each garment: how deep a vertex lies in what is beneath, `deepest_m`, crossings of
    the cloth with itself and of the wrong order, `self_intersections` and `layer_order`, and `area_strain_p95`."""
    assert outfit.wearer is not None
    worst: list[dict[str, float]] = [{} for _ in garments]
    for k, pose in enumerate(played.poses):
        surfaces = [(outfit.wearer.posed(pose), outfit.wearer.faces)]
        for number, (garment, layer) in enumerate(zip(garments, outfit.layers, strict=True)):
            now = _moved(garment, played.frames[number][k].astype(float), surfaces)
            for name, value in _figures(now, layer, surfaces).items():
                worst[number][name] = max(value, worst[number].get(name, 0.0))
            surfaces.append(capped(now.positions, now.faces))
        if progress is not None:
            progress((k + 1) / len(played.poses), "measuring")
    return tuple(worst)


def _moved(garment: Garment, positions: np.ndarray, beneath: Sequence[Mesh]) -> Garment:
    """The garment in a frame, and what it lies on as that is then."""
    settled = garment.settled
    if settled is None or len(settled.beneath.surfaces) != len(beneath):
        return replace(garment, positions=positions, settled=None)
    surfaces = tuple(
        replace(surface, vertices=vertices)
        for surface, (vertices, _) in zip(settled.beneath.surfaces, beneath, strict=True)
    )
    lain = replace(settled.beneath, surfaces=surfaces, box=None)
    return replace(garment, positions=positions, settled=replace(settled, beneath=lain))


def _figures(garment: Garment, layer: Layer, beneath: Sequence[Mesh]) -> dict[str, float]:
    inside = [metrics.penetration(garment.positions, garment.faces, *mesh) for mesh in beneath]
    strain = np.abs(metrics.area_strain(garment.rest_corners(), garment.positions, garment.faces))
    return {
        "deepest_m": max(0.0, *(-found.clearance[0] for found in inside)),
        "self_intersections": float(metrics.intersections(garment.positions, garment.faces)),
        "layer_order": float(layer_order(garment, layer.place)),
        "area_strain_p95": float(np.percentile(strain, 95)),
    }
