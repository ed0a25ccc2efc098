"""Films and sounds as cameras, telephones and recorders write them, small."""

from __future__ import annotations

import io
import struct
from typing import Any

import av
import numpy as np

__all__ = ["MADE_BY", "encodes", "held", "recording", "turned_by_hand"]

RATE, SOUND = 25, 48_000
WIDE, HIGH = 96, 64
MADE_BY = {"title": "Ms Li at home", "location": "+48.1375+011.5755/", "comment": "Camera 7, serial 4711"}
PIECES = {"libmp3lame": 1152, "libopus": 960}


def encodes(codec: str) -> bool:
    """Whether this build of PyAV does."""
    try:
        av.Codec(codec, "w")
    except av.codec.codec.UnknownCodecError:
        return False
    return True


def recording(
    form: str,
    pictures: str | None,
    sound: str | None,
    *,
    seconds: int = 4,
    rate: int = RATE,
    colours: str = "yuv420p",
) -> bytes:
    """form: of the container; pictures and sound: encoders. The left half is red, and it says who made it and where."""
    file = io.BytesIO()
    with av.open(file, "w", format=form) as container:
        container.metadata.update(MADE_BY)
        streams: list[Any] = []
        if pictures:
            drawn: Any = container.add_stream(pictures, rate=rate)
            drawn.width, drawn.height, drawn.pix_fmt = WIDE, HIGH, colours
            drawn.codec_context.gop_size = RATE
            streams.append(drawn)
        if sound:
            heard: Any = container.add_stream(sound, rate=SOUND, layout="stereo")
            streams.append(heard)
        if form != "wav":
            container.set_chapters([{"id": 1, "start": 0, "end": 9, "time_base": 1, "metadata": MADE_BY}])
        if pictures:
            for number in range(rate * seconds):
                picture = np.zeros((HIGH, WIDE, 3), np.uint8)
                picture[:, : WIDE // 2] = 255 - number % 9, 0, 0
                container.mux(drawn.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
            container.mux(drawn.encode(None))
        if sound:
            wave = np.sin(np.arange(SOUND * seconds) * 0.05).astype(np.float32)
            frame = av.AudioFrame.from_ndarray(np.stack([wave, wave]), format="fltp", layout="stereo")
            frame.sample_rate = SOUND
            pieces = av.AudioResampler(
                heard.codec_context.format.name, "stereo", SOUND, PIECES.get(sound, 1024)
            )
            for piece in [*pieces.resample(frame), *pieces.resample(None)]:
                container.mux(heard.encode(piece))
            container.mux(heard.encode(None))
    return file.getvalue()


def turned_by_hand(film: bytes) -> bytes:
    """An .mp4 of a telephone that was held upright: to be shown a quarter turned, so that red is above."""
    data, at = bytearray(film), film.index(b"tkhd") + 44
    data[at : at + 36] = struct.pack(">9i", 0, 1 << 16, 0, -1 << 16, 0, 0, HIGH << 16, 0, 1 << 30)
    return bytes(data)


def held(data: bytes) -> dict[str, str]:
    """What is in a recording: its codecs by kind; "red": where the first picture is, as it is to be seen."""
    with av.open(io.BytesIO(data)) as container:
        found = {stream.type: stream.codec_context.codec.canonical_name for stream in container.streams}
        assert len(found) == len(container.streams), "one of a kind"
        assert not container.chapters()
        for picture in container.decode(video=0) if "video" in found else ():
            turn = (-picture.rotation // 90) % 4  # clockwise
            shown = np.rot90(picture.to_ndarray(format="rgb24"), -turn)
            red = shown[..., 0] > 128
            above = red[: len(red) // 2].mean() > 0.9
            found["red"] = "above" if above else "left" if red[:, : red.shape[1] // 2].mean() > 0.9 else "?"
            break
    return found
