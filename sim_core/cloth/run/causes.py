"""Why a frame could not be gone through: what is wrong with it, where, and the remedy."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from sim_core.cloth.contact.distance import distances
from sim_core.cloth.step.engine import Engine
from sim_core.cloth.step.frame import FRAME, Frame, State
from sim_core.errors import SimCoreError

CLOSE, FAR = (
    1 / 3,
    3.0,
)  # times its length, that an edge between two pins may have: `Health.whole` bears no more
DEEP = 0.5  # of the mean edge, that a vertex may lie in a solid: from deeper it is thrown out
THROWN = 300.0  # [m/s] that a pull may give a vertex within a frame, or a vertex may begin with
HOPELESS = 1e5  # [m/s] likewise, from which on it is not even tried
ONE_PLACE = 1e-3  # of its length, likewise of an edge between two pins that are led
TINY = 1e-4  # of the cloth's mean, from which on a vertex counts as too light or an edge as too short


def cause(engine: Engine, frame: Frame, begin: State, most: int, count: int) -> str:
    """A sentence: the first of what may be wrong with a frame that begins so, or that nothing of it is.

    begin: x, v (3, V) in band order; count: the steps that the explicit scheme would take, at most `most`.
    """
    looks: tuple[Callable[[], Iterator[str]], ...] = (
        lambda: _pins(engine, frame, begin.x, (CLOSE, FAR)),
        lambda: _pulls(engine, frame, THROWN),
        lambda: _inside(engine, frame, begin),
        lambda: _speeds(engine, begin),
        lambda: _steps(engine, begin, most, count),
    )
    found = (told for look in looks for told in look())
    return next(
        found,
        "no step is short enough – begin with the cloth smoother, or move what touches it more slowly",
    )


def _place(engine: Engine, at: np.ndarray, vertex: int) -> str:
    """The vertex, numbered in band order, as its caller knows it, and where it lies; at (3, V) [m]."""
    x, y, z = at[:, vertex]
    return f"vertex {engine.order[vertex]} at ({x:.4g}, {y:.4g}, {z:.4g})"


def _pins(engine: Engine, frame: Frame, x: np.ndarray, bears: tuple[float, float]) -> Iterator[str]:
    """Cloth between two pins that is pressed together, or torn, to more than a share of its length; x (3, V) [m]."""
    close, far = bears
    there, held = x.copy(), engine.inverse_mass(frame.pins) == 0.0
    there[:, engine.number[frame.led]] = frame.places.T
    a, b = engine.sheet.edges[held[engine.sheet.edges].all(1)].T
    rest = np.sqrt(engine.sheet.stencil.length2[held[engine.sheet.edges].all(1)])
    apart = np.linalg.norm(there[:, a] - there[:, b], axis=0)
    for n in np.flatnonzero((apart < close * rest) | (apart > far * rest))[:1]:
        first, second = sorted(int(engine.order[k]) for k in (a[n], b[n]))
        yield (
            f"pins {first} and {second} are to be {1000 * apart[n]:.3g} mm apart, the cloth between them is "
            f"{1000 * rest[n]:.3g} mm long – hold them between {1000 * CLOSE * rest[n]:.3g} and "
            f"{1000 * FAR * rest[n]:.3g} mm apart"
        )


def check_hands(engine: Engine, frame: Frame, x: np.ndarray) -> None:
    """Raises SimCoreError where somebody pulls so hard, or leads pins so close, that nothing good comes of it.

    x (V, 3) [m] in the caller's order.
    """
    looks = [_pulls(engine, frame, HOPELESS)]
    if len(frame.led):
        looks.append(_pins(engine, frame, engine.inward(x), (ONE_PLACE, np.inf)))
    for told in (told for look in looks for told in look):
        raise SimCoreError(told)


def _pulls(engine: Engine, frame: Frame, most: float) -> Iterator[str]:
    """Forces that make a vertex alone faster than `most` [m/s]."""
    if not len(frame.pulled):
        return
    inverse, force = engine.inverse_mass(frame.pins), np.linalg.norm(frame.pulls, axis=1)
    speed = force * inverse[engine.number[frame.pulled]] * FRAME
    n = int(speed.argmax())
    if speed[n] > most:
        yield (
            f"pulls: vertex {frame.pulled[n]} would be {speed[n]:.3g} m/s faster after the frame – pull it with "
            f"{force[n] * THROWN / speed[n]:.2g} N at most, not {force[n]:.3g}"
        )


def _inside(engine: Engine, frame: Frame, begin: State) -> Iterator[str]:
    """A start within a solid."""
    solid = engine.packed
    if engine.moving is not None:
        solid, (key, _) = engine.moving.packed(*frame.body)
        solid.blend[:] = key, 0.0
    if not len(solid.kind):
        return
    free = engine.inverse_mass(frame.pins) > 0.0
    depth = np.where(free, -distances(solid, begin.x.T), -np.inf)
    n = int(depth.argmax())
    if depth[n] > DEEP * _edge(engine):
        yield (
            f"{_place(engine, begin.x, n)} lies {1000 * depth[n]:.3g} mm inside the collider – begin with the cloth "
            "outside of it"
        )


def _speeds(engine: Engine, begin: State) -> Iterator[str]:
    """A vertex that is faster than any cloth."""
    speed = np.linalg.norm(begin.v, axis=0)
    n = int(speed.argmax())
    if speed[n] > THROWN:
        yield (
            f"{_place(engine, begin.x, n)} begins with {speed[n]:.3g} m/s – begin slower, at {THROWN:g} at most, or "
            "go back to before it was thrown"
        )


def _steps(engine: Engine, begin: State, most: int, count: int) -> Iterator[str]:
    """Edges so short, or cloth so light, that a frame takes too many steps."""
    if count <= most:
        return
    sheet, length = engine.sheet, np.sqrt(engine.sheet.stencil.length2)
    light, short = int(sheet.mass.argmin()), int(length.argmin())
    where = int(sheet.edges[short, 0]) if length[short] < TINY * length.mean() else light
    material = sheet.material
    yield (
        f"it would take {count:,} steps, {most:,} at most: edges of {1000 * length[short]:.3g} mm and more, "
        f"{1000 * sheet.mass[light]:.3g} g at a vertex and more (first {_place(engine, begin.x, where)}) are too "
        f"small for {material.density:.3g} kg/m², {material.stretch:.3g} N/m and {material.bend:.3g} N m – take a "
        "coarser mesh, a heavier cloth or a softer one"
    )


def _edge(engine: Engine) -> float:
    return float(np.sqrt(engine.sheet.stencil.length2.mean()))
