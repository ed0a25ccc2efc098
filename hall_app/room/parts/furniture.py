"""What stands on the floor: booths with their backdrops, the dais with its screen, benches, stands, roped posts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hall_app.room.patch import Frame, Patch, box, disc, panel, strip, tube

if TYPE_CHECKING:
    from hall_app.content.schema import PlanFile, Solid

__all__ = ["furniture_of"]

_DECK = 0.04  # [m] thickness of the wooden deck on a plinth of stone
_RIM = 0.05  # [m] of stone left uncovered round the deck
_LOW, _TOP = 0.12, 2.42  # [m] cloth above the deck: foot and head
_STAND_OFF = 0.12  # [m] a backdrop's middle before the booth's back edge: its feet stand on the deck


def furniture_of(plan: PlanFile) -> list[Patch]:
    """All solids of the plan but its columns."""
    draw = {"booth": _booth, "dais": _dais, "step": _step, "bench": _bench, "stand": _stand, "rope": _rope}
    patches: list[Patch] = []
    for solid in plan.solid:
        if solid.kind != "column":
            patches += draw[solid.kind](solid)
    return patches


def _frame(solid: Solid) -> tuple[Frame, float, float] | None:
    """Middle, width and depth of a rectangle; None for other footprints."""
    if solid.size is None or solid.at is None:
        return None
    return Frame.on_floor(solid.at, solid.facing), *solid.size


def _footprint(solid: Solid, low: float, high: float, material: str, grow: float = 0.0) -> list[Patch]:
    """The solid's footprint raised from `low` to `high` [m], `grow` [m] wider all round; no underside."""
    import shapely

    if solid.round is not None:
        frame = Frame.on_floor((solid.round.x, solid.round.z))
        radius = solid.round.radius + grow
        sides = tube(frame, [(radius, low), (radius, high)], material, sides=32)
        return sides + disc(frame.moved(y=high), radius, material, sides=32)
    if placed := _frame(solid):
        frame, wide, deep = placed
        x, z = wide / 2 + grow, deep / 2 + grow
        return box(frame, (-x, low, -z), (x, high, z), material, skip="bottom")
    shape = shapely.orient_polygons(shapely.Polygon(solid.polygon).buffer(grow, join_style="mitre"))
    ring = np.asarray(shape.exterior.coords)
    patches = []
    for a, b in zip(ring, ring[1:], strict=False):
        patches.append(
            strip(
                [[b[0], low, b[1]], [a[0], low, a[1]]],
                [[b[0], high, b[1]], [a[0], high, a[1]]],
                material,
            )
        )
    lid = shapely.transform(shape, lambda points: points * [1, -1])
    return patches + panel((0, high, 0), (1, 0, 0), (0, 0, -1), lid, material)


def _booth(solid: Solid) -> list[Patch]:
    """A plinth of stone, a deck of wood, a framed cloth at the back."""
    deck = min(_DECK, solid.height / 3)
    patches = _footprint(solid, 0.0, solid.height - deck, "stone")
    patches += _footprint(solid, solid.height - deck, solid.height, "wood", grow=-_RIM)
    if solid.backdrop != "none" and (placed := _frame(solid)):
        frame, wide, deep = placed
        back = frame.moved(y=solid.height, z=-deep / 2 + _STAND_OFF)
        patches += _backdrop(back, min(wide - 0.3, 2.3), solid.backdrop)
    return patches


def _backdrop(frame: Frame, width: float, cloth: str) -> list[Patch]:
    """Cloth in a frame of lacquered wood, gold at the ends of its head; seen from behind as wood."""
    half, post = width / 2, 0.055
    patches = box(
        frame, (-half, _LOW, -0.02), (half, _TOP - 0.1, 0.02), cloth, skip="back left right top bottom"
    )
    patches += box(
        frame, (-half, _LOW, -0.03), (half, _TOP - 0.1, -0.02), "wood", skip="front left right top bottom"
    )
    for side in (-1, 1):
        x = side * (half + post)
        patches += box(frame, (x - post, 0, -0.055), (x + post, _TOP, 0.055), "lacquer", skip="bottom top")
        patches += box(frame, (x - 0.09, 0, -0.07), (x + 0.09, 0.10, 0.10), "lacquer", skip="bottom")
        tip = side * (half + 2 * post + 0.14)
        low, high = sorted((tip, tip - side * 0.05))
        patches += box(frame, (low, _TOP - 0.105, -0.068), (high, _TOP + 0.005, 0.068), "gold")
    patches += box(frame, (-half, 0.02, -0.045), (half, _LOW, 0.045), "lacquer", skip="left right bottom")
    head = half + 2 * post + 0.10
    patches += box(frame, (-head, _TOP - 0.1, -0.06), (head, _TOP, 0.06), "lacquer")
    for y, hidden in ((_LOW, "bottom"), (_TOP - 0.112, "top")):
        skip = f"back left right {hidden}"
        patches += box(frame, (-half, y, 0.02), (half, y + 0.012, 0.026), "gold", skip=skip)
    return patches


def _dais(solid: Solid) -> list[Patch]:
    """A higher booth with a moulded plinth and a folding screen of three leaves."""
    placed = _frame(solid)
    if placed is None:
        return _booth(solid)
    frame, wide, deep = placed
    top, deck = solid.height, min(_DECK, solid.height / 3)
    patches: list[Patch] = []
    for low, high, inset in (
        (0.0, 0.10, 0.0),
        (0.10, top - deck - 0.07, 0.05),
        (top - deck - 0.07, top - deck, 0.015),
    ):
        x, z = wide / 2 - inset, deep / 2 - inset
        patches += box(frame, (-x, low, -z), (x, high, z), "stone", skip="bottom")
    x, z = wide / 2 - 0.07, deep / 2 - 0.07
    patches += box(frame, (-x, top - deck, -z), (x, top, z), "wood", skip="bottom")
    if solid.backdrop != "none":
        patches += _screen(frame.moved(y=top, z=-deep / 2 + 0.22), wide, solid.backdrop)
    return patches


def _screen(frame: Frame, wide: float, cloth: str) -> list[Patch]:
    """Three leaves: the middle one straight and higher, the outer ones turned towards the front."""
    middle, side, turn = 0.36 * wide, 0.25 * wide, 24.0
    patches = _leaf(frame, middle, 2.52, cloth)
    for sign in (-1, 1):
        hinge = frame.moved(x=sign * middle / 2, turn=-sign * turn)
        patches += _leaf(hinge.moved(x=sign * side / 2), side, 2.30, cloth)
    return patches


def _leaf(frame: Frame, width: float, height: float, cloth: str) -> list[Patch]:
    half, post, low = width / 2, 0.07, 0.34
    patches = box(
        frame, (-half, low, -0.02), (half, height - post, 0.012), cloth, skip="back left right top bottom"
    )
    patches += box(
        frame, (-half, 0.1, -0.03), (half, height, -0.02), "wood", skip="front left right top bottom"
    )
    for side in (-1, 1):
        x0, x1 = sorted((side * half, side * (half - post)))
        patches += box(frame, (x0, 0, -0.04), (x1, height, 0.04), "lacquer", skip="bottom top")
    inner = half - post
    for y0, y1 in ((0.06, 0.12), (low - 0.05, low), (height - post, height)):
        patches += box(frame, (-inner, y0, -0.035), (inner, y1, 0.035), "lacquer", skip="left right")
    patches += box(
        frame, (-inner, 0.12, -0.02), (inner, low - 0.05, 0.008), "band", skip="back left right top bottom"
    )
    for y in (low, height - post - 0.012):
        patches += box(frame, (-inner, y, 0.012), (inner, y + 0.012, 0.02), "gold", skip="back left right")
    # Its underside shows: it stands out over the leaf.
    return patches + box(frame, (-half, height, -0.05), (half, height + 0.05, 0.05), "lacquer")


def _step(solid: Solid) -> list[Patch]:
    return _footprint(solid, 0.0, solid.height, "stone")


def _bench(solid: Solid) -> list[Patch]:
    """A seat on two sturdy legs with a rail between them."""
    placed = _frame(solid)
    if placed is None:
        return _footprint(solid, 0.0, solid.height, "wood")
    frame, wide, deep = placed
    x, z, top = wide / 2, deep / 2, solid.height
    patches = box(frame, (-x, top - 0.06, -z), (x, top, z), "wood")
    for side in (-1, 1):
        leg = side * (x - 0.24)
        patches += box(
            frame, (leg - 0.045, 0, -z + 0.06), (leg + 0.045, top - 0.06, z - 0.06), "wood", skip="bottom top"
        )
    patches += box(frame, (-x + 0.28, 0.14, -0.03), (x - 0.28, 0.21, 0.03), "wood", skip="left right")
    patches += box(
        frame,
        (-x + 0.28, top - 0.12, -z + 0.09),
        (x - 0.28, top - 0.06, -z + 0.12),
        "wood",
        skip="left right top",
    )
    return patches + box(
        frame,
        (-x + 0.28, top - 0.12, z - 0.12),
        (x - 0.28, top - 0.06, z - 0.09),
        "wood",
        skip="left right top",
    )


def _stand(solid: Solid) -> list[Patch]:
    """A pedestal: stone foot, lacquered body drawn in, a moulded top."""
    top = solid.height
    foot = min(0.08, top / 4)
    patches = _footprint(solid, 0.0, foot, "stone")
    if solid.round is None:
        patches += _footprint(solid, foot, top - 0.05, "lacquer", grow=-0.05)
        return patches + _footprint(solid, top - 0.05, top, "wood")
    frame, r = Frame.on_floor((solid.round.x, solid.round.z)), solid.round.radius
    body = [(0.90 * r, foot), (0.82 * r, foot + 0.07), (0.80 * r, top - 0.14), (0.92 * r, top - 0.06)]
    patches += tube(frame, body, "lacquer", sides=32)
    for y in (foot + 0.07, top - 0.15):
        ring = [(0.83 * r, y), (0.83 * r, y + 0.016), (0.80 * r, y + 0.018)]
        patches += tube(frame, ring, "gold", sides=32)
    patches += tube(frame, [(r * 0.96, top - 0.06), (r, top - 0.03), (r, top)], "lacquer", sides=32)
    return patches + disc(frame.moved(y=top), r, "wood", sides=32)


def _rope(solid: Solid) -> list[Patch]:
    """Two posts at the ends of the footprint's longer side and a rope that hangs between them."""
    placed = _frame(solid)
    if placed is None:
        return _footprint(solid, 0.0, solid.height, "lacquer")
    frame, wide, deep = placed
    if deep > wide:
        frame, wide, deep = frame.moved(turn=90), deep, wide
    foot = min(0.13, deep / 2)
    ends = (-wide / 2 + foot, wide / 2 - foot)
    patches: list[Patch] = []
    for x in ends:
        post, top = frame.moved(x=x), solid.height
        patches += tube(post, [(foot, 0), (foot, 0.015), (0.03, 0.035), (0.016, 0.04)], "gold", sides=16)
        patches += tube(post, [(0.017, 0.03), (0.017, top - 0.06)], "gold", sides=10)
        knob = [(0.016, top - 0.07), (0.036, top - 0.045), (0.036, top - 0.02), (0.012, top), (0.0, top)]
        patches += tube(post, knob, "gold", sides=10)
    return patches + _cord(frame, ends, solid.height - 0.09)


def _cord(frame: Frame, ends: tuple[float, float], height: float, radius: float = 0.018) -> list[Patch]:
    """A rope in a catenary's parabola, six-sided, hanging a seventh of its span."""
    count, sides = 12, 6
    share = np.linspace(-1, 1, count + 1)
    x = (ends[0] + ends[1]) / 2 + share * (ends[1] - ends[0]) / 2
    sag = 0.14 * (ends[1] - ends[0])
    y = height - sag * (1 - share**2)
    slope = np.gradient(y, x)
    normal = np.column_stack([-slope, np.ones_like(x)]) / np.hypot(slope, 1)[:, None]
    rings = []
    for side in range(sides + 1):
        angle = 2 * np.pi * side / sides
        off = radius * np.column_stack([np.cos(angle) * normal, np.full(count + 1, np.sin(angle))])
        rings.append(frame(np.column_stack([x, y, np.zeros(count + 1)]) + off))
    return [strip(rings[k + 1], rings[k], "curtain", density=2.0) for k in range(sides)]
