"""Bytes that are compressed once and sent to many."""

from __future__ import annotations

__all__ = ["best_frame"]

_MUCH = 1 << 20  # [bytes] beyond that the best level costs a second for one per cent


def best_frame(data: bytes) -> bytes:
    """`data` in one frame of zstd, slowly and small."""
    import zstandard

    return zstandard.ZstdCompressor(level=17 if len(data) > _MUCH else 19).compress(data)
