"""The film of a drape: filmed while it is simulated, then once round the garment at rest. And stills."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hall_app.build.encoding import encode_film

__all__ = ["Film", "Look", "SIZE", "Solid", "filming", "stills"]

SIZE = (720, 540)  # pixels
RATE = 25  # pictures per second, of the film and of the simulation
ROUND = 75  # pictures of the walk round the finished garment
STILLS = {"front": 18.0, "side": 74.0, "back": 196.0}  # [deg] about +y from the front

Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Solid:
    """Something beside the cloth: mesh, sRGB colour 0..1, gloss; lift [m] it stands above its own y = 0."""

    vertices: NDArray[np.floating]
    faces: NDArray[np.int32]
    colour: tuple[float, float, float]
    gloss: float
    lift: float = 0.0


@dataclass(frozen=True)
class Look:
    """What stays the same in every picture.

    cloth: faces (F, 3) and colour, sRGB 0..1, of each part; solids: the first may move; alpha: cover of the cloth;
    height seen [m]; lift [m] of the cloth.
    """

    cloth: tuple[tuple[NDArray[np.int32], tuple[float, float, float]], ...]
    solids: tuple[Solid, ...]
    alpha: float
    height: float
    lift: float = 0.0


def _surfaces(
    look: Look, positions: NDArray[np.floating], moved: NDArray[np.floating] | None = None
) -> list[Any]:
    """What is drawn; moved: vertices of the first solid."""
    from sim_core.picture import Surface

    x = np.asarray(positions, float) + [0.0, look.lift, 0.0]
    cloth = [
        Surface(x, faces, colour, alpha=look.alpha, sheen=0.5, through=0.3 if look.alpha < 1 else 0.0)
        for faces, colour in look.cloth
    ]
    solids = []
    for number, solid in enumerate(look.solids):
        vertices = solid.vertices if moved is None or number else moved
        raised = np.asarray(vertices, float) + [0.0, solid.lift, 0.0]
        solids.append(Surface(raised, solid.faces, solid.colour, gloss=solid.gloss))
    return [*cloth, *solids]


def _camera(look: Look, angle: float) -> Any:
    """Where the garment is seen from `angle` [deg] about +y, 0 = the front."""
    from sim_core.picture import Camera

    turn, middle = math.radians(angle), look.height / 2
    away = 1.28 * look.height / (2 * math.tan(math.radians(15)))
    eye = (away * math.sin(turn), middle + 0.12 * look.height, away * math.cos(turn))
    return Camera(eye, (0.0, middle, 0.0), 30.0)


class Film:
    """Pictures under way in processes of their own, while this one simulates."""

    def __init__(self, look: Look, pool: ProcessPoolExecutor, folder: Path) -> None:
        self._look, self._pool, self._folder = look, pool, folder
        self._pictures: list[Future[None]] = []
        self._count = 0
        folder.mkdir(parents=True, exist_ok=True)

    def shoot(
        self,
        positions: NDArray[np.floating],
        moved: NDArray[np.floating] | None = None,
        angles: Sequence[float] = (STILLS["front"],),
    ) -> None:
        """The next pictures, of one state of the cloth from each angle; what an interrupted build left is kept."""
        views = [
            (float(angle), self._folder / f"{self._count + number:05d}.png")
            for number, angle in enumerate(angles)
        ]
        self._count += len(views)
        self._pictures.append(self._pool.submit(_shoot, self._look, np.array(positions), moved, views))

    def walk_round(self, positions: NDArray[np.floating], moved: NDArray[np.floating] | None = None) -> None:
        """Once round the finished garment, slowly beginning and ending."""
        shares = np.arange(1, ROUND + 1) / ROUND
        angles = STILLS["front"] + 360.0 * shares * shares * (3 - 2 * shares)
        for piece in np.array_split(angles, 6):
            self.shoot(positions, moved, piece.tolist())

    def write(
        self, paths: tuple[Path, ...], sound: NDArray[np.float32] | None, tick: Callable[[float], None]
    ) -> None:
        """Encode what was shot into every one of `paths`, side by side."""
        for number, future in enumerate(self._pictures):
            future.result()
            tick(0.8 * number / len(self._pictures))
        films = [self._pool.submit(_encode, path, self._folder, self._count, sound) for path in paths]
        for number, film in enumerate(films):
            film.result()
            tick(0.8 + 0.2 * (number + 1) / len(films))


def _encode(path: Path, folder: Path, count: int, sound: NDArray[np.float32] | None) -> None:
    from PIL import Image

    def shown(index: int) -> Picture:
        with Image.open(folder / f"{index:05d}.png") as image:
            return np.asarray(image.convert("RGB"))

    encode_film(path, shown, count, rate=RATE, sound=sound)


def _shoot(
    look: Look,
    positions: NDArray[np.floating],
    moved: NDArray[np.floating] | None,
    views: list[tuple[float, Path]],
) -> None:
    from PIL import Image

    from sim_core.picture import lighting, render

    left = [(angle, path) for angle, path in views if not path.is_file()]
    if not left:
        return
    surfaces = _surfaces(look, positions, moved)
    lit = lighting(surfaces)
    for angle, path in left:
        partial = path.with_suffix(".part")
        shown = render(surfaces, _camera(look, angle), SIZE, lit=lit)
        Image.fromarray(shown).save(partial, format="png", compress_level=1)
        partial.replace(path)


@contextmanager
def filming(look: Look, folder: Path) -> Iterator[Film]:
    """A film whose pictures are drawn beside the simulation; on an error what is under way is given up."""
    pool = ProcessPoolExecutor(
        2,
        mp_context=get_context("spawn"),
        initializer=os.nice,
        initargs=(10,),  # the simulation goes first
    )
    try:
        yield Film(look, pool, folder)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def stills(look: Look, positions: NDArray[np.floating], folder: Path) -> None:
    """Pictures from front, side and back, and the film's poster, as JPEG."""
    from PIL import Image

    from sim_core.picture import lighting, render

    surfaces = _surfaces(look, positions)
    lit = lighting(surfaces)
    views = {"drape": (STILLS["front"], SIZE)}
    views |= {f"still-{name}": (angle, (900, 1125)) for name, angle in STILLS.items()}
    for name, (angle, size) in views.items():
        shown = render(surfaces, _camera(look, angle), size, lit=lit)
        Image.fromarray(shown).save(folder / f"{name}.jpg", quality=88, optimize=True)
