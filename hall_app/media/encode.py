"""Sound to files every browser plays, with PyAV (extra `bake`): no ffmpeg on the system is needed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hall_app.media.strings import RATE

CODECS = {".webm": ("libopus", 56_000, "flt"), ".mp3": ("libmp3lame", 80_000, "fltp")}


def write_sound(path: Path, sound: np.ndarray) -> None:
    """Write `sound` (N, 2) float in -1..1 at RATE as .webm (Opus) or .mp3. Raises KeyError for other endings."""
    import av

    codec, bit_rate, form = CODECS[path.suffix]
    samples = np.ascontiguousarray(sound, dtype=np.float32)
    with av.open(str(path), "w", options={"fflags": "+bitexact"}) as container:
        stream = container.add_stream(codec, rate=RATE, layout="stereo")
        assert isinstance(stream, av.AudioStream)  # both codecs are sound
        stream.bit_rate = bit_rate
        packed = samples.reshape(1, -1) if form == "flt" else samples.T.copy()
        frame = av.AudioFrame.from_ndarray(packed, format=form, layout="stereo")
        frame.sample_rate = RATE
        # The encoder wants frames of its own size; the resampler's buffer cuts them.
        resampler = av.AudioResampler(
            format=form, layout="stereo", rate=RATE, frame_size=1152 if path.suffix == ".mp3" else 960
        )
        for piece in [*resampler.resample(frame), *resampler.resample(None)]:
            container.mux(stream.encode(piece))
        container.mux(stream.encode(None))
