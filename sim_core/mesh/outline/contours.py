"""Outlines: what may be meshed, where they turn and what they enclose."""

from math import fsum, isfinite, sqrt

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.outline.crossings import enclosing, first_crossing
from sim_core.mesh.outline.touching_holes import merged

__all__ = [
    "CORNER_DEGREES",
    "LARGEST",
    "check_count",
    "check_edge",
    "clean_contour",
    "clean_contours",
    "clean_points",
    "cleaned_contours",
    "outline_turning",
    "sharpest_corner",
    "signed_area",
    "swept_area",
]

CORNER_DEGREES = 20.0
MOST_POINTS = 5_000_000  # vertices of one mesh: half a minute, 2 GB
LARGEST, LEAST = 1e6, 1e-6  # [m] coordinates and extent that arithmetic bears without overflow
FLAT = 1e-9  # of the squared extent: less area than this is none


def signed_area(contour: np.ndarray) -> float:
    """Area [m2] of a closed contour (n, 2), y down: positive where it runs counter-clockwise in (x, -y).

    Every product is split into two floats without error and all are summed exactly, so that a thin strip far from the
    origin has its area to the last bit.
    """
    return swept_area(contour, np.roll(contour, -1, axis=0))


def swept_area(a: np.ndarray, b: np.ndarray) -> float:
    """Area [m2] between the origin and directed edges a -> b (n, 2) each, y down, summed exactly."""
    terms = [*_product(a[:, 0], -b[:, 1]), *_product(b[:, 0], a[:, 1])]
    return 0.5 * fsum(np.concatenate(terms).tolist())


def _product(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """a * b as the rounded product and its rounding error (Dekker)."""
    (a_high, a_low), (b_high, b_low) = _halves(a), _halves(b)
    product = a * b
    return product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)


def _halves(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    turned = (2.0**27 + 1) * a
    high = turned - (turned - a)
    return high, a - high


def check_edge(edge: float, contours: list[np.ndarray], most: int = MOST_POINTS) -> None:
    """Raise OutlineError unless edge [m] is a positive length no longer than the panel, and not absurdly short."""
    if not (isfinite(edge) and edge > 0):
        raise OutlineError(f"edge {edge} m – give a positive length in metres")
    if edge > float(np.ptp(contours[0], axis=0).max()) and edge > (longest := _longest(contours[0])):
        raise OutlineError(f"edge {edge} m is longer than the panel ({longest:.4g} m) – give a smaller edge")
    check_count(edge, contours, most)


def _longest(contour: np.ndarray) -> float:
    """Longer side [m] of the smallest rectangle around a contour, however it is turned."""
    from shapely import MultiPoint, get_coordinates

    sides = np.diff(get_coordinates(MultiPoint(contour).minimum_rotated_rectangle), axis=0)
    return float(np.hypot(*sides.T).max()) * (1 + 1e-9)


def check_count(edge: float, contours: list[np.ndarray], most: int = MOST_POINTS) -> None:
    """Raise OutlineError where a mesh of the contours at `edge` [m] would have far more than `most` vertices.

    Counted before anything is made: the lattice over the outline's rectangle and the steps along all contours.
    """
    wide, high = (float(side) for side in np.ptp(contours[0], axis=0))
    along = sum(float(np.hypot(*(c - np.roll(c, 1, axis=0)).T).sum()) for c in contours)
    # area / edge^2 + along / edge = most, solved for the edge
    area = wide * high * 2 / sqrt(3)
    least = (along + sqrt(along * along + 4 * most * area)) / (2 * most)
    if edge < least:
        raise OutlineError(f"edge {edge} m makes more than {most} vertices – give at least {least:.2g} m")


def clean_points(points, name: str) -> np.ndarray:
    """A list of points as (n, 2) float64 [m]; raises OutlineError naming it where it is none, or not finite."""
    try:
        contour = np.array(points, dtype=float)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise OutlineError(f"{name}: not a list of [x, y] pairs of numbers") from error
    if contour.size == 0:
        raise OutlineError(f"{name}: 0 points – give at least three [x, y] pairs in metres")
    if contour.ndim != 2 or contour.shape[1] != 2:
        raise OutlineError(f"{name}: shape {contour.shape} – give [x, y] pairs, shape (N, 2)")
    bad = np.flatnonzero(~np.isfinite(contour).all(axis=1))
    if bad.size:
        raise OutlineError(
            f"{name}: point {bad[0]} is {contour[bad[0]].tolist()} – coordinates must be finite"
        )
    far = int(np.abs(contour).max(axis=1).argmax())
    if np.abs(contour[far]).max() > LARGEST:
        raise OutlineError(
            f"{name}: point {far} is {contour[far].tolist()} – give metres, at most {LARGEST:g}"
        )
    return contour


def clean_contour(points, name: str) -> np.ndarray:
    """A contour as (n, 2) float64 [m] without repeated points.

    Raises OutlineError naming the contour where it is empty, not finite, of fewer than three points or without area.
    """
    contour = clean_points(points, name)
    extent = float(np.ptp(contour, axis=0).max())
    if 0 < extent < LEAST:
        raise OutlineError(f"{name}: {extent:.2g} m across – give metres, at least {LEAST:g} across")
    gaps = np.hypot(*(contour - np.roll(contour, 1, axis=0)).T)
    contour = contour[gaps > 1e-7 * extent] if extent > 0 else contour[:1]
    if len(contour) < 3:
        raise OutlineError(f"{name}: {len(contour)} different points – a contour needs at least three")
    arms = contour - contour[0]
    longest = arms[(arms**2).sum(axis=1).argmax()]
    if np.abs(arms[:, 0] * longest[1] - arms[:, 1] * longest[0]).max() < FLAT * extent**2:
        raise OutlineError(f"{name}: zero area – its points lie on one line")
    return contour


def clean_contours(outline, holes, *, edge: float | None = None) -> list[np.ndarray]:
    """The outline and its holes, checked and turned so that the cloth lies to their left in (x, -y).

    edge: [m]; with it, holes that touch the outline or each other are merged with a warning (`touching_holes.py`).
    Raises OutlineError for crossing contours (naming the segments), zero area, and holes outside.
    """
    return cleaned_contours(outline, holes, edge=edge)[0]


def cleaned_contours(
    outline, holes, *, edge: float | None = None
) -> tuple[list[np.ndarray], list[np.ndarray] | None]:
    """`clean_contours`, and the rim of the cloth as it was given where holes were merged (None elsewhere)."""
    named = [("outline", clean_contour(outline, "outline"))]
    named += [(f"hole {k}", clean_contour(hole, f"hole {k}")) for k, hole in enumerate(holes)]
    for name, contour in named:
        _check_crossings([(name, contour)])
    given = None
    if edge is not None and len(named) > 1:
        named, given = merged(named, edge)
    _check_crossings(named)
    contours = []
    for name, contour in named:
        area = signed_area(contour)
        if abs(area) < FLAT * float(np.ptp(contour, axis=0).max()) ** 2:
            raise OutlineError(f"{name}: zero area – it runs back along itself")
        outer = not contours
        contours.append(contour if (area > 0) == outer else contour[::-1].copy())
    _check_nesting([name for name, _ in named], contours)
    return contours, given


def _check_crossings(named: list[tuple[str, np.ndarray]]) -> None:
    contours = [contour for _, contour in named]
    points = np.concatenate(contours)
    owner = np.repeat(np.arange(len(contours)), [len(c) for c in contours])
    first = np.concatenate([[0], np.cumsum([len(c) for c in contours])])
    following = np.concatenate(
        [np.roll(np.arange(len(c)), -1) + s for c, s in zip(contours, first, strict=False)]
    )
    i, j = first_crossing(points, following)
    if i < 0:
        return
    i, j = min(i, j), max(i, j)
    k, m = owner[i], owner[j]
    here, there = i - first[k], j - first[m]
    spot = f"near ({points[i, 0]:.4f}, {points[i, 1]:.4f}) m"
    if k == m:
        raise OutlineError(
            f"{named[k][0]}: crosses or touches itself, segment {here} (point {here} to {here + 1}) and segment "
            f"{there}, {spot} – draw it as a simple closed curve"
        )
    raise OutlineError(
        f"{named[k][0]} segment {here} and {named[m][0]} segment {there} cross or touch {spot} – keep them apart"
    )


def _check_nesting(names: list[str], contours: list[np.ndarray]) -> None:
    around = enclosing(contours)[1:]
    if (outside := np.flatnonzero(around < 0)).size:
        raise OutlineError(f"{names[outside[0] + 1]}: lies outside the outline – holes belong inside it")
    if (nested := np.flatnonzero(around > 0)).size:
        inner, outer = names[nested[0] + 1], names[around[nested[0]]]
        raise OutlineError(f"{inner}: lies inside {outer} – holes must not be nested")


def outline_turning(contour: np.ndarray) -> np.ndarray:
    """Angle [degrees] by which a closed contour turns at each point."""
    ahead = np.roll(contour, -1, axis=0) - contour
    behind = contour - np.roll(contour, 1, axis=0)
    cross = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
    return np.degrees(np.abs(np.arctan2(cross, (behind * ahead).sum(axis=1))))


def sharpest_corner(contours: list[np.ndarray]) -> float:
    """Smallest angle [degrees] on the cloth's side between neighbouring steps; contours have the cloth on their left.

    No triangle there can have a larger smallest angle.
    """
    least = 180.0
    for contour in contours:
        ahead = np.roll(contour, -1, axis=0) - contour
        behind = np.roll(contour, 1, axis=0) - contour
        # y points down, so the turn from ahead to behind is counter-clockwise in (x, -y) with this sign
        cross = ahead[:, 1] * behind[:, 0] - ahead[:, 0] * behind[:, 1]
        inner = np.degrees(np.arctan2(cross, (ahead * behind).sum(axis=1))) % 360
        least = min(least, float(inner.min()))
    return least
