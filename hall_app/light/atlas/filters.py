"""What is done to gathered light within each chart: gaps filled, noise smoothed away, rims copied outwards."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hall_app.light.atlas.packing import Atlas

__all__ = ["fill", "frame_charts", "frame_numbers", "smooth"]

Singles = NDArray[np.float32]
_REACH = 3  # [texel]
_KEEP = np.float32(0.015)  # relative steps below this are no edges


@njit(cache=True, error_model="numpy")
def _grow(image, known, chart):
    """Unknown texels take the mean of known neighbours of their chart, ring after ring, until nothing changes."""
    height, width = known.shape
    todo = [(y, x) for y in range(height) for x in range(width) if chart[y, x] >= 0 and not known[y, x]]
    while len(todo) > 0:
        later = [(0, 0) for _ in range(0)]
        done = [(0, 0) for _ in range(0)]
        for y, x in todo:
            weight = np.float32(0.0)
            total = np.zeros(image.shape[2], np.float32)
            for b in range(max(y - 1, 0), min(y + 2, height)):
                for a in range(max(x - 1, 0), min(x + 2, width)):
                    if known[b, a] and chart[b, a] == chart[y, x]:
                        total += image[b, a]
                        weight += np.float32(1.0)
            if weight > 0:
                image[y, x] = total / weight
                done.append((y, x))
            else:
                later.append((y, x))
        if len(done) == 0:
            break
        for y, x in done:
            known[y, x] = True
        todo = later


def fill(image: Singles, known: NDArray[np.bool_], chart: NDArray[np.int32]) -> None:
    """Fill texels (H, W, K) that are not `known` from their chart's neighbours; charts without any take the median."""
    inside = chart >= 0
    middle = np.median(image[known & inside], axis=0) if (known & inside).any() else 0.0
    known = known.copy()
    _grow(image, known, chart)
    image[inside & ~known] = middle


@njit(cache=True, error_model="numpy")
def _smooth(image, noise, chart, spread, out):
    height, width = chart.shape
    for y in range(height):
        for x in range(width):
            c = chart[y, x]
            if c < 0:
                continue
            s = spread[c]
            total = np.zeros(image.shape[2], np.float32)
            weights = np.float32(0.0)
            here = (image[y, x, 0] + image[y, x, 1] + image[y, x, 2]) / np.float32(3.0)
            for b in range(max(y - _REACH, 0), min(y + _REACH + 1, height)):
                for a in range(max(x - _REACH, 0), min(x + _REACH + 1, width)):
                    if chart[b, a] != c:
                        continue
                    there = (image[b, a, 0] + image[b, a, 1] + image[b, a, 2]) / np.float32(3.0)
                    step = there - here
                    small = _KEEP * here
                    allowed = np.float32(4.0) * (noise[y, x] + noise[b, a]) + np.float32(2.0) * small * small
                    far = np.float32((a - x) * (a - x) + (b - y) * (b - y)) / (np.float32(2.0) * s * s)
                    weight = np.exp(-far - step * step / (allowed + np.float32(1e-12)))
                    total += weight * image[b, a]
                    weights += weight
            out[y, x] = total / weights


@njit(cache=True, error_model="numpy")
def _calm(noise, chart, out):
    height, width = chart.shape
    for y in range(height):
        for x in range(width):
            if chart[y, x] < 0:
                continue
            total, count = np.float32(0.0), 0
            for b in range(max(y - 2, 0), min(y + 3, height)):
                for a in range(max(x - 2, 0), min(x + 3, width)):
                    if chart[b, a] == chart[y, x]:
                        total += noise[b, a]
                        count += 1
            out[y, x] = total / np.float32(count)


def smooth(image: Singles, error: Singles, atlas: Atlas, chart: NDArray[np.int32]) -> tuple[Singles, Singles]:
    """Light (H, W, 3) and its error (half the difference of two halves) under a Gaussian that stops at edges.

    σ 1.5 texels on large charts, .9 on middling, .6 on narrow ones; a step counts as an edge where it exceeds what
    the noise, measured as the variance of the halves over 5 × 5 texels, explains (after Rousselle et al. 2012).
    """
    noise = np.zeros(chart.shape, np.float32)
    _calm((error.mean(2) ** 2).astype(np.float32), chart, noise)
    narrow = atlas.size.min(1)
    spread = np.where(narrow >= 12, 1.5, np.where(narrow >= 4, 0.9, 0.6)).astype(np.float32)
    both = np.concatenate([image, error], axis=2).astype(np.float32)
    out = np.zeros_like(both)
    _smooth(both, noise, chart, spread, out)
    return np.ascontiguousarray(out[..., :3]), np.ascontiguousarray(out[..., 3:])


def frame_numbers(atlas: Atlas) -> NDArray[np.int32]:
    """(H, W) the nearest chart of every texel, borders and free room included."""
    return frame_charts(atlas.chart_image(), atlas.chart_image())


def frame_charts(image: NDArray[Any], chart: NDArray[np.int32]) -> NDArray[Any]:
    """The picture with everything outside charts copied from the nearest chart texel: borders, and free room."""
    from scipy.ndimage import distance_transform_edt

    if not (chart >= 0).any():
        return image
    nearest = np.asarray(distance_transform_edt(chart < 0, return_distances=False, return_indices=True))
    return np.ascontiguousarray(image[nearest[0], nearest[1]])
