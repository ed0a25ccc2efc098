"""Whether cloth that overlaps itself lies in the order it is meant to: one front over the other, a wrap's end over its
begin, the plies of pleats as they were folded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from sim_core.cloth.contact import DistanceField
from sim_core.garment.garment import Garment
from sim_core.garment.pattern import Pattern, Plies, both_halves
from sim_core.garment.placement import Flat, Placement, Wrapped
from sim_core.picture import normals

__all__ = ["layer_order", "overlap"]

REACH = 0.03  # [m] within which cloth lies on other cloth
FACING = 0.7  # cosine between the way to other cloth and the outward normal of the wearer: it lies over or under it
ACROSS = 0.5  # cosine between that way and the cloth's own normal: it lies beside it otherwise
SLIGHT = 0.0005  # [m] by which cloth may lie under what it should lie over: the shell's own give
AHEAD = 0.05  # [m] below the shoulder fold in front: what lies nearer is no front
ASIDE = 0.03  # [m] from the middle of the wearer to that of a front that is one side's


def layer_order(garment: Garment, place: Placement) -> int:
    """How many vertices of the outer front, or of a wrap's end, lie under what they should lie over.

    Outwards is away from what lies beneath. 0 of a garment that does not say what it lies on, and of ways of placing
    that give no order.
    """
    under, _ = overlap(garment, place)
    return under


def overlap(garment: Garment, place: Placement) -> tuple[int, int]:
    """Vertices of what should lie outside that lie under the rest, and those that lie over it."""
    if garment.settled is None or not garment.settled.beneath.surfaces:
        return 0, 0
    plies: list[np.ndarray] = []
    field = garment.settled.beneath.field()
    if isinstance(place, Flat) and garment.cut.get("panels"):
        left, right = _fronts(garment)
        layers = [(left, right) if place.over == "left" else (right, left)]
    elif isinstance(place, Wrapped):
        folded = _folded(garment)
        plies = [height for panel, _ in folded for height in _plies(garment, field, panel)]
        layers = [pair for _, pair in folded] or [_wraps(garment)]
    else:
        return 0, 0
    cloth = normals(garment.positions, garment.faces)
    found = [_heights(garment.positions, cloth, field, pair) for pair in layers if all(map(len, pair))]
    height = np.concatenate([np.zeros(0), *found, *plies])
    return int((height < -SLIGHT).sum()), int((height > SLIGHT).sum())


def _heights(
    x: np.ndarray, cloth: np.ndarray, field: DistanceField, pair: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """How high (n,) [m] the outer ones of a pair lie over the inner, indices into x (V, 3) [m], that lie over or under.

    cloth (V, 3): its unit normals. A hem beside another, a little lower, lies neither over nor under it, where what
    they hang over has ended and outwards is down.
    """
    outer, inner = pair
    away, near = KDTree(x[inner]).query(x[outer], distance_upper_bound=REACH)
    close = np.isfinite(away) & (away > 1e-9)
    here, there, across = x[outer[close]], x[inner[np.asarray(near)[close]]], cloth[outer[close]]
    _, outward = field.with_gradient(0.5 * (here + there))
    size = np.linalg.norm(outward, axis=1)
    towards = here - there
    height = (towards * outward).sum(1) / np.maximum(size, 1e-9)
    way = np.linalg.norm(towards, axis=1)
    facing = (size > 0.3) & (np.abs(height) > FACING * way)
    return height[facing & (np.abs((towards * across).sum(1)) > ACROSS * way)]


@dataclass(frozen=True)
class _Panel:
    """A pleated panel: which faces (F,) are of it, x (P,) [m] of pattern vertices and how it is folded."""

    faces: np.ndarray
    x: np.ndarray
    plies: Plies


def _folded(garment: Garment) -> list[tuple[_Panel, tuple[np.ndarray, np.ndarray]]]:
    """All panels of a garment with pleats, and draped vertices of each and of those before it, which it lies over."""
    cut = Pattern.from_dict(garment.cut).panels
    if not any(panel.pleats for panel in cut):
        return []
    found, before = list[tuple[_Panel, tuple[np.ndarray, np.ndarray]]](), np.zeros(0, np.int64)
    for number, panel, sign in both_halves(cut):
        if number == len(garment.panels):  # it is one half
            break
        faces = np.flatnonzero(garment.panel == number)
        if not len(faces):  # of the other side alone
            continue
        own, x = np.unique(garment.pattern_faces[faces]), sign * garment.pattern[:, 0]
        folded = _Panel(faces, x, Plies.of(float(x[own].min()), float(x[own].max()), panel.pleats))
        found.append((folded, (garment.weld[own], before)))
        before = np.concatenate([before, garment.weld[own]])
    return found


def _plies(garment: Garment, field: DistanceField, panel: _Panel) -> list[np.ndarray]:
    """How high (n,) [m] the vertices of each ply lie over the ply it should lie over, along the normals of that.

    Pleats stand open, so that outwards of the wearer says little: what counts is on which side of a ply the other is.
    """
    pattern_faces, x = garment.pattern_faces[panel.faces], garment.positions
    faces = garment.weld[pattern_faces]
    area = np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
    stretch = panel.plies.numbers(panel.x[pattern_faces].mean(1))
    ways = np.sign(np.diff(panel.plies.places))
    _, outward = field.with_gradient(x[faces].mean(1))
    face_up = float(np.sign((ways[stretch] * (area * outward).sum(1)).sum()))
    sides = []
    for ply, way in enumerate(ways):
        own = stretch == ply
        normals = np.zeros_like(x)
        np.add.at(normals, faces[own], face_up * way * area[own, None])
        vertices = np.unique(faces[own])
        size = np.linalg.norm(normals[vertices], axis=1, keepdims=True)
        sides.append((vertices, normals[vertices] / np.maximum(size, 1e-12)))
    found = []
    for over, under in panel.plies.stacked():
        (above, _), (beneath, up) = sides[over], sides[under]
        free = np.setdiff1d(above, beneath)  # on the fold they are one
        if len(free) and len(beneath):
            away, near = KDTree(x[beneath]).query(x[free], distance_upper_bound=REACH)
            close = np.isfinite(away)
            at = np.asarray(near)[close]
            towards = x[free[close]] - x[beneath[at]]
            height = (towards * up[at]).sum(1)
            found.append(height[np.abs(height) > FACING * np.linalg.norm(towards, axis=1)])
    return found


def _fronts(garment: Garment) -> tuple[np.ndarray, np.ndarray]:
    """Draped vertices of the wearer's left front and of the right one, that no seam shares with anything else.

    A panel is of the side its cloth in front lies on, however far it goes beyond the middle.
    """
    count = len(garment.panels) // (2 if Pattern.from_dict(garment.cut).mirror else 1)
    bands = [panel.get("along") is not None for panel in garment.cut["panels"]]
    sides: dict[str, list[np.ndarray]] = {"left": [], "right": [], "": []}
    for number, name in enumerate(garment.panels):
        used = np.unique(garment.pattern_faces[garment.panel == number])
        ahead = used[garment.pattern[used, 1] > AHEAD]
        middle = float(garment.pattern[ahead, 0].mean()) if len(ahead) else 0.0
        side = name.rpartition(" ")[2] if count < len(garment.panels) else ""
        if not side and abs(middle) > ASIDE and not bands[number]:
            side = "left" if middle > 0 else "right"
        sides[side if side in sides else ""].append(garment.weld[ahead])
    left, right, rest = (np.unique(np.concatenate([np.zeros(0, int), *own])) for own in sides.values())
    mine, others = np.setdiff1d(left, right), np.setdiff1d(right, left)
    return np.setdiff1d(mine, rest), np.setdiff1d(others, rest)


def _wraps(garment: Garment) -> tuple[np.ndarray, np.ndarray]:
    """Draped vertices of a wrap's second half and of its first: the later cloth lies over the earlier."""
    x = garment.pattern[:, 0]
    middle = 0.5 * (x.min() + x.max())
    later, earlier = (np.unique(garment.weld[side]) for side in (x > middle, x < middle))
    return np.setdiff1d(later, earlier), np.setdiff1d(earlier, later)
