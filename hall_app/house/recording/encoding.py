"""Pictures and sound encoded again, as browsers play them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

__all__ = ["Turn", "drawn", "sounded"]

# How it is encoded where it has to be, by ending: encoder and its options.
_ENCODED: Mapping[str, tuple[str, dict[str, str]]] = {
    ".mp4": ("libx264", {"crf": "25", "preset": "veryfast"}),
    ".webm": ("libvpx-vp9", {"crf": "36", "b": "0", "cpu-used": "6", "row-mt": "1", "deadline": "good"}),
}
_ENCODED_SOUND: Mapping[str, tuple[str, int, int]] = {  # encoder, [bit/s], samples of a piece
    ".mp4": ("aac", 128_000, 1024),
    ".webm": ("libopus", 96_000, 960),
    ".mp3": ("libmp3lame", 128_000, 1152),
}
_HERTZ = 48_000  # that all of these encoders take
_EDGE = 1280  # [pixels] of a picture's longer side
_RATE = 60  # [1/s] pictures, at most


def drawn(source: Any, out: Any, ending: str, turn: Turn) -> Callable[[Any], Any]:
    """What encodes a picture of the stream `source` into the container `out`, and None at the end."""
    encoder, options = _ENCODED[ending]
    pace = min(Fraction(source.average_rate or source.guessed_rate or 25), Fraction(_RATE))
    stream = out.add_stream(encoder, rate=pace, options=options)
    stream.width, stream.height = turn.size
    stream.pix_fmt = "yuv420p"
    stream.codec_context.thread_count = 2  # the hall is open meanwhile
    last = -1

    def encode(frame: Any) -> Any:
        nonlocal last
        if frame is None:
            return stream.encode(None)
        number = last + 1 if frame.pts is None else round(frame.pts * frame.time_base * pace)
        if number <= last:
            return []  # more pictures than are kept
        last = number
        upright = turn(frame)
        upright.pts, upright.time_base = number, 1 / pace
        return stream.encode(upright)

    return encode


class Turn:
    """A picture as it is to be seen: a telephone writes how it was held beside its pictures."""

    def __init__(self, frame: Any, source: Any) -> None:
        from av.filter import Graph

        turn = {90: "transpose=cclock", -90: "transpose=clock", 180: "hflip,vflip", -180: "hflip,vflip"}
        wide, high = frame.width, frame.height
        if abs(frame.rotation) == 90:
            wide, high = high, wide
        scale = min(1.0, _EDGE / max(wide, high))
        self.size = _even(scale * wide), _even(scale * high)
        self.graph = graph = Graph()
        nodes = [graph.add_buffer(template=source, time_base=source.time_base)]
        steps = [one for one in turn.get(frame.rotation, "").split(",") if one]
        for step in (*steps, f"scale={self.size[0]}:{self.size[1]}", "format=yuv420p", "buffersink"):
            name, _, given = step.partition("=")
            nodes.append(graph.add(name, given) if given else graph.add(name))
            nodes[-2].link_to(nodes[-1])
        graph.configure()

    def __call__(self, frame: Any) -> Any:
        self.graph.push(frame)
        return self.graph.pull()


def sounded(source: Any, out: Any, ending: str) -> Callable[[Any], Any]:
    """What encodes a piece of sound of `source` into `out`, in two channels at most, and None at the end."""
    import av

    encoder, bits, size = _ENCODED_SOUND[ending]
    layout = "mono" if source.codec_context.layout.nb_channels == 1 else "stereo"
    stream = out.add_stream(encoder, rate=_HERTZ, layout=layout)
    stream.bit_rate = bits
    form = stream.codec_context.format.name
    resampler = av.AudioResampler(format=form, layout=layout, rate=_HERTZ, frame_size=size)

    def encode(frame: Any) -> Any:
        pieces = [packet for piece in resampler.resample(frame) for packet in stream.encode(piece)]
        return [*pieces, *(stream.encode(None) if frame is None else ())]

    return encode


def _even(side: float) -> int:
    """As colours at half the size need it."""
    return max(2, 2 * round(side / 2))
