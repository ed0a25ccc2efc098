"""The film of a drape: filmed while it is simulated, then once round the garment at rest. And stills."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .encode import encode_film

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


def picture(
    look: Look,
    positions: NDArray[np.floating],
    angle: float,
    size: tuple[int, int],
    moved: NDArray[np.floating] | None = None,
) -> Picture:
    """The garment seen from `angle` [deg] about +y, 0 = the front; moved: vertices of the first solid."""
    from sim_core.picture import Camera, Surface, render

    turn, middle = math.radians(angle), look.height / 2
    away = 1.28 * look.height / (2 * math.tan(math.radians(15)))
    eye = (away * math.sin(turn), middle + 0.12 * look.height, away * math.cos(turn))
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
    return render([*cloth, *solids], Camera(eye, (0.0, middle, 0.0), 30.0), size)


class Film:
    """Pictures under way in processes of their own, while this one simulates."""

    def __init__(self, look: Look, pool: ProcessPoolExecutor, folder: Path) -> None:
        self._look, self._pool, self._folder = look, pool, folder
        self._pictures: list[Future[None]] = []
        folder.mkdir(parents=True, exist_ok=True)

    def shoot(
        self,
        positions: NDArray[np.floating],
        moved: NDArray[np.floating] | None = None,
        angle: float = STILLS["front"],
    ) -> None:
        """Take the next picture; one that lies there from an interrupted build is kept."""
        path = self._folder / f"{len(self._pictures):05d}.png"
        self._pictures.append(self._pool.submit(_shoot, self._look, np.array(positions), moved, angle, path))

    def walk_round(self, positions: NDArray[np.floating], moved: NDArray[np.floating] | None = None) -> None:
        """Once round the finished garment, slowly beginning and ending."""
        for index in range(1, ROUND + 1):
            share = index / ROUND
            eased = share * share * (3 - 2 * share)
            self.shoot(positions, moved, STILLS["front"] + 360.0 * eased)

    def write(
        self, paths: tuple[Path, ...], sound: NDArray[np.float32] | None, tick: Callable[[float], None]
    ) -> None:
        """Encode what was shot into every one of `paths`."""
        from PIL import Image

        count = len(self._pictures)
        for number, future in enumerate(self._pictures):
            future.result()
            tick(0.8 * number / count)

        def shown(index: int) -> Picture:
            with Image.open(self._folder / f"{index:05d}.png") as image:
                return np.asarray(image.convert("RGB"))

        for number, path in enumerate(paths):
            encode_film(path, shown, count, rate=RATE, sound=sound)
            tick(0.8 + 0.2 * (number + 1) / len(paths))


def _shoot(
    look: Look,
    positions: NDArray[np.floating],
    moved: NDArray[np.floating] | None,
    angle: float,
    path: Path,
) -> None:
    from PIL import Image

    if path.is_file():
        return
    partial = path.with_suffix(".part")
    Image.fromarray(picture(look, positions, angle, SIZE, moved)).save(
        partial, format="png", compress_level=1
    )
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

    poster = picture(look, positions, STILLS["front"], SIZE)
    Image.fromarray(poster).save(folder / "drape.jpg", quality=88, optimize=True)
    for name, angle in STILLS.items():
        Image.fromarray(picture(look, positions, angle, (900, 1125))).save(
            folder / f"still-{name}.jpg", quality=88, optimize=True
        )
