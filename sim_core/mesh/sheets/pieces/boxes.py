"""Which boxes of many lie around a given one, the last of them first, without looking at each."""

from __future__ import annotations

import heapq
from collections.abc import Iterator

import numpy as np

__all__ = ["Boxes"]

LEAF = 16  # boxes that are looked at together


class Boxes:
    """Boxes in an order. A tree over their four sides, split at the median of each in turn, whose nodes know how far
    their sides reach, and the first and last of their numbers: boxes around another are found in log n each."""

    def __init__(self, bounds: np.ndarray) -> None:
        """bounds: (n, 4) [m], least x and y, most x and y."""
        self.sides = bounds * (1, 1, -1, -1)  # each less than another's where one lies around the other
        self.members: list[np.ndarray] = []
        self.lower: list[int] = []  # the first of both halves of a node, -1 of a leaf
        self.least: list[list[float]] = []
        self.first: list[int] = []
        self.last: list[int] = []
        self._split(np.arange(len(bounds)))

    def _split(self, every: np.ndarray) -> None:
        waiting = [(every, 0)]
        self._add(every)
        node = 0
        while node < len(waiting):
            members, axis = waiting[node]
            if len(members) > LEAF:
                order = np.argsort(self.sides[members, axis], kind="stable")
                self.lower[node] = len(waiting)
                for half in np.array_split(members[order], 2):
                    waiting.append((half, (axis + 1) % 4))
                    self._add(half)
                self.members[node] = members[:0]
            node += 1

    def _add(self, members: np.ndarray) -> None:
        self.members.append(np.sort(members))
        self.lower.append(-1)
        self.least.append(self.sides[members].min(axis=0, initial=np.inf).tolist())
        self.first.append(int(members.min(initial=len(self.sides))))
        self.last.append(int(members.max(initial=-1)))

    def around(self, number: int, slack: float) -> Iterator[int]:
        """Numbers below `number`, the highest first, of boxes around its box, which may leave them by `slack` [m]."""
        sides = self.sides[number] + slack
        a, b, c, d = sides.tolist()
        heap = [(-self.last[0], 0, True)]
        while heap:
            last, node, inner = heapq.heappop(heap)
            if not inner:
                yield -last
                continue
            if (lower := self.lower[node]) < 0:
                members = self.members[node]
                members = members[: np.searchsorted(members, number)]
                for k in members[(self.sides[members] <= sides).all(axis=1)].tolist():
                    heapq.heappush(heap, (-k, node, False))
                continue
            for half in (lower, lower + 1):
                w, x, y, z = self.least[half]
                if self.first[half] < number and w <= a and x <= b and y <= c and z <= d:
                    heapq.heappush(heap, (-self.last[half], half, True))
