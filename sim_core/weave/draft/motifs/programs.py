"""Figures of Han, Tang, Song and Ming silks as programs: parameters in millimetres in, areas of one repeat out.

Every program returns the repeat (along the weft, along the warp) and what is drawn in it, in order; 0 is the ground.
"""

from __future__ import annotations

from collections.abc import Callable
from math import atan2, cos, pi, sin
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sim_core.weave.draft.motifs.strokes import band, brush, flower, lozenge, petal, ring, turned, volute

__all__ = ["PROGRAMS", "Areas"]

STRIP = 1.55  # a vine of a strip is drawn as of a repeat so many times as wide, which two of them share
Areas = tuple[tuple[float, float], list[tuple[int, Any]]]


def _half_drop(size: tuple[float, float], drawn: list[tuple[int, Any]], mirrored: bool = False) -> Areas:
    """The same once more, half a repeat on in both directions; mirrored: left and right exchanged."""
    from shapely.affinity import scale, translate

    again = [
        (
            number,
            translate(scale(area, -1.0 if mirrored else 1.0, 1.0, origin=(0, 0)), size[0] / 2, size[1] / 2),
        )
        for number, area in drawn
    ]
    return size, [*drawn, *again]


def lozenges(width: float = 40.0, height: float = 64.0, lines: int = 3, line: float = 2.4) -> Areas:
    """菱纹: lozenges within one another, corner to corner, every second row half a lozenge on."""
    drawn = []
    step = 2.2 * line
    for k in range(lines):
        shrink = 1.0 - 2.0 * k * step / min(width, height)
        if shrink <= 0.1:
            break
        inner = max(0.0, shrink - 2.0 * line / min(width, height))
        drawn.append((1, lozenge((0, 0), shrink * width, shrink * height)))
        drawn.append((0, lozenge((0, 0), inner * width, inner * height)))
    drawn.append((1, lozenge((0, 0), 0.16 * width, 0.16 * height)))
    return _half_drop((width, height), drawn)


def cup_lozenges(width: float = 37.0, height: float = 70.0, line: float = 1.5) -> Areas:
    """杯文: a lozenge whose side corners carry half-hidden small ones, as an eared cup seen from above."""
    drawn: list[tuple[int, Any]] = []
    wide, high = 0.62 * width, 0.62 * height
    for side in (-1, 1):
        for share, number in ((1.0, 1), (0.62, 0), (0.30, 1)):
            drawn.append(
                (number, lozenge((side * 0.42 * width, 0), 0.30 * width * share, 0.30 * height * share))
            )
    for shrink in (1.0, 0.70):
        thin = shrink - 2.6 * line / wide
        drawn.append((1, lozenge((0, 0), shrink * wide, shrink * high)))
        drawn.append((0, lozenge((0, 0), thin * wide, thin * high)))
    for x, y in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        place = (0.085 * width * x, 0.085 * height * y)
        drawn.append((1, lozenge(place, 0.13 * width, 0.13 * height)))
        drawn.append((0, lozenge(place, 0.06 * width, 0.06 * height)))
    return _half_drop((width, height), drawn)


def frets(unit: float = 6.0, line: float = 2.0) -> Areas:
    """卍字不到头: swastikas whose arms run on into those of their neighbours, without an end."""
    drawn = []
    for x, y in ((0, 0), (2, 2)):
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            path = [(x, y), (x + dx, y + dy), (x + dx - dy, y + dy + dx)]
            drawn.append((1, band([(unit * a, unit * b) for a, b in path], line)))
    return (4 * unit, 4 * unit), drawn


def clouds(
    width: float = 160.0, height: float = 180.0, line: float = 12.0, curl: float = 1.1, colours: int = 1
) -> Areas:
    """云气: cloud scrolls, an S of two volutes with a seam along its back, hooks on its flanks, flames in its bends."""
    two, three = min(2, colours), min(3, colours)
    reach, rise = 0.78 * width, 0.5
    arms = [volute((0.0, 0.0), rise + side, reach, turns=curl, bend=-1.1) for side in (pi, 0.0)]
    body = np.concatenate([arms[0][:0:-1], arms[1]])
    share = np.linspace(-1.0, 1.0, len(body))
    swell = line * (0.42 + 0.75 * np.exp(-((share / 0.45) ** 2)))
    drawn: list[tuple[int, Any]] = []
    for far, out, length, turn in (
        (0.30, -1, 0.24, 0.55), (0.47, -1, 0.20, 0.6), (0.17, 1, 0.22, 0.6), (0.62, -1, 0.15, 0.6),
    ):  # fmt: skip
        for end in (1, -1):
            foot, heading = _on(body, 0.5 + 0.5 * end * far)
            way = heading + (0.0 if end > 0 else pi)
            hook = volute(foot, way + out * 1.05, length * width, turns=out * turn, bend=0.2 * out)
            drawn.append((two, brush(hook, np.linspace(0.75 * line, 0.3 * line, len(hook)))))
            drawn.append((two, ring(hook[-1], 0.33 * line, line)))
    drawn += [(1, brush(body, swell)), (0, brush(body[12:-12], 0.14 * swell[12:-12] + 0.35))]
    for end in (0, -1):
        drawn.append((1, ring(body[end], 0.72 * line, line)))
    for side in (0.0, pi):
        for lean, length in ((-0.55, 0.13), (0.0, 0.19), (0.55, 0.13)):
            way = rise + side + pi / 2 + lean
            drawn.append((three, petal(1.15 * line * _unit(way), way, length * width, 1.15 * line)))
    return _half_drop((width, height), drawn, mirrored=True)


def roundels(
    diameter: float = 110.0, pearls: int = 20, petals: int = 8, gap: float = 14.0, colours: int = 3
) -> Areas:
    """联珠团窠: a roundel with a ring of pearls about a rosette, and a cross of flowers where four of them meet."""
    radius = 0.5 * diameter
    two, three = min(2, colours), min(3, colours)
    middle = (0.0, 0.0)
    drawn: list[tuple[int, Any]] = [
        (1, ring(middle, radius, radius)),
        (0, ring(middle, 0.955 * radius, 0.235 * radius)),
        (1, ring(middle, 0.72 * radius, 0.045 * radius)),
        (0, ring(middle, 0.675 * radius, radius)),
    ]
    pearl = 0.62 * pi * 0.8375 * radius / pearls
    at = 0.8375 * radius
    drawn += [
        (
            two,
            ring(
                (at * cos(2 * pi * k / pearls), at * sin(2 * pi * k / pearls)),
                min(pearl, 0.1 * radius),
                radius,
            ),
        )
        for k in range(pearls)
    ]
    drawn += _rosette(middle, 0.60 * radius, petals, (1, two, three))
    size = diameter + gap
    corner = (0.5 * size, 0.5 * size)
    drawn += _rosette(corner, 0.24 * radius, 4, (three, 1, two), turn=pi / 4)
    for leaf in turned(
        petal((corner[0] + 0.25 * radius, corner[1]), 0.0, 0.26 * radius, 0.2 * radius), corner, 4
    ):
        drawn.append((1, leaf))
    return (size, size), drawn


def vines(
    width: float = 190.0, height: float = 250.0, line: float = 5.0, petals: int = 9, colours: int = 1
) -> Areas:
    """缠枝: a stem that winds along the warp and holds a flower in every bend, with leaves and tendrils."""
    return _half_drop((width, height), _vine(width, height, line, petals, colours), mirrored=True)


def vine_strips(
    width: float = 60.0, height: float = 120.0, line: float = 2.0, petals: int = 9, colours: int = 1
) -> Areas:
    """缠枝边: one such stem in a strip, for an edge or a band."""
    from shapely.affinity import translate

    drawn = _vine(STRIP * width, height, line, petals, colours)
    return (width, height), [(number, translate(area, width / 2, 0.0)) for number, area in drawn]


def _vine(width: float, height: float, line: float, petals: int, colours: int) -> list[tuple[int, Any]]:
    """A stem along x = 0 with two flowers; width: of a repeat that holds two such stems."""
    y = np.linspace(0.0, height, 97)
    stem = np.column_stack([0.17 * width * np.sin(2 * pi * y / height), y])
    drawn: list[tuple[int, Any]] = [(1, brush(stem, line))]
    two, three = min(2, colours), min(3, colours)
    for share, side in ((0.25, -1), (0.75, 1)):
        head = np.array([side * 0.10 * width, share * height])
        foot, heading = _on(stem, share - 0.19)
        neck = _bent(foot, heading, head)
        drawn.append((1, brush(neck, np.linspace(line, 0.7 * line, len(neck)))))
        drawn += _blossom(head, 0.17 * width, petals, (1, two, three))
        for far, turn, length in ((-0.12, 0.9, 0.20), (0.0, 1.1, 0.17), (0.12, 0.8, 0.20)):
            place, way = _on(stem, share + far)
            drawn.append((two, petal(place, way - side * -turn, length * width, 0.42 * length * width)))
            drawn.append(
                (0, brush([place, place + 0.62 * length * width * _unit(way - side * -turn)], 0.28 * line))
            )
        place, way = _on(stem, share + 0.07)
        tendril = volute(place, way + side * 0.9, 0.42 * width, turns=-side * 1.0, bend=side * 0.5)
        drawn.append((1, brush(tendril, np.linspace(0.7 * line, 0.35 * line, len(tendril)))))
    return drawn


def rank_flowers(diameter: float = 48.0, spacing: float = 2.1, petals: int = 6, colours: int = 1) -> Areas:
    """品官花: single round flowers with their leaves, by rank 5 cun to 1 across, scattered in rows."""
    radius, size = 0.5 * diameter, diameter * spacing
    drawn: list[tuple[int, Any]] = []
    for leaf in turned(petal((0.52 * radius, 0.0), 0.0, 0.5 * radius, 0.36 * radius), (0.0, 0.0), petals):
        drawn.append((min(2, colours), leaf))
    drawn += _rosette(
        (0.0, 0.0), 0.66 * radius, petals, (1, min(2, colours), min(3, colours)), turn=pi / petals
    )
    return _half_drop((size, size), drawn)


PROGRAMS: dict[str, Callable[..., Areas]] = {
    "lozenges": lozenges,
    "cup-lozenges": cup_lozenges,
    "frets": frets,
    "clouds": clouds,
    "roundels": roundels,
    "vines": vines,
    "vine-strips": vine_strips,
    "rank-flowers": rank_flowers,
}


def _rosette(
    middle: ArrayLike, radius: float, petals: int, numbers: tuple[int, int, int], *, turn: float = 0.0
) -> list[tuple[int, Any]]:
    """A flower of three rings of petals, each parted from the next by a line of the ground, and its heart."""
    outer, inner, heart = numbers
    line = 0.07 * radius
    found: list[tuple[int, Any]] = [(outer, flower(middle, radius, petals, turn=turn))]
    way = turn + pi / petals  # between two petals
    vein = band(np.asarray(middle, float) + radius * np.outer([0.0, 0.96], _unit(way)), line)
    found += [(0, one) for one in turned(vein, middle, petals)]
    for share, number, lag in ((0.62, inner, pi / petals), (0.34, heart, 0.0)):
        found.append((0, flower(middle, (share + 0.07) * radius, petals, turn=turn + lag)))
        found.append((number, flower(middle, share * radius, petals, turn=turn + lag)))
    found.append((0, ring(middle, 0.14 * radius, radius)))
    found.append((outer, ring(middle, 0.08 * radius, radius)))
    return found


def _blossom(
    middle: np.ndarray, radius: float, petals: int, numbers: tuple[int, int, int]
) -> list[tuple[int, Any]]:
    """A lotus seen from the side: petals fan out over its foot, the front ones over those behind."""
    outer, inner, heart = numbers
    found: list[tuple[int, Any]] = []
    foot = middle - np.array([0.0, 0.45 * radius])
    for share, number, spread, wide in (
        (1.35, outer, 1.25, 0.55),
        (1.0, inner, 0.85, 0.52),
        (0.7, heart, 0.45, 0.5),
    ):
        for k in range(petals):
            away = spread * (2.0 * k / (petals - 1) - 1.0)
            length = radius * share * (1.0 - 0.18 * abs(away) / spread)
            shape = petal(foot, pi / 2 + away, length, wide * radius * share * 0.75)
            found.append((0, shape.buffer(0.045 * radius)))
            found.append((number, shape))
    found.append((0, ring(foot, 0.30 * radius, radius)))
    found.append((outer, ring(foot, 0.24 * radius, radius)))
    return found


def _on(path: np.ndarray, share: float) -> tuple[np.ndarray, float]:
    """The point of a path (N, 2) that repeats, at a share of it, and where it goes there [rad]."""
    whole = path[-1] - path[0]
    turns, share = divmod(share, 1.0)
    place = share * (len(path) - 1)
    k = min(int(place), len(path) - 2)
    way = path[k + 1] - path[k]
    return path[k] + (place - k) * way + turns * whole, atan2(way[1], way[0])


def _bent(start: np.ndarray, heading: float, end: np.ndarray) -> np.ndarray:
    """Points (24, 2) from a start in a direction to an end, as a quadratic Bezier curve."""
    reach = 0.6 * float(np.linalg.norm(end - start))
    control = start + reach * _unit(heading)
    t = np.linspace(0.0, 1.0, 24)[:, None]
    return (1 - t) ** 2 * start + 2 * t * (1 - t) * control + t**2 * end


def _unit(angle: float) -> np.ndarray:
    return np.array([cos(angle), sin(angle)])
