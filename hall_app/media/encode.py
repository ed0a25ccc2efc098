"""Sound to files every browser plays, with PyAV: no ffmpeg on the system is needed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from hall_app.media.strings import RATE

CODECS = {".webm": ("libopus", 40_000), ".mp3": ("libmp3lame", 56_000)}
PIECES = {
    "libopus": ("flt", 960),
    "libmp3lame": ("fltp", 1152),
    "aac": ("fltp", 1024),
}  # form and length of a frame


def write_sound(path: Path, sound: np.ndarray) -> None:
    """Write `sound` (N, 2) float in -1..1 at RATE as .webm (Opus) or .mp3. Raises KeyError for other endings."""
    import av

    codec, bit_rate = CODECS[path.suffix]
    with av.open(str(path), "w", options={"fflags": "+bitexact"}) as container:
        stream = container.add_stream(codec, rate=RATE, layout="stereo")
        assert isinstance(stream, av.AudioStream)  # both codecs are sound
        stream.bit_rate = bit_rate
        mux_sound(container, stream, codec, sound)


def mux_sound(container: Any, stream: Any, codec: str, sound: np.ndarray) -> None:
    """Encode `sound` (N, 1 or 2) float in -1..1 at RATE into a stream of the codec."""
    import av

    form, piece = PIECES[codec]
    layout = "mono" if sound.shape[1] == 1 else "stereo"
    samples = np.ascontiguousarray(sound, dtype=np.float32)
    packed = samples.reshape(1, -1) if form == "flt" else samples.T.copy()
    frame = av.AudioFrame.from_ndarray(packed, format=form, layout=layout)
    frame.sample_rate = RATE
    # The encoder wants frames of its own size; the resampler's buffer cuts them.
    resampler = av.AudioResampler(format=form, layout=layout, rate=RATE, frame_size=piece)
    for part in [*resampler.resample(frame), *resampler.resample(None)]:
        container.mux(stream.encode(part))
    container.mux(stream.encode(None))
