"""A way past obstacles: the cheapest line through the nodes of a distance field."""

from __future__ import annotations

import itertools

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import dijkstra

from sim_core.cloth.contact import DistanceField

__all__ = ["cleared_line"]

ASIDE = 0.12  # [m] that a knot may be moved, and a line may go out of its way
NARROW = 20.0  # times as dear is a way along a wall as one with room
INSIDE = 1000.0  # times as dear is a way through it
NEIGHBOURS = np.array([n for n in itertools.product((-1, 0, 1), repeat=3) if n > (0, 0, 0)])


def _cleared(knot: np.ndarray, room: float, field: DistanceField) -> np.ndarray:
    """The knot (3,) [m], or where it lacks room [m] the node near it that has most of it for the least way."""
    if field.at(knot[None])[0] >= room:
        return knot
    nodes, value, _ = _nodes(field, knot - ASIDE, knot + ASIDE)
    cost = np.linalg.norm(nodes - knot, axis=1) + 2.0 * np.maximum(room - value, 0.0)
    return nodes[np.argmin(cost)]


def cleared_line(knots: np.ndarray, room: np.ndarray, field: DistanceField) -> tuple[np.ndarray, np.ndarray]:
    """A line (N, 3) [m] past knots (K, 3) that goes round the field's solid where it can, and the room (N,) [m] it
    keeps, between that of two knots, room (K,). Its first point is the first knot; others are moved to where there is
    room."""
    knots = np.array([knots[0], *(_cleared(p, r, field) for p, r in zip(knots[1:], room[1:], strict=True))])
    line, kept = [knots[:1]], [room[:1]]
    for k in range(len(knots) - 1):
        leg = _leg(knots[k], knots[k + 1], float(room[k : k + 2].mean()), field)
        way = np.cumsum(np.linalg.norm(np.diff(leg, axis=0), axis=1))
        line.append(leg[1:])
        kept.append(np.interp(way, [0.0, way[-1]], room[k : k + 2]))
    return np.concatenate(line), np.concatenate(kept)


def _leg(start: np.ndarray, end: np.ndarray, room: float, field: DistanceField) -> np.ndarray:
    """The cheapest line (N, 3) from one point to another: where it has room, cost is length."""
    low, high = np.minimum(start, end) - ASIDE, np.maximum(start, end) + ASIDE
    nodes, value, shape = _nodes(field, low, high)
    short = np.clip((room - value) / room, 0.0, 1.0)
    price = np.where(value > 0.0, 1.0 + NARROW * short * short, INSIDE)
    number = np.arange(len(nodes)).reshape(shape)
    rows, columns, costs = [], [], []
    for step in NEIGHBOURS:
        own = tuple(slice(max(0, -s), n - max(0, s)) for s, n in zip(step, shape, strict=True))
        other = tuple(slice(max(0, s), n - max(0, -s)) for s, n in zip(step, shape, strict=True))
        a, b = number[own].ravel(), number[other].ravel()
        rows.append(a)
        columns.append(b)
        costs.append(field.cell * np.linalg.norm(step) * 0.5 * (price[a] + price[b]))
    graph = sparse.csr_array(
        (np.concatenate(costs), (np.concatenate(rows), np.concatenate(columns))), shape=(len(nodes),) * 2
    )
    first, last = (int(np.argmin(np.linalg.norm(nodes - p, axis=1))) for p in (start, end))
    before = dijkstra(graph, directed=False, indices=first, return_predecessors=True)[1]
    way = [last]
    while way[-1] != first:
        way.append(int(before[way[-1]]))
    return np.concatenate([start[None], nodes[way[-2:0:-1]], end[None]])


def _nodes(
    field: DistanceField, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, tuple[int, ...]]:
    """Nodes (N, 3) [m] of the field in a box, their values (N,) [m], and how many lie along each axis."""
    most = np.array(field.values.shape) - 1
    first = np.clip(np.floor((low - field.origin) / field.cell), 0, most - 1).astype(int)
    last = np.clip(np.ceil((high - field.origin) / field.cell), first + 1, most).astype(int)
    index = tuple(slice(a, b + 1) for a, b in zip(first, last, strict=True))
    values = field.values[index]
    corners = np.stack(
        np.meshgrid(*(np.arange(a, b + 1) for a, b in zip(first, last, strict=True)), indexing="ij"), -1
    )
    return field.origin + field.cell * corners.reshape(-1, 3), values.ravel(), values.shape
