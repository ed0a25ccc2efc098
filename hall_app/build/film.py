"""The film of a drape: filmed while it is simulated, then once round the garment at rest. And stills."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hall_app.build.encoding import encode_film

__all__ = ["SIZE", "STUDIO", "Film", "Look", "Part", "Piece", "filming", "stills"]

STUDIO = 2  # raise it where pictures look different: those of garments that are kept are then taken anew
SIZE = (720, 540)  # pixels
RATE = 25  # pictures per second, of the film and of the simulation
ROUND = 75  # pictures of the walk round the finished garment
TOGETHER = 8  # pictures that follow each other, between whose first and last the sky's light changes evenly
SEEN = 0.0012  # of the height that is seen: half a pixel; what has moved by less since the last picture is no picture
STILLS = {"front": 18.0, "side": 74.0, "back": 196.0}  # [deg] about +y from the front

Picture = NDArray[np.uint8]
Moved = Sequence[NDArray[np.floating] | None]


@dataclass(frozen=True)
class Part:
    """Triangles of one look: faces (F, 3) int32, sRGB colour 0..1; alpha: share of the light it stops, seen head-on;
    gloss, sheen: 0..1, fabric (a `sim_core.picture.Fabric`) and corners (F, 3, 2) [m] as its `Surface` has them."""

    faces: NDArray[np.int32]
    colour: tuple[float, float, float]
    alpha: float = 1.0
    gloss: float = 0.0
    sheen: float = 0.0
    fabric: Any = None
    corners: NDArray[np.floating] | None = None


@dataclass(frozen=True)
class Piece:
    """Something that is shown: vertices (V, 3) [m], its parts, and by how much it is raised [m]."""

    vertices: NDArray[np.floating]
    parts: tuple[Part, ...]
    lift: float = 0.0


@dataclass(frozen=True)
class Look:
    """All that a picture shows, what moves first; height seen [m].

    Where each of the first pieces is now is told picture by picture: its vertices, or None before it is put on.
    """

    pieces: tuple[Piece, ...]
    height: float


def _surfaces(look: Look, moved: Moved = ()) -> list[Any]:
    """What is drawn; moved: of the first pieces."""
    from sim_core.picture import Surface

    drawn = []
    for number, piece in enumerate(look.pieces):
        vertices = moved[number] if number < len(moved) else piece.vertices
        if vertices is None:
            continue
        raised = np.asarray(vertices, float) + [0.0, piece.lift, 0.0]
        for part in piece.parts:
            through = 0.3 if part.alpha < 1 else 0.0
            more = {"alpha": part.alpha, "gloss": part.gloss, "sheen": part.sheen, "through": through}
            woven = {"fabric": part.fabric, "corners": part.corners}
            drawn.append(Surface(raised, part.faces, part.colour, **more, **woven))
    return drawn


def _camera(look: Look, angle: float, size: tuple[int, int]) -> Any:
    """Where all of the garment is seen from `angle` [deg] about +y, 0 = the front, in a picture of `size` pixels: as
    far off for all angles."""
    from sim_core.picture import Camera

    turn, middle = math.radians(angle), look.height / 2
    reach = max(float(np.hypot(*piece.vertices[:, [0, 2]].T).max()) for piece in look.pieces)
    half = max(1.28 * look.height / 2, 1.12 * reach * size[1] / size[0])
    away = half / math.tan(math.radians(15))
    eye = (away * math.sin(turn), middle + 0.12 * look.height, away * math.cos(turn))
    return Camera(eye, (0.0, middle, 0.0), 30.0)


def _light(angle: float) -> Any:
    """The light of a picture from `angle`: as on a turntable, what is seen is lit as the front is."""
    from sim_core.picture import Light

    turn, (x, y, z) = math.radians(angle - STILLS["front"]), Light().key
    return Light((x * math.cos(turn) + z * math.sin(turn), y, z * math.cos(turn) - x * math.sin(turn)))


class Film:
    """Pictures under way in processes of their own, while this one simulates."""

    def __init__(
        self, look: Look, pool: ProcessPoolExecutor, clerk: ThreadPoolExecutor, folder: Path
    ) -> None:
        self._look, self._pool, self._clerk, self._folder = look, pool, clerk, folder
        self._pictures: list[Future[None]] = []
        self._waiting: list[_Picture] = []
        self._count = 0
        self._last: tuple[Moved, float] | None = None  # what the last picture shows, and from where
        self._encoding: Future[None] | None = None
        folder.mkdir(parents=True, exist_ok=True)

    def shoot(self, moved: Moved, angle: float = STILLS["front"]) -> None:
        """The next picture, if anybody sees that anything moved since the last; what an interrupted build left is kept.

        Cloth creeps for seconds before it rests: nobody watches that, so it goes by faster.
        moved: vertices of the look's first pieces as they are now, None for what is not worn yet.
        """
        if self._last is not None and angle == self._last[1]:
            if _away(moved, self._last[0]) < SEEN * self._look.height:
                return
        if self._waiting and _worn(self._waiting[0].moved) != _worn(moved):
            self._draw()  # light changes evenly only between pictures of the same things
        path = self._folder / f"{self._count:05d}.png"
        self._count += 1
        copied = tuple(None if x is None else np.array(x) for x in moved)
        self._last = copied, angle
        self._waiting.append(_Picture(copied, angle, path))
        if len(self._waiting) == TOGETHER:
            self._draw()

    def walk_round(self, moved: Moved) -> None:
        """Once round the finished garment, slowly beginning and ending."""
        self._draw()
        shares = np.arange(1, ROUND + 1) / ROUND
        for angle in STILLS["front"] + 360.0 * shares * shares * (3 - 2 * shares):
            self.shoot(moved, float(angle))
        self._draw()

    def _draw(self) -> None:
        if self._waiting:
            self._pictures.append(self._pool.submit(_shoot, self._look, self._waiting))
        self._waiting = []

    def stills(self, look: Look, folder: Path) -> None:
        """The pictures of `stills`, likewise beside this process."""
        self._pictures.append(self._pool.submit(stills, look, folder))

    def encode(self, paths: tuple[Path, ...], sound: Callable[[], NDArray[np.float32]]) -> None:
        """Encodes what was shot into every one of `paths`, side by side, as soon as it is drawn."""
        self._draw()
        self._encoding = self._clerk.submit(self._encoded, paths, sound)

    def wait(self, tick: Callable[[float], None]) -> None:
        """Until all is drawn and encoded; raises what went wrong there."""
        for number, future in enumerate(self._pictures):
            future.result()
            tick(0.8 * number / len(self._pictures))
        if self._encoding is not None:
            self._encoding.result()
        tick(1.0)

    def _encoded(self, paths: tuple[Path, ...], sound: Callable[[], NDArray[np.float32]]) -> None:
        heard = self._pool.submit(sound)
        for future in (*self._pictures, heard):
            future.result()
        films = [
            self._pool.submit(_encode, path, self._folder, self._count, heard.result()) for path in paths
        ]
        for film in films:
            film.result()


@dataclass(frozen=True)
class _Picture:
    """One picture of a film: vertices of what moves, from where it is seen [deg], and its file."""

    moved: tuple[NDArray[np.floating] | None, ...]
    angle: float
    path: Path


def _worn(moved: Moved) -> list[bool]:
    return [vertices is not None for vertices in moved]


def _away(moved: Moved, other: Moved) -> float:
    """How far [m] anything has moved from one picture to another; infinite where they are not of the same things."""
    if _worn(moved) != _worn(other):
        return math.inf
    pairs = zip(moved, other, strict=True)
    away = (np.linalg.norm(a - b, axis=1).max() for a, b in pairs if a is not None and b is not None)
    return float(max(away, default=0.0))


def _encode(path: Path, folder: Path, count: int, sound: NDArray[np.float32] | None) -> None:
    from PIL import Image

    def shown(index: int) -> Picture:
        with Image.open(folder / f"{index:05d}.png") as image:
            return np.asarray(image.convert("RGB"))

    encode_film(path, shown, count, rate=RATE, sound=sound)


def _shoot(look: Look, pictures: Sequence[_Picture]) -> None:
    """Draws what follows each other; what is there already is kept, so that the same light falls on the others."""
    from PIL import Image

    from sim_core.picture import lighting, render

    if all(picture.path.is_file() for picture in pictures):
        return
    scenes = [_surfaces(look, picture.moved) for picture in pictures]
    first = lighting(scenes[0]).sky
    still = _away(pictures[0].moved, pictures[-1].moved) == 0.0
    last = first if still else lighting(scenes[-1]).sky
    for number, (picture, surfaces) in enumerate(zip(pictures, scenes, strict=True)):
        if picture.path.is_file():
            continue
        share = number / max(1, len(pictures) - 1)
        lit = lighting(surfaces, _light(picture.angle), sky=(1.0 - share) * first + share * last)
        shown = render(surfaces, _camera(look, picture.angle, SIZE), SIZE, lit=lit)
        partial = picture.path.with_suffix(".part")
        Image.fromarray(shown).save(partial, format="png", compress_level=1)
        partial.replace(picture.path)


@contextmanager
def filming(look: Look, folder: Path) -> Iterator[Film]:
    """A film whose pictures are drawn beside the simulation; on an error what is under way is given up."""
    pool = ProcessPoolExecutor(
        2,
        mp_context=get_context("spawn"),
        initializer=os.nice,
        initargs=(10,),  # the simulation goes first
    )
    with ThreadPoolExecutor(1, "film") as clerk:  # who waits for the pictures and has them encoded
        try:
            yield Film(look, pool, clerk, folder)
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def stills(look: Look, folder: Path) -> None:
    """Pictures from front, side and back, and the film's poster, as JPEG."""
    from PIL import Image

    from sim_core.picture import lighting, render

    surfaces = _surfaces(look)
    sky = lighting(surfaces).sky
    views = {"drape": (STILLS["front"], SIZE)}
    views |= {f"still-{name}": (angle, (900, 1125)) for name, angle in STILLS.items()}
    for name, (angle, size) in views.items():
        lit = lighting(surfaces, _light(angle), sky=sky)
        shown = render(surfaces, _camera(look, angle, size), size, lit=lit)
        Image.fromarray(shown).save(folder / f"{name}.jpg", quality=88, optimize=True)
