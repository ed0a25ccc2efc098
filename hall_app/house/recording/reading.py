"""Film and sound decoded, judged by that, and copied into a container of ours.

To be called beside the server (`beside`): a decoder of foreign files may fail in any way, and may not come to an end.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hall_app.house.recording.encoding import Turn, drawn, sounded
from hall_app.house.recording.formats import DECODERS, PICTURES, PLAIN, READ, SOUNDS, WRITTEN

__all__ = ["LONGEST", "Kept", "Refused", "keep"]

LONGEST: Mapping[str, int] = {"film": 600, "sound": 3600}  # [s]
_PIXELS = 4096 * 2304  # of a film's picture that is decoded
_HEAD, _AFTER = 120, 6  # pictures that are decoded at the film's head, and after each key picture behind it
_FEW = 0.1  # the part of what is decoded that may fail: players hide a scratch
_SHORT = 0.9  # the part of what a file says it lasts that has to be there
_STREAMED = 0xFFFF_0000  # [bytes] and more: what wrote the .wav could not know its length


@dataclass(frozen=True)
class Kept:
    """What was written: its ending, and what is known of it, for the page."""

    ending: str
    told: str


@dataclass(frozen=True)
class Refused:
    """key: of the refusals, and what it tells."""

    key: str
    facts: Mapping[str, object] = field(default_factory=dict)


class _RefusedError(Exception):
    def __init__(self, key: str, **facts: object) -> None:
        super().__init__(key)
        self.refused = Refused(key, facts)


def keep(source: str, target: str, ending: str, kind: str) -> Kept | Refused:
    """Decode `source`, of a container with that ending, and write what is kept of it to `target`.

    kind: "film", or "sound", of which the pictures are left out. Pictures and sound that browsers play are copied as
    they are, others encoded again; of tags, chapters, covers, subtitles and a camera's data streams nothing is kept.
    """
    from av.codec.codec import UnknownCodecError
    from av.logging import PANIC, set_level

    set_level(PANIC)  # what a decoder remarks on a foreign file is no line of the server's
    try:
        if ending == ".wav":
            _measure(source)
        with _opened(source, ending) as container:
            found = _Recording.of(container, ending, kind)
            found.write(container, target, [_turn(one, source, ending) for one in found.tracks])
            return Kept(found.ending, found.told())
    except _RefusedError as error:
        return error.refused
    except UnknownCodecError as error:  # there are builds of PyAV with fewer encoders
        return Refused("file-codec", {"codec": str(error)})
    except Exception as error:  # a decoder of foreign files may fail in any way
        why = getattr(error, "strerror", None) or (str(error).splitlines() or [type(error).__name__])[0]
        return Refused("file-broken", {"why": why[:120]})


@contextlib.contextmanager
def _opened(source: str, ending: str) -> Iterator[Any]:
    """As a file that is open, not as a name: nothing that stands in it leads to another."""
    import av

    options = {"codec_whitelist": ",".join(sorted(DECODERS))}
    with (
        Path(source).open("rb") as file,
        av.open(file, format=READ[ending], options=options, metadata_errors="ignore") as container,
    ):
        yield container


def _measure(source: str) -> None:
    """Raises _RefusedError for a .wav that ends before it says: no decoder minds."""
    with Path(source).open("rb") as file:
        told = int.from_bytes(file.read(8)[4:], "little") + 8
    if Path(source).stat().st_size < told < _STREAMED:
        raise _RefusedError("file-broken", why="it ends before it says")


@dataclass
class _Track:
    """One stream of the source: whether it is copied, and how its decoding goes."""

    stream: Any
    copied: bool
    size: tuple[int, int] = (0, 0)  # [pixels] of its pictures
    read: int = 0  # packets, bad ones among them
    bad: int = 0
    decoded: int = 0  # pictures or pieces of sound
    left: int = _HEAD  # pictures that are still decoded before the next key picture
    end: float = 0.0  # [s] of what was read

    @property
    def pictures(self) -> bool:
        return self.stream.type == "video"

    def frames(self, packet: Any) -> Iterator[Any]:
        """What the packet, or the end of all (None), decodes to; of a copied film some of it, enough to know it."""
        from av.error import FFmpegError

        if self.pictures and self.copied:
            if packet is None:
                return
            if packet.is_keyframe and self.left <= 0:
                self.stream.codec_context.flush_buffers()
                self.left = _AFTER
            if self.left <= 0:
                return
            self.left -= 1
        self.read += packet is not None
        try:
            for frame in self.stream.codec_context.decode(packet):
                frame.time_base = frame.time_base or self.stream.time_base  # the last ones come without
                self.decoded += 1
                yield frame
        except FFmpegError:
            self.bad += packet is not None

    def note(self, packet: Any) -> None:
        """How far the file has been read."""
        begins = packet.dts if packet.pts is None else packet.pts
        if begins is not None:
            after = begins - (self.stream.start_time or 0) + (packet.duration or 0)
            self.end = max(self.end, float(after * packet.time_base))


@dataclass
class _Recording:
    kind: str
    ending: str
    tracks: list[_Track]
    lasts: float  # [s] as the file says; 0: it does not

    @classmethod
    def of(cls, container: Any, ending: str, kind: str) -> _Recording:
        """Raises _RefusedError for what is no recording of that kind, or too much of one."""
        video = next((one for one in container.streams.video if not _still(one)), None)
        sound = next(iter(container.streams.audio), None)
        if sound is None and (video is None or kind == "sound"):
            raise _RefusedError("file-silent")
        if video is None and kind == "film":
            raise _RefusedError("file-use", kind="sound")
        lasts, most = (container.duration or 0) / 1_000_000, LONGEST[kind]
        if lasts > most:
            raise _RefusedError("file-long", kind=kind, most=most // 60)
        tracks = []
        if kind == "film":
            held = _name(video)
            own = ending if ending in PICTURES else ".mp4"
            ending = next((one for one in (own, *PICTURES) if held in PICTURES[one]), own)
            tracks.append(_film_track(video, held, ending))
        else:
            held, own = _name(sound), ".m4a" if ending == ".mp4" else ending
            ending = next((one for one in (own, *SOUNDS) if held in SOUNDS[one] and one != ".mp4"), ".mp3")
        if sound is not None:
            tracks.append(_Track(sound, copied=_name(sound) in SOUNDS[ending]))
        return cls(kind, ending, tracks, lasts)

    def write(self, container: Any, target: str, turns: list[Turn | None]) -> None:
        """turns: of each track whose pictures are encoded again.

        Raises _RefusedError for what turns out to be no recording while it is read.
        """
        import av

        options = {"fflags": "+bitexact"}  # without the name of what wrote it
        if self.ending in (".mp4", ".m4a"):
            options["movflags"] = "+faststart"
        if self.ending == ".mp3":
            options |= {"id3v2_version": "0"}
        with av.open(target, "w", format=WRITTEN[self.ending], options=options) as out:
            writers = {
                one.stream.index: (one, _writer(one, out, self.ending, turn))
                for one, turn in zip(self.tracks, turns, strict=True)
            }
            for packet in container.demux([one.stream for one in self.tracks]):
                if packet.dts is None and packet.size == 0:
                    continue  # the end of a stream: told below, once for all
                track, write = writers[packet.stream.index]
                track.note(packet)
                if track.end > LONGEST[self.kind] + 1:
                    raise _RefusedError("file-long", kind=self.kind, most=LONGEST[self.kind] // 60)
                write(packet)
            for track, write in writers.values():
                write(None)
                self._judge(track)
        if self.lasts and max(one.end for one in self.tracks) < _SHORT * self.lasts - 0.5:
            raise _RefusedError("file-broken", why=f"it says {self.lasts:.0f} s and ends before")

    def _judge(self, track: _Track) -> None:
        if not track.decoded or track.bad > max(1, _FEW * track.read):
            what = "pictures" if track.pictures else "sound"
            raise _RefusedError("file-broken", why=f"{what}: {track.bad} of {track.read} cannot be decoded")

    def told(self) -> str:
        seconds = max(one.end for one in self.tracks)
        size = [f"{one.size[0]} × {one.size[1]}" for one in self.tracks if one.pictures]
        return " · ".join([*size, f"{seconds:.0f} s"])


def _still(stream: Any) -> bool:
    """A cover of an album, which is a picture and no film."""
    return bool(int(stream.disposition) & 0x400)  # AV_DISPOSITION_ATTACHED_PIC


def _name(stream: Any) -> str:
    """Of the codec, the same whoever decodes it. Raises _RefusedError for one that the hall does not read."""
    context = stream.codec_context
    if context is None or context.codec.name not in DECODERS:
        raise _RefusedError("file-codec", codec="?" if context is None else context.codec.canonical_name)
    return context.codec.canonical_name


def _film_track(stream: Any, name: str, ending: str) -> _Track:
    context = stream.codec_context
    if context.width * context.height > _PIXELS:
        raise _RefusedError("file-pixels", most=_PIXELS // 1_000_000)
    context.options = {"max_pixels": str(_PIXELS)}  # its head may say other than its pictures
    played = name in PICTURES[ending] and (name != "h264" or context.pix_fmt in PLAIN)
    return _Track(stream, played, size=(context.width, context.height))


def _writer(track: _Track, out: Any, ending: str, turn: Turn | None) -> Callable[[Any], None]:
    """What takes the track's packets, and None at the end."""
    if track.copied:
        copy = out.add_stream_from_template(track.stream, opaque=True)
        return lambda packet: _copy(track, packet, copy, out)
    if turn is None:
        encode = sounded(track.stream, out, ending)
    else:
        encode, track.size = drawn(track.stream, out, ending, turn), turn.size

    def write(packet: Any) -> None:
        for frame in itertools.chain(track.frames(packet), (None,) if packet is None else ()):
            out.mux(encode(frame))

    return write


def _copy(track: _Track, packet: Any, stream: Any, out: Any) -> None:
    for _ in track.frames(packet):
        pass
    if packet is not None:
        packet.stream = stream
        out.mux(packet)


def _turn(track: _Track, source: str, ending: str) -> Turn | None:
    """By the first picture; None where nothing is to be drawn. Raises _RefusedError where there is none."""
    if track.copied or not track.pictures:
        return None
    with _opened(source, ending) as container:
        stream = container.streams[track.stream.index]
        stream.codec_context.options = dict(track.stream.codec_context.options)
        for frame in container.decode(stream):
            return Turn(frame, stream)
    raise _RefusedError("file-broken", why="it holds no picture")
