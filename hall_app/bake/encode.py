"""Films from pictures: VP9/Opus WebM and H.264/AAC MP4, since some browser builds play only one of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["FilmUnavailableError", "encode_film", "film_possible"]

Picture = NDArray[np.uint8]

SOUND_RATE = 48_000  # [Hz], the one Opus has
_CODECS = {
    ".webm": (
        "libvpx-vp9",
        {"crf": "34", "b": "0", "cpu-used": "4", "row-mt": "1", "deadline": "good"},
        "libopus",
    ),
    ".mp4": ("libx264", {"crf": "24", "preset": "medium", "movflags": "+faststart"}, "aac"),
}


class FilmUnavailableError(RuntimeError):
    """PyAV is not installed: films cannot be made on this machine."""


def film_possible() -> bool:
    """True when the extra 'bake' (PyAV) is installed."""
    from importlib.util import find_spec

    return find_spec("av") is not None


def encode_film(
    path: Path,
    frames: Callable[[int], Picture],
    count: int,
    *,
    rate: int = 25,
    sound: NDArray[np.float32] | None = None,
    tick: Callable[[int], None] = lambda index: None,
) -> None:
    """Write `count` pictures (h, w, 3), h and w even, at `rate` per second to a .webm or .mp4.

    sound: (n,) mono samples -1..1 at 48 kHz, cut or padded to the film's length. The file appears whole or not
    at all. Raises FilmUnavailableError without PyAV.
    """
    if not film_possible():
        raise FilmUnavailableError("films need PyAV – install the extra: pip install '.[bake]'")
    import av

    codec, options, sound_codec = _CODECS[path.suffix]
    first = frames(0)
    partial = path.with_name(f".{path.name}")
    format_name = path.suffix[1:]
    container_options = {"movflags": "+faststart"} if format_name == "mp4" else {}
    with av.open(str(partial), "w", format=format_name, options=container_options) as container:
        video: Any = container.add_stream(codec, rate=rate)  # PyAV's stubs know no stream by a codec's name
        video.height, video.width = first.shape[:2]
        video.pix_fmt = "yuv420p"
        video.options = {name: value for name, value in options.items() if name != "movflags"}
        audio = (
            container.add_stream(sound_codec, rate=SOUND_RATE, layout="mono") if sound is not None else None
        )
        for index in range(count):
            picture = first if index == 0 else frames(index)
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
            for packet in video.encode(frame):
                container.mux(packet)
            tick(index)
        for packet in video.encode():
            container.mux(packet)
        if audio is not None and sound is not None:
            _write_sound(container, audio, _fitted(sound, count / rate))
    partial.replace(path)


def _fitted(sound: NDArray[np.float32], seconds: float) -> NDArray[np.float32]:
    """The first `seconds` of the sound, faded in and out."""
    wanted = int(seconds * SOUND_RATE)
    fitted = np.zeros(wanted, np.float32)
    fitted[: min(wanted, len(sound))] = sound[:wanted]
    ramp = np.minimum(1.0, np.arange(wanted) / (0.5 * SOUND_RATE))
    return (fitted * ramp * ramp[::-1]).astype(np.float32)


def _write_sound(container, stream, sound: NDArray[np.float32]) -> None:
    import av

    form, piece = ("flt", 960) if stream.codec_context.name == "libopus" else ("fltp", 1024)
    frame = av.AudioFrame.from_ndarray(sound.reshape(1, -1), format=form, layout="mono")
    frame.sample_rate = SOUND_RATE
    # The encoder wants frames of its own size; the resampler's buffer cuts them.
    resampler = av.AudioResampler(format=form, layout="mono", rate=SOUND_RATE, frame_size=piece)
    for part in [*resampler.resample(frame), *resampler.resample(None)]:
        container.mux(stream.encode(part))
    container.mux(stream.encode(None))
