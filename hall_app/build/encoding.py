"""Films from pictures: VP9/Opus WebM and H.264/AAC MP4, since some browser builds play only one of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hall_app.media.encode import mux_sound
from hall_app.media.strings import RATE

__all__ = ["FilmUnavailableError", "encode_film", "film_possible"]

Picture = NDArray[np.uint8]

SOUND_RATE = RATE  # [Hz] 48,000, the one Opus has
BIT_RATE = 40_000  # [bit/s] of the sound, mono: plucked strings sound as they do at twice as much


@dataclass(frozen=True)
class _Codecs:
    """How one kind of film is written."""

    picture: str
    sound: str
    options: dict[str, str]
    container: dict[str, str]


# Beside crf 34 and 24 no difference is seen on a dress 720 pixels wide, and a patterned robe takes half the bytes.
_CODECS = {
    ".webm": _Codecs(
        "libvpx-vp9",
        "libopus",
        {"crf": "40", "b": "0", "cpu-used": "4", "row-mt": "1", "deadline": "good"},
        {},
    ),
    ".mp4": _Codecs("libx264", "aac", {"crf": "27", "preset": "medium"}, {"movflags": "+faststart"}),
}


class FilmUnavailableError(RuntimeError):
    """PyAV is not installed: films cannot be made on this machine."""


def film_possible() -> bool:
    """True when PyAV is installed, as it is unless somebody left it out."""
    from importlib.util import find_spec

    return find_spec("av") is not None


def encode_film(
    path: Path,
    frames: Callable[[int], Picture],
    count: int,
    *,
    rate: int = 25,
    sound: NDArray[np.float32] | None = None,
) -> None:
    """Write `count` pictures (h, w, 3), h and w even, at `rate` per second to a .webm or .mp4.

    sound: (n,) mono samples -1..1 at 48 kHz, cut or padded to the film's length. The file appears whole or not
    at all. Raises FilmUnavailableError without PyAV.
    """
    if not film_possible():
        raise FilmUnavailableError("films need PyAV – pip install av")
    import av

    codecs = _CODECS[path.suffix]
    partial = path.with_name(f".{path.name}")
    with av.open(str(partial), "w", format=path.suffix[1:], options=codecs.container) as container:
        # PyAV's stubs know no stream by a codec's name.
        video: Any = container.add_stream(codecs.picture, rate=rate)
        audio: Any = (
            container.add_stream(codecs.sound, rate=SOUND_RATE, layout="mono") if sound is not None else None
        )
        video.options = codecs.options
        if audio is not None:
            audio.bit_rate = BIT_RATE
        _write_pictures(container, video, frames, count)
        if sound is not None:
            mux_sound(container, audio, codecs.sound, _fitted(sound, count / rate)[:, None])
    partial.replace(path)


def _write_pictures(container, stream, frames: Callable[[int], Picture], count: int) -> None:
    import av

    for index in range(count):
        picture = np.ascontiguousarray(frames(index))
        if index == 0:
            stream.height, stream.width = picture.shape[:2]
            stream.pix_fmt = "yuv420p"
        container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
    container.mux(stream.encode(None))


def _fitted(sound: NDArray[np.float32], seconds: float) -> NDArray[np.float32]:
    """The first `seconds` of the sound, faded in and out."""
    wanted = int(seconds * SOUND_RATE)
    fitted = np.zeros(wanted, np.float32)
    fitted[: min(wanted, len(sound))] = sound[:wanted]
    ramp = np.minimum(1.0, np.arange(wanted) / (0.5 * SOUND_RATE))
    return (fitted * ramp * ramp[::-1]).astype(np.float32)
