"""viser's browser client, taken out of its one-file page: script, style and the decoder they share.

viser packs style and script with zstd, spells the bytes in 88 printable characters and puts them, with a decoder and a
loader, into one page: nothing of it can be cached, compressed on the way or loaded after the first paint. Here they
become files of their own.
"""

from __future__ import annotations

import gzip
import re
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from hall_app.web.answers.packed import Packed

__all__ = ["VISER_VERSION", "ViserClient", "viser_client"]

# The page reads viser's internals (window.__viserMutable and friends), which are no public API.
VISER_VERSION = "1.1.1"

_ALPHABET = b"!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"
_PAYLOAD = re.compile(r'<script data-p="([^"]*)" data-ss="(\d+)" data-cs="(\d+)">')
_DECODER = re.compile(r'const gzWasm="((?:[^"\\]|\\.)*)"')
# The sorter for Gaussian splats, four times. The hall has none, and its policy forbids what the sorter needs.
_SORTER = re.compile(rb"(data:application/wasm;base64,)[A-Za-z0-9+/=]{1000,}")

# What the page counts on (page/viser): the worker that holds the socket, and where it finds the decoder.
_COUNTED_ON = (
    b"WebSocket worker: got",
    b"new WebSocket(e,[o])",
    b"globalThis.__viserZstdWasm",
    b"URL.revokeObjectURL(import.meta.url);",
)


@dataclass(frozen=True)
class ViserClient:
    """script: an ES module; style; decoder: WebAssembly of zstd, published as `__viserZstdWasm` before the script."""

    script: Packed
    style: Packed
    decoder: Packed


@lru_cache(maxsize=1)
def viser_client() -> ViserClient:
    """Read the installed viser's client.

    Raises RuntimeError when another version of viser is installed, or its page is not built as expected.
    """
    import viser
    import zstandard

    installed = version("viser")
    if installed != VISER_VERSION:
        raise RuntimeError(f"viser {installed} is installed, the page is made for viser=={VISER_VERSION}")
    page = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text("utf-8")
    payload, decoder = _PAYLOAD.search(page), _DECODER.search(page)
    if payload is None or decoder is None:
        raise _strange("its packed script or decoder is missing")
    data = zstandard.ZstdDecompressor().decompress(_spelled(payload[1]))
    length = int(payload[2])
    if len(data) != length + int(payload[3]):
        raise _strange("its packed script has another length than it says")
    style, script = data[:length], data[length:]
    for mark in _COUNTED_ON:
        if mark not in script:
            raise _strange(f"its script lacks {mark.decode()!r}")
    module = gzip.decompress(_spelled(decoder[1].replace("\\\\", "\\")))
    return ViserClient(
        script=Packed(_SORTER.sub(rb"\1", script), "text/javascript; charset=utf-8"),
        style=Packed(style, "text/css; charset=utf-8"),
        decoder=Packed(module, "application/wasm"),
    )


def _strange(what: str) -> RuntimeError:
    return RuntimeError(
        f"viser's page is not the one of {VISER_VERSION}: {what} – pip install viser=={VISER_VERSION}"
    )


def _spelled(text: str) -> bytes:
    """Bytes from viser's spelling: five digits to the base 88 are four bytes, big endian; a rest of n is n − 1."""
    values = np.zeros(128, np.int64)
    values[np.frombuffer(_ALPHABET, np.uint8)] = np.arange(len(_ALPHABET))
    digits = values[np.frombuffer(text.encode("ascii"), np.uint8)]
    whole = len(digits) // 5 * 5
    numbers = digits[:whole].reshape(-1, 5) @ (len(_ALPHABET) ** np.arange(4, -1, -1))
    rest = 0
    for digit in digits[whole:].tolist():
        rest = rest * len(_ALPHABET) + digit
    left = max(len(digits) - whole - 1, 0)
    return numbers.astype(">u4").tobytes() + (rest.to_bytes(8, "big")[-left:] if left else b"")
