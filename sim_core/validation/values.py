"""What callers hand over, checked before anything runs: numbers, arrays, indices, kinds of things.

Every check takes the name that the caller knows the value by and raises one SimCoreError of one line: name, value,
what is meant. Values come back as the type that is worked with.
"""

from __future__ import annotations

import math
import numbers
from typing import TypeVar

import numpy as np

from sim_core.errors import SimCoreError

FURTHEST = 1e6  # [m], [m/s], [m/s2]: beyond, squares and steps lose their meaning
GREATEST = 1e12  # of any other number
MOST = 2**31 - 1  # of anything that is counted

Kind = TypeVar("Kind")


def excerpt(value: object, most: int = 60) -> str:
    """The value in one line, cut where it is longer than a line bears."""
    try:
        text = str(value) if isinstance(value, numbers.Real) else repr(value)
    except (ValueError, RecursionError):  # an integer of thousands of digits, a list in itself
        return f"a {type(value).__name__} too large to show"
    text = " ".join(text.split())
    return text if len(text) <= most else text[:most] + "…"


def instance_of(name: str, value: object, kind: type[Kind], remedy: str) -> Kind:
    """The value, if it is of that kind."""
    if not isinstance(value, kind):
        raise SimCoreError(f"{name}: a {type(value).__name__} – {remedy}")
    return value


def optional_callable(name: str, value: object) -> None:
    """Something to be called, or None."""
    if value is not None and not callable(value):
        raise SimCoreError(f"{name}: a {type(value).__name__} – give a function, or None")


def one_of(name: str, value: object, known: tuple[str, ...]) -> None:
    """One of the words that are known."""
    if not isinstance(value, str) or value not in known:
        raise SimCoreError(f"{name}: {excerpt(value)} – there are {', '.join(known)}")


def finite(
    name: str,
    value: object,
    *,
    least: float | None = None,
    above: float | None = None,
    most: float | None = None,
) -> float:
    """A finite number in its bounds (none given: within ±GREATEST) as a float."""
    try:
        real = float(value) if isinstance(value, numbers.Real) and not isinstance(value, bool) else math.nan
    except OverflowError:  # an integer of more than 308 digits
        real = math.inf
    low, over = (-GREATEST if bound is None else bound for bound in (least, above))
    high = GREATEST if most is None else most
    if not (low <= real <= high and real > over):  # NaN is not
        bounds = [f"{word}{b:g}" for word, b in (("at least ", least), ("above ", above)) if b is not None]
        bounds += [f"at most {high:g}"] if most is not None or real > high else []
        bounds += [f"at least {-GREATEST:g}"] if real < low and least is None else []
        raise SimCoreError(
            f"{name}: {excerpt(value)} – must be a finite number{', ' * bool(bounds)}{', '.join(bounds)}"
        )
    return real


def integer(name: str, value: object, least: int, why: str, most: int = MOST) -> int:
    """A whole number from `least` to `most`, which `why` tells about."""
    number = int(value) if isinstance(value, numbers.Integral) and not isinstance(value, bool) else least - 1
    if not least <= number <= most:
        raise SimCoreError(f"{name}: {excerpt(value)} – {why}")
    return number


def numeric_array(name: str, value: object, what: str) -> np.ndarray:
    """The value as an array of real numbers, not copied where it is one; `what` is meant."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, OverflowError):  # ragged lists
        array = np.array(None)
    if array.dtype.kind not in "iuf":
        raise SimCoreError(f"{name}: {excerpt(value)} – no array of numbers; {what}")
    return array


def vector(
    name: str, value: object, what: str, count: int, *, least: float = -FURTHEST, most: float = FURTHEST
) -> tuple[float, ...]:
    """So many finite numbers, none beyond its bounds; `what` is meant."""
    array = numeric_array(name, value, what)
    if array.shape != (count,) or not ((array >= least) & (array <= most)).all():
        raise SimCoreError(f"{name}: {excerpt(value)} – {what}")
    return tuple(float(one) for one in array)


def vector3(name: str, value: object, unit: str) -> tuple[float, float, float]:
    """Three finite numbers of at most a million."""
    x, y, z = vector(name, value, f"expected three finite numbers (x, y, z) {unit}", 3)
    return x, y, z


def coordinates(name: str, value: object, shape: tuple[int, ...] | None = None) -> np.ndarray:
    """A copy (…, 2 or 3) float64 of what is given: no text, ragged list, NaN or giant.

    shape: what it must have, told with `needs`. The first vertex that is wrong is named.
    """
    array = np.array(
        numeric_array(name, value, "one row of coordinates [m] for each vertex"), float, order="C"
    )
    if shape is not None and array.shape != shape:
        raise SimCoreError(f"{name}: shape {array.shape} – the sheet needs {shape}")
    if not array.size:
        raise SimCoreError(f"{name}: shape {array.shape} – there is nothing in it")
    if (
        np.abs(array).max() <= FURTHEST
    ):  # as it nearly always is; sums over short rows would take ten times as long
        return array
    flat = array.reshape(len(array), -1) if array.ndim else array.reshape(1, 1)
    wrong = np.flatnonzero(~np.isfinite(flat).all(1))
    if len(wrong):
        raise SimCoreError(f"{name}: vertex {wrong[0]} is not finite")
    far = np.flatnonzero((np.abs(flat) > FURTHEST).any(1))
    if len(far):
        raise SimCoreError(f"{name}: vertex {far[0]} lies beyond {FURTHEST:g} – metres and seconds are meant")
    return array


def points(name: str, value: object) -> np.ndarray:
    """Points (N, 3) float64 [m], N of 0 or more, all finite and within reach."""
    array = np.ascontiguousarray(numeric_array(name, value, "points (N, 3) are meant"), float)
    if array.ndim != 2 or array.shape[1] != 3:
        raise SimCoreError(f"{name}: shape {array.shape} – points (N, 3) are meant")
    return coordinates(name, array) if len(array) else array


def triangles(name: str, value: object, count: int | None = None) -> np.ndarray:
    """Faces (F, 3) as whole numbers, F > 0, of vertices 0 to count - 1 where their count is given."""
    try:
        faces = np.ascontiguousarray(value)
    except (TypeError, ValueError, OverflowError):
        raise SimCoreError(f"{name}: rows of different length – expected (F, 3) integers, F > 0") from None
    kind = np.issubdtype(faces.dtype, np.integer)
    if faces.ndim != 2 or faces.shape[1:] != (3,) or not kind or not len(faces):
        raise SimCoreError(f"{name}: shape {faces.shape}, {faces.dtype} – expected (F, 3) integers, F > 0")
    if count is not None:
        index_range(name, faces, count)
    return faces


def index_range(name: str, index: np.ndarray, count: int) -> None:
    """Whole numbers of vertices that there are."""
    if index.size and (index.min() < 0 or index.max() >= count):
        wrong = index.max() if index.max() >= count else index.min()
        raise SimCoreError(f"{name}: index {wrong} – there are vertices 0 to {count - 1}")


def vertex_indices(name: str, value: object, count: int = MOST) -> tuple[int, ...]:
    """Vertices by their numbers, 0 to count - 1."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "iu" and value.ndim == 1:
        index_range(name, value, count)  # thousands at once, in every frame
        return tuple(value.tolist())
    try:
        found = tuple(value)  # type: ignore[arg-type]
    except TypeError:
        raise SimCoreError(
            f"{name}: {excerpt(value)} – give a sequence of vertices, such as [0, 9]; none: ()"
        ) from None
    for one in found:
        if not isinstance(one, numbers.Integral) or isinstance(one, bool):
            raise SimCoreError(f"{name}: {excerpt(one)} – vertices are named by whole numbers")
        if not 0 <= int(one) < count:
            raise SimCoreError(f"{name}: index {excerpt(one)} – there are vertices 0 to {count - 1}")
    return tuple(int(one) for one in found)


def vertex_pairs(name: str, value: object, count: int) -> np.ndarray:
    """Pairs of vertices (K, 2) int32, K of 0 or more."""
    array = numeric_array(name, value, "pairs of vertices (K, 2)")
    if array.size == 0:
        return np.zeros((0, 2), np.int32)
    if array.dtype.kind not in "iu" or array.ndim != 2 or array.shape[1] != 2:
        raise SimCoreError(f"{name}: shape {array.shape}, {array.dtype} – expected whole numbers (K, 2)")
    index_range(name, array, count)
    return np.ascontiguousarray(array, np.int32)
