"""The scene's large bytes, models and pictures, by address: packed once, kept by browsers.

viser makes every visitor's messages anew, models and all, and sends them over its socket: nothing is shared, kept for
a reload or told of while it is under way. So viser is given a stand-in for what is large; the relay leaves names in its
place, the page fetches the bytes by these and puts them in (page/viser/line.js). A piece travels as a frame of zstd. A
message's body is zstd as well, and frames may follow each other: what the page hands to viser is put together from
frames, not decoded and coded anew.
"""

from __future__ import annotations

import contextlib
import json
import logging
import re
import struct
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256

from hall_app.show.compression import best_frame
from sim_core.gltf import glb_parts

__all__ = ["LEAN", "Pieces", "split"]

LARGE = 32 << 10  # [bytes] from here on it is worth a name
# [bytes] from here on a model's picture is a piece of its own: garments of one cloth share it
PICTURE = 8 << 10
# [bytes] of pieces, their frames come on top; beyond, what no exhibit shows is forgotten, the longest unasked first
KEPT = 256 << 20
LEAN = b"HALLLEAN"  # viser's own messages begin with a length, whose upper bytes are 0

_NAMED = 20  # characters of a name
_MARK = b"\x00hall model "  # begins a stand-in; the model's name follows
_STAND_IN = re.compile(
    b"\xc4%b(%b[0-9a-f]{%d})" % (re.escape(bytes([len(_MARK) + _NAMED])), re.escape(_MARK), _NAMED)
)  # as msgpack writes it
_NO_ARRAYS = b"binaryBufferLengths\x90"  # how a body of viser ends when nothing follows it
_log = logging.getLogger(__name__)


class _Once:
    """Something that is made when it is first asked for, by one thread, and kept."""

    def __init__(self, make: Callable[[], bytes]) -> None:
        self._make, self._making = make, threading.Lock()
        self.made: bytes | None = None

    def __call__(self) -> bytes:
        with self._making:
            if self.made is None:
                self.made = self._make()
            return self.made


class _Piece:
    """Large bytes; `frame` in zstd. Forgotten together."""

    def __init__(self, raw: bytes) -> None:
        self.raw = raw
        self.frame = _Once(lambda: best_frame(raw))


@dataclass(frozen=True)
class _Model:
    """What a stand-in stands for: `size` [bytes], and the names of its pieces in order."""

    size: int
    names: tuple[str, ...]


def _name(data: bytes) -> str:
    return sha256(data).hexdigest()[:_NAMED]


class Pieces:
    """Large bytes by name. May be called from threads; `lean` from one."""

    def __init__(self) -> None:
        import zstandard

        self._changing = threading.RLock()
        self._pieces: OrderedDict[str, _Piece] = OrderedDict()
        self._weight = 0  # [bytes] of all pieces
        self._models: dict[bytes, _Model] = {}  # by their stand-ins
        self._shown: dict[str, bytes] = {}  # node -> the stand-in of its model
        self._later: set[str] = set()  # of these nodes, those that are not in the first view
        self._packs: OrderedDict[str, _Once] = OrderedDict()
        self._told = False
        self._decompress = zstandard.ZstdDecompressor().decompress
        # What lies before a model is the same for every visitor.
        self._compress = lru_cache(256)(zstandard.ZstdCompressor(level=3).compress)

    # What viser is given.

    def stand_in(self, model: bytes) -> bytes:
        """What viser is given for `model`, which is kept as long as there is room; what is small stands for itself."""
        if len(model) < LARGE:
            return model
        mark = _MARK + _name(model).encode()
        with self._changing:
            known = self._models.get(mark)
            names = known.names if known else tuple(self._keep(part) for part in split(model))
            self._models[mark] = _Model(len(model), names)
            self._touch(names)
            self._forget_beside(names)
        return mark

    def show(self, node: str, model: bytes, *, first: bool = True) -> bytes:
        """The same for a model that every visitor sees: kept until `node` shows another. first: in the first view, so
        that it comes with the pack, else after it."""
        with self._changing:
            self._shown[node] = self.stand_in(model)
            (self._later.discard if first else self._later.add)(node)
            return self._shown[node]

    def mark(self, node: str) -> bytes:
        """The stand-in of what `node` shows."""
        return self._shown[node]

    def hide(self, node: str) -> None:
        """`node` is shown no longer."""
        with self._changing:
            self._shown.pop(node, None)
            self._later.discard(node)

    def _keep(self, data: bytes) -> str:
        name = _name(data)
        if name not in self._pieces:
            self._pieces[name] = _Piece(data)
            self._weight += len(data)
        return name

    def _touch(self, names: tuple[str, ...]) -> None:
        for name in names:
            self._pieces.move_to_end(name)

    def _forget_beside(self, names: tuple[str, ...]) -> None:
        if self._weight <= KEPT:
            return
        needed = {*names, *self._of(self._shown)}
        for name in [name for name in self._pieces if name not in needed]:
            if self._weight <= KEPT:
                return
            self._weight -= len(self._pieces.pop(name).raw)
            self._models = {mark: model for mark, model in self._models.items() if name not in model.names}

    def _of(self, nodes: Iterable[str]) -> tuple[str, ...]:
        """Names of the pieces of what nodes show, each once."""
        marks = (self._shown[node] for node in nodes)
        shown = (self._models[mark] for mark in marks if mark in self._models)
        return tuple(dict.fromkeys(name for model in shown for name in model.names))

    # What the page asks for.

    def frame(self, name: str) -> bytes:
        """The piece as a frame of zstd; slow the first time. Raises KeyError for an unknown name."""
        return self._pieces[name].frame()

    def made(self, kind: str, name: str) -> bytes | None:
        """A frame ("pieces") or a pack ("packs") if it takes no time, else None: call `frame` or `pack` in a thread.

        Raises KeyError for an unknown name.
        """
        return {"pieces": lambda: self._pieces[name].frame, "packs": lambda: self._packs[name]}[kind]().made

    def plan_pack(self) -> tuple[str, int]:
        """Name of the pack of all that the first view needs, and its bytes: guessed until it is made."""
        with self._changing:
            names = self._of(node for node in self._shown if node not in self._later)
            pack = _name("".join(names).encode())
            once = self._packs.setdefault(pack, _Once(lambda: self._joined(names)))
            self._packs.move_to_end(pack)
            while len(self._packs) > 4:  # a page that was opened before an edit may still ask for its own
                self._packs.popitem(last=False)
            return pack, len(once.made) if once.made else sum(len(self._pieces[n].raw) for n in names) // 2

    def pack(self, name: str) -> bytes:
        """Length of the index (uint32), index [[name, bytes], …] as JSON, frames; slow the first time.

        Raises KeyError for an unknown name.
        """
        return self._packs[name]()

    def make_later(self) -> None:
        """The frames of what comes after the first view; slow the first time."""
        with self._changing:
            names = self._of(self._later)
        for name in names:
            with contextlib.suppress(KeyError):  # another is shown by now
                self.frame(name)

    def _joined(self, names: tuple[str, ...]) -> bytes:
        frames = {piece: self.frame(piece) for piece in names}
        index = json.dumps([[piece, len(frame)] for piece, frame in frames.items()]).encode()
        return struct.pack("<I", len(index)) + index + b"".join(frames.values())

    # What the relay sends.

    def lean(self, message: bytes) -> bytes:
        """A message of viser with names in the place of stand-ins, or as it is.

        viser's message: uint64 size of the body, uint64 size of its frame, the frame, raw arrays. Ours: LEAN, uint32
        length of a header, the header as JSON {"size": of the body, "parts": [name | length of a frame, …]}, frames.

        Raises KeyError where a model is no longer kept.
        """
        try:
            size, packed = struct.unpack_from("<QQ", message)
            body = self._decompress(message[16 : 16 + packed])
        except Exception:  # no message of viser as we know it: no stand-in of ours either
            if not self._told:
                _log.warning("a message of viser travels as it is: it is built in another way", exc_info=True)
            self._told = True
            return message
        parts: list[str | int] = []
        frames: list[bytes] = []
        at = 0
        for found in _STAND_IN.finditer(body):
            model = self._models[found[1]]
            before = body[at : found.start()] + _bytes_of(model.size)
            frames.append(self._compress(before))
            parts += [len(frames[-1]), *model.names]
            size += model.size + len(_bytes_of(model.size)) - len(found[0])
            at = found.end()
        if not frames:
            return message
        if not body.endswith(_NO_ARRAYS):
            raise ValueError("arrays follow a model in one message: their places depend on its length")
        frames.append(self._compress.__wrapped__(body[at:]))
        header = json.dumps({"size": size, "parts": [*parts, len(frames[-1])]}).encode()
        return b"".join((LEAN, struct.pack("<I", len(header)), header, *frames))


def _bytes_of(size: int) -> bytes:
    """How msgpack begins so many bytes."""
    return b"\xc5" + size.to_bytes(2, "big") if size < 1 << 16 else b"\xc6" + size.to_bytes(4, "big")


def split(body: bytes) -> Iterator[bytes]:
    """A GLB's large pictures and what lies between them; any other body whole."""
    at = 0
    for begin, end in _pictures(body):
        if begin > at:
            yield body[at:begin]
        yield body[begin:end]
        at = end
    if at < len(body):
        yield body[at:]


def _pictures(body: bytes) -> list[tuple[int, int]]:
    """Where the large pictures of a GLB lie, in order; nothing in what is no GLB."""
    try:
        places = sorted(set(glb_parts(body).picture_places()))
    except (ValueError, KeyError, IndexError, TypeError, AttributeError):
        return []  # whatever it is, it travels whole
    found, at = [], 0
    for begin, end in places:
        if end - begin >= PICTURE and begin >= at and end <= len(body):
            found.append((begin, end))
            at = end
    return found
