"""A film of a run: every frame drawn and written as H.264."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.picture import Camera, Surface, render

SIZE = (640, 480)
_CLOTH, _SOLID = (0.55, 0.66, 0.72), (0.72, 0.66, 0.58)


def film_needs() -> None:
    """Raises SimCoreError where films cannot be made."""
    if find_spec("av") is None:
        raise SimCoreError("--video needs PyAV – pip install av")


def write_film(
    path: Path,
    frames: Iterable[np.ndarray],
    faces: np.ndarray,
    *,
    around: np.ndarray,
    solid: tuple[np.ndarray, np.ndarray] | None = None,
    rate: int = 25,
) -> None:
    """Draws positions (V, 3) of every frame; around (N, 3) [m] is what the camera keeps in view; whole or not at all.

    solid: vertices (S, 3), or (T, S, 3) after each frame, and faces of what the cloth lies on.
    """
    film_needs()
    import av

    low, high = around.min(0), around.max(0)
    middle, reach = (low + high) / 2, float((high - low).max())
    eye = middle + np.array([0.45, 0.3, 1.0]) * 1.6 * reach
    camera = Camera((eye[0], eye[1], eye[2]), (middle[0], middle[1], middle[2]), 36)
    beside = path.with_name(f".{path.name}")
    with av.open(str(beside), "w", format="mp4", options={"movflags": "+faststart"}) as film:
        stream: Any = film.add_stream("libx264", rate=rate)  # PyAV's stubs know no stream by a codec's name
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuv420p"
        stream.options = {"crf": "23", "preset": "medium"}
        for index, positions in enumerate(frames):
            surfaces = [Surface(positions.astype(float), faces, _CLOTH, sheen=0.3)]
            if solid is not None:
                places, sides = solid
                surfaces.append(Surface(places[index] if places.ndim == 3 else places, sides, _SOLID))
            picture = np.ascontiguousarray(render(surfaces, camera, SIZE))
            film.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        film.mux(stream.encode(None))
    beside.replace(path)
