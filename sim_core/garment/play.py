"""How dressed garments go through their wearer's motion, layer over layer; one that repeats closes without a jump."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_core import metrics
from sim_core.body.motion import RATE, Loop, minimum_jerk
from sim_core.body.pose import Pose
from sim_core.cloth import Air
from sim_core.garment.dressing import capped, layer_order
from sim_core.garment.follow_body import following
from sim_core.garment.garment import Garment
from sim_core.garment.outfit import Layer, Outfit
from sim_core.garment.pins import Pins

__all__ = ["Played", "move", "moving_errors"]

ROUNDS = 6  # of a motion that repeats, at most
BLENDED = 0.5  # [s] in which the end of a round is led into that of the one before
NEAR = 0.03  # [m] that rounds lie apart there at most, if they come that near
DAMPING = 3.0  # [1/s] beside the air's

Mesh = tuple[np.ndarray, np.ndarray]  # vertices (V, 3) [m], faces (F, 3)


@dataclass(frozen=True)
class Played:
    """A motion as wearer and garments went through it, T frames at 1/25 s.

    poses: the wearer's; frames: of each garment, from the skin outwards, vertices (T, V, 3) float32 [m]; loop: whether
    the first frame follows the last; apart [m]: how far the two rounds of a loop that were blended lay apart at most,
    of each garment.
    """

    poses: tuple[Pose, ...]
    frames: tuple[np.ndarray, ...]
    loop: bool = False
    apart: tuple[float, ...] = ()


def move(
    outfit: Outfit, garments: Sequence[Garment], *, progress: Callable[[float, str], None] | None = None
) -> Played:
    """Carries an outfit's dressed garments through its motion, each over those beneath it, in still air: who walks in
    place meets the wind of walking. They are pinned at nape and shoulders, as on a museum's figure.

    A motion that does not repeat is played once, from the pose the outfit was dressed in. Of one that repeats the
    wearer comes into it and goes through round after round, until two follow each other that end alike, or ROUNDS are
    over; the last of the two that came nearest is what is returned, a loop. Cloth never comes back to just where it
    was, so its last half second is led, without a jump in speed, into that of the round before, which ended in the
    instant that this one began with.
    Raises SimCoreError where the outfit has no wearer or no motion, or a joint would be turned beyond its limit.
    """
    poses, again = outfit.poses(), outfit.repeats()
    assert outfit.wearer is not None
    lead = len(poses) - 1 - again
    index = np.arange(lead + 1 + again * (ROUNDS if again else 0))
    if again:
        index[lead + 1 :] = lead + 1 + np.arange(again * ROUNDS) % again
    course = _Course(outfit, np.stack([outfit.wearer.posed(pose) for pose in poses]), index, lead, again)
    gone: list[np.ndarray] = []
    ends, apart = [], []
    for number, garment in enumerate(garments):

        def told(share: float, number: int = number, name: str = garment.name) -> None:
            if progress is not None:
                progress((number + share) / len(garments), f"{name}, following")

        frames, end, away = course.followed(garment, gone, told)
        gone.append(frames)
        ends.append(end)
        apart.append(away)
    if not again:
        return Played(poses, tuple(gone))
    last = max(ends)  # all layers repeat from there on
    chosen = slice(last - again + 1, last + 1)
    return Played(
        tuple(poses[k] for k in index[chosen]), tuple(frames[chosen] for frames in gone), True, tuple(apart)
    )


@dataclass(frozen=True)
class _Course:
    """What an outfit's wearer goes through: its vertices once (T, B, 3) [m], of which frame n is index[n]; after `lead`
    frames every `again` repeat (0: none do)."""

    outfit: Outfit
    once: np.ndarray
    index: np.ndarray
    lead: int
    again: int

    def followed(
        self, garment: Garment, beneath: Sequence[np.ndarray], progress: Callable[[float], None]
    ) -> tuple[np.ndarray, int, float]:
        """Vertices (T, V, 3) of a garment in all frames, the frame from whose round on they repeat, and how far [m] two
        rounds lay apart where they were blended."""
        wearer = self.outfit.wearer
        assert wearer is not None
        pins = Pins.of(garment, wearer, self.outfit.pose)
        body, air = self.once[self.index], _air(self.outfit)
        live = following(garment, body, wearer.faces, beneath=beneath or None, air=air)
        live.damping = DAMPING
        frames, last = [garment.positions.astype(np.float32)], len(self.index) - 1
        best, nearest = last, np.inf
        for n in range(1, last + 1):
            places = pins.places(body[n])
            frames.append(
                live.step(body=float(n), pins=pins.vertices.tolist(), targets=places).astype(np.float32)
            )
            progress(n / last)
            if self.again and n >= self.lead + 2 * self.again:
                away = self._apart(frames, n)
                if away < nearest:
                    best, nearest = n, away
                if away <= NEAR:
                    break
        if not self.again:
            return np.stack(frames), last, 0.0
        return self._closed(frames, best), best, nearest

    @property
    def _blended(self) -> int:
        return min(round(BLENDED * RATE), self.again)

    def _apart(self, frames: Sequence[np.ndarray], n: int) -> float:
        """How far the round that ends with frame n lies from the one before in its last half second [m]."""
        ends = range(n - self._blended + 2, n + 1)
        return float(max(np.linalg.norm(frames[k] - frames[k - self.again], axis=1).max() for k in ends))

    def _closed(self, frames: Sequence[np.ndarray], n: int) -> np.ndarray:
        """All frames, the round that ends with n led into the one before, and repeated from then on."""
        out = np.stack([*frames[: n + 1], *[frames[n]] * (len(self.index) - 1 - n)])
        count = self._blended
        for k in range(1, count):
            share, at = np.float32(minimum_jerk(k / count)), n + 1 - count + k
            out[at] += share * (out[at - self.again] - out[at])
        for at in range(n + 1, len(out)):
            out[at] = out[at - self.again]
        return out


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
