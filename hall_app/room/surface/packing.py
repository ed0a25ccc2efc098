"""Rectangles on a sheet of given width, each with a rim of its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

__all__ = ["packed"]

Size = tuple[int, int]


def packed(sizes: Sequence[Size], width: int, rim: int) -> tuple[list[Size], int]:
    """Upper left corners [pixels], the tallest first and each as high up as there is room, and the height filled.

    sizes: width and height of each, none with its rim wider than `width`; rim: [pixels] left free on all its sides.
    """
    spots, filled = [(0, 0)] * len(sizes), np.zeros(width, int)
    for index in sorted(range(len(sizes)), key=lambda k: (-sizes[k][1], k)):
        wide, high = (side + 2 * rim for side in sizes[index])
        below = np.lib.stride_tricks.sliding_window_view(filled, wide).max(axis=1)
        x = int(np.argmin(below))
        spots[index] = x + rim, int(below[x]) + rim
        filled[x : x + wide] = below[x] + high
    return spots, int(filled.max())
