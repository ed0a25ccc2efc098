"""What callers hand over, checked before anything runs: numbers, arrays, indices."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterable

import numpy as np

from sim_core.errors import SimCoreError

FURTHEST = 1e6  # [m], [m/s], [m/s2]: beyond, squares and steps lose their meaning


def finite(name: str, value: object, *, least: float | None = None, above: float | None = None) -> float:
    """The value as a float; raises SimCoreError, naming it, where it is no finite number in its bounds."""
    real = float(value) if isinstance(value, numbers.Real) and not isinstance(value, bool) else math.nan
    low, high = (-math.inf if bound is None else bound for bound in (least, above))
    if not (math.isfinite(real) and real >= low and real > high):
        bound = f", {least:g} or more" if least is not None else ""
        bound = f" above {above:g}" if above is not None else bound
        raise SimCoreError(f"{name}: {value} – must be a finite number{bound}")
    return real


def coordinates(name: str, value: object, shape: tuple[int, ...] | None = None) -> np.ndarray:
    """A copy (…, 2 or 3) float64 of what is given; raises SimCoreError for text, ragged lists, NaN and giants.

    shape: what it must have, told with `needs`. The first vertex that is wrong is named.
    """
    try:
        array = np.array(value, float, order="C")
    except (TypeError, ValueError):
        raise SimCoreError(
            f"{name}: no array of numbers – one row of coordinates [m] for each vertex"
        ) from None
    if shape is not None and array.shape != shape:
        raise SimCoreError(f"{name}: shape {array.shape} – the sheet needs {shape}")
    if not array.size:
        raise SimCoreError(f"{name}: shape {array.shape} – there is nothing in it")
    flat = array.reshape(len(array), -1) if array.ndim else array.reshape(1, 1)
    wrong = np.flatnonzero(~np.isfinite(flat).all(1))
    if len(wrong):
        raise SimCoreError(f"{name}: vertex {wrong[0]} is not finite")
    far = np.flatnonzero((np.abs(flat) > FURTHEST).any(1))
    if len(far):
        raise SimCoreError(f"{name}: vertex {far[0]} lies beyond {FURTHEST:g} – metres and seconds are meant")
    return array


def triangles(name: str, value: object) -> np.ndarray:
    """Faces (F, 3) as whole numbers, F > 0; raises SimCoreError for any other shape or kind."""
    try:
        faces = np.ascontiguousarray(value)
    except ValueError:
        raise SimCoreError(f"{name}: rows of different length – expected (F, 3) integers, F > 0") from None
    whole = np.issubdtype(faces.dtype, np.integer)
    if faces.ndim != 2 or faces.shape[1:] != (3,) or not whole or not len(faces):
        raise SimCoreError(f"{name}: shape {faces.shape}, {faces.dtype} – expected (F, 3) integers, F > 0")
    return faces


def vertex_numbers(name: str, value: Iterable[object]) -> tuple[int, ...]:
    """Vertices by their numbers; raises SimCoreError for what is no whole number."""
    found = tuple(value)
    for one in found:
        if not isinstance(one, numbers.Integral):
            raise SimCoreError(f"{name}: {one!r} – vertices are named by whole numbers")
    return tuple(int(one) for one in found)  # type: ignore[call-overload]


def whole(name: str, value: object, least: int, why: str) -> int:
    """A whole number, `least` or more; raises SimCoreError with `why`."""
    if not isinstance(value, numbers.Integral) or int(value) < least:
        raise SimCoreError(f"{name}: {value} – {why}")
    return int(value)
