"""A garment that is worn while its wearer stands or moves: simulated on from where it was draped."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np

from sim_core.body import Beneath, Surface
from sim_core.cloth import (
    Air,
    Contact,
    Drape,
    HalfSpace,
    Live,
    MovingGrid,
    Pace,
    Phase,
    Solid,
    drape,
    moving_mesh,
)
from sim_core.cloth.contact import hull_faces
from sim_core.cloth.step import FRAME
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Garment
from sim_core.garment.garment_sheet import garment_sheet, standing
from sim_core.garment.outfit.outfit import UNTANGLE
from sim_core.garment.settled import Settled
from sim_core.validation import numeric_array

__all__ = ["follow", "following"]

DAMPING = 1.5  # [1/s] of cloth that hangs on someone who walks
FASTEST = 8.0  # [m/s] that cloth may go where its wearer moves
QUICK = Pace(
    courant=0.95
)  # of garments whose mass is shared out, on a wearer who moves: none of them is to rest
SAME = 1e-3  # [m] that a layer beneath may be away at first from where the garment was settled on it


class Hooks(TypedDict, total=False):
    """Who hears of the frames, a file to go on from, and what blows."""

    progress: Callable[[float, str], None] | None
    on_frame: Callable[[int, np.ndarray], None] | None
    checkpoint: Path | None
    air: Air | None


def follow(
    garment: Garment,
    body: np.ndarray | None = None,
    faces: np.ndarray | None = None,
    *,
    seconds: float | None = None,
    beneath: Sequence[np.ndarray] | None = None,
    beside: Solid | None = None,
    contact: Contact | None = None,
    damping: float | None = None,
    **hooks: Unpack[Hooks],
) -> Drape:
    """Lets the garment hang on, or follow its wearer, frame by frame of 1/25 s.

    Without a body it goes on for `seconds` where it was settled, with the contact, holds, friction and damping it was
    settled with: what came to rest stays at rest. body (T, B, 3) [m]: the wearer's vertices at the begin and then at
    the end of every frame, the first as the garment was draped on; faces (F, 3): closed, counter-clockwise from
    outside. T = 1: a wearer who stands still, for `seconds`; otherwise `seconds` more than the motion are stood still
    at its end. The wearer's hands stay the hulls that cloth slides over.
    beneath: of each garment it was settled over, from the skin outwards, vertices (T, V, 3) [m] as they go with the
    wearer: `positions`, then what `on_frame` heard as that garment followed; of a wearer who stands still they may be
    left out. beside: a solid with exact distance that stands still there, such as a floor, HalfSpace().
    contact, damping: other than the garment's own. on_frame(index, positions (V, 3) float32) hears every frame;
    checkpoint: file to go on from; air: what blows, and brakes (None costs nothing).
    Raises SimCoreError before anything runs where the wearer's mesh is open or not finite, layers beneath are missing
    or others, there is no time to run, or the garment does not say what it was settled with and that is not given.
    """
    settled = garment.settled
    if body is None or faces is None:
        for name, value in (("body", body), ("faces", faces), ("beneath", beneath), ("beside", beside)):
            if value is not None:
                raise SimCoreError(f"follow: {name} without a wearer – give body and faces, or leave it out")
        if settled is None:
            raise SimCoreError(
                f"follow: garment {garment.name} does not say what it was settled with – give its wearer's vertices "
                "and faces, or bake it again"
            )
        if not seconds:
            raise SimCoreError("follow: the wearer stands still – say for how many seconds")
        phase = settled.phase(seconds)
        phase = phase if damping is None else replace(phase, damping=damping)
        return standing(garment)([phase], contact=contact or settled.contact, **hooks)
    wearer = _wearer(garment, body, faces, beneath, beside)
    usual: dict[str, Any] = {"damping": DAMPING if damping is None else damping}
    if settled is not None:
        usual["friction"] = settled.last.friction
        contact = contact or _touching(settled)
    if contact is None:
        raise SimCoreError(
            f"follow: garment {garment.name} does not say how it touches – give contact=Contact(…)"
        )
    phases: list[Phase] = []
    if wearer.count > 1:
        way = (0.0, float(wearer.count - 1))
        phases.append(Phase((wearer.count - 1) * FRAME, label="following", body=way, **usual))
    if seconds:
        phases.append(Phase(seconds, label="standing", **usual))
    if not phases:
        raise SimCoreError("follow: the wearer stands still – say for how many seconds")
    return drape(
        garment_sheet(garment),
        garment.positions,
        phases,
        collider=wearer,
        contact=contact,
        holds=settled and settled.holds,
        pace=QUICK if settled is not None and settled.even else None,
        **hooks,
    )


def following(
    garment: Garment,
    body: np.ndarray,
    faces: np.ndarray,
    *,
    beneath: Sequence[np.ndarray] | None = None,
    air: Air | None = None,
) -> Live:
    """The garment on its wearer as `follow` begins, to be stepped by whoever moves pins or ends when it will; `body` of
    a step is the number of the frame.

    Raises SimCoreError as `follow` does, and where the garment does not say what it was settled with.
    """
    settled = garment.settled
    if settled is None:
        raise SimCoreError(
            f"follow: garment {garment.name} does not say what it was settled with – bake it again"
        )
    sheet = garment_sheet(garment)
    friction = sheet.material.friction if settled.last.friction is None else settled.last.friction
    return Live(
        replace(sheet, material=replace(sheet.material, friction=friction)),
        garment.positions,
        damping=DAMPING,
        collider=_wearer(garment, body, faces, beneath, None),
        contact=_touching(settled),
        holds=settled.holds,
        pace=QUICK if settled.even else None,
        air=air,
    )


def _touching(settled: Settled) -> Contact:
    """How a garment touches a wearer who moves: as it was settled, but faster, and taken out of itself again."""
    fastest = max(FASTEST, settled.contact.speed_limit)
    return replace(settled.contact, speed_limit=fastest, untangle=UNTANGLE)


def _wearer(
    garment: Garment,
    body: np.ndarray,
    faces: np.ndarray,
    beneath: Sequence[np.ndarray] | None,
    beside: Solid | None,
) -> MovingGrid:
    """The wearer in its frames, with hands as hulls, and the garments it wears under this one."""
    lain = garment.settled.beneath if garment.settled else Beneath()
    own, *worn = lain.surfaces or (None,)
    frames = numeric_array("follow: body", body, "expected (T, B, 3)")
    hulls: list[np.ndarray] = []
    if own is not None and own.hulls:
        if frames.shape[1:] != own.vertices.shape:
            raise SimCoreError(
                f"follow: body {frames.shape} – garment {garment.name} was settled on a figure of "
                f"{len(own.vertices)} vertices, whose hands are known by number: give (T, {len(own.vertices)}, 3)"
            )
        hulls = [hull[hull_faces(own.vertices[hull])] for hull in own.hulls]
    hands = len(hulls)
    if beneath is None and worn and len(frames) > 1:
        raise SimCoreError(
            f"follow: garment {garment.name} was settled over {len(worn)} other(s) – give beneath=[…], the frames of "
            "each as it follows the wearer"
        )
    given = [s.vertices[None] for s in worn] if beneath is None else list(beneath)
    if len(given) != len(worn):
        raise SimCoreError(
            f"follow: beneath holds {len(given)} garment(s), {garment.name} was settled over {len(worn)} – give each"
        )
    points = [frames]
    for number, (surface, vertices) in enumerate(zip(worn, given, strict=True)):
        hulls.append(surface.faces + sum(part.shape[1] for part in points))
        points.append(_capped(f"follow: beneath[{number}]", surface, vertices, len(frames)))
    return moving_mesh(
        np.concatenate(points, axis=1) if worn else frames,
        faces,
        cell=lain.cell,
        hulls=hulls,
        beside=HalfSpace() if beside is None and lain.floor else beside,
        thicker=[own.hulls_thicker if own else 0.0] * hands + [surface.thicker for surface in worn],
    ).closed(lain.closing)


def _capped(name: str, surface: Surface, vertices: np.ndarray, count: int) -> np.ndarray:
    """Frames (T, V + L, 3) of a garment beneath from its vertices: its L openings stay closed about their middles."""
    frames = np.asarray(numeric_array(name, vertices, "expected (T, V, 3)"), float)
    whole = len(surface.vertices)
    if frames.ndim != 3 or frames.shape[2] != 3 or len(frames) != count or not 0 < frames.shape[1] <= whole:
        raise SimCoreError(
            f"{name}: {frames.shape} – expected ({count}, V, 3), V at most {whole}: as many as the body"
        )
    own = frames.shape[1]
    away = float(np.abs(frames[0] - surface.vertices[:own]).max())
    if not away <= SAME:
        raise SimCoreError(
            f"{name}: begins {1000 * away:.1f} mm from where the garment was settled on it – begin with its positions"
        )
    middles = []
    for cap in range(own, whole):
        rim = np.unique(surface.faces[(surface.faces == cap).any(1)])
        middles.append(frames[:, rim[rim < own]].mean(1))
    return np.concatenate([frames, np.stack(middles, axis=1)], axis=1) if middles else frames
