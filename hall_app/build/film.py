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

__all__ = ["SIZE", "Film", "Look", "Part", "Piece", "filming", "stills"]

SIZE = (720, 540)  # pixels
RATE = 25  # pictures per second, of the film and of the simulation
ROUND = 75  # pictures of the walk round the finished garment
STILLS = {"front": 18.0, "side": 74.0, "back": 196.0}  # [deg] about +y from the front

Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Part:
    """Triangles of one look: faces (F, 3) int32, sRGB colour 0..1; alpha: share of the light it stops, seen head-on;
    gloss, sheen: 0..1, as `sim_core.picture.Surface` has them."""

    faces: NDArray[np.int32]
    colour: tuple[float, float, float]
    alpha: float = 1.0
    gloss: float = 0.0
    sheen: float = 0.0


@dataclass(frozen=True)
class Piece:
    """Something that is shown: vertices (V, 3) [m], its parts, and by how much it is raised [m]."""

    vertices: NDArray[np.floating]
    parts: tuple[Part, ...]
    lift: float = 0.0


@dataclass(frozen=True)
class Look:
    """All that a picture shows, what moves first; height seen [m]."""

    pieces: tuple[Piece, ...]
    height: float


def _surfaces(look: Look, moved: Sequence[NDArray[np.floating]] = ()) -> list[Any]:
    """What is drawn; moved: vertices of the first pieces."""
    from sim_core.picture import Surface

    drawn = []
    for number, piece in enumerate(look.pieces):
        vertices = moved[number] if number < len(moved) else piece.vertices
        raised = np.asarray(vertices, float) + [0.0, piece.lift, 0.0]
        for part in piece.parts:
            through = 0.3 if part.alpha < 1 else 0.0
            more = {"alpha": part.alpha, "gloss": part.gloss, "sheen": part.sheen, "through": through}
            drawn.append(Surface(raised, part.faces, part.colour, **more))
    return drawn


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
        moved: Sequence[NDArray[np.floating]],
        angles: Sequence[float] = (STILLS["front"],),
    ) -> None:
        """The next pictures, one from each angle; what an interrupted build left is kept.

        moved: vertices of the look's first pieces as they are now.
        """
        views = [
            (float(angle), self._folder / f"{self._count + number:05d}.png")
            for number, angle in enumerate(angles)
        ]
        self._count += len(views)
        self._pictures.append(self._pool.submit(_shoot, self._look, [np.array(x) for x in moved], views))

    def walk_round(self, moved: Sequence[NDArray[np.floating]]) -> None:
        """Once round the finished garment, slowly beginning and ending."""
        shares = np.arange(1, ROUND + 1) / ROUND
        angles = STILLS["front"] + 360.0 * shares * shares * (3 - 2 * shares)
        for piece in np.array_split(angles, 6):
            self.shoot(moved, piece.tolist())

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
    moved: Sequence[NDArray[np.floating]],
    views: list[tuple[float, Path]],
) -> None:
    from PIL import Image

    from sim_core.picture import lighting, render

    left = [(angle, path) for angle, path in views if not path.is_file()]
    if not left:
        return
    surfaces = _surfaces(look, moved)
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


def stills(look: Look, folder: Path) -> None:
    """Pictures from front, side and back, and the film's poster, as JPEG."""
    from PIL import Image

    from sim_core.picture import lighting, render

    surfaces = _surfaces(look)
    lit = lighting(surfaces)
    views = {"drape": (STILLS["front"], SIZE)}
    views |= {f"still-{name}": (angle, (900, 1125)) for name, angle in STILLS.items()}
    for name, (angle, size) in views.items():
        shown = render(surfaces, _camera(look, angle), size, lit=lit)
        Image.fromarray(shown).save(folder / f"{name}.jpg", quality=88, optimize=True)
