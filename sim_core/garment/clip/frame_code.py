"""Positions of one frame as bytes, and back: whole steps over a box, guessed from neighbours, what remains deflated.

A vertex is guessed from the triangle beside it, as the fourth corner of a parallelogram (Touma and Gotsman 1998): cloth
is smooth, so what remains is small. Nothing is guessed from another frame: every frame can be read by itself, and lost
ones are missed by nobody. How vertices follow one another is the same in all frames and is told once.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError

__all__ = ["STEP", "FrameCode", "inflated", "predecessors"]

STEP = 0.25e-3  # [m] the coarsest step
MOST_STEPS = 65535
FEWEST_STEPS = 4096  # of the box: what is small is told as finely as what is large
FINEST = 1e-9  # [m]
LEVEL = 9  # of deflate: packed once, read by many


@dataclass(frozen=True)
class FrameCode:
    """How positions of V vertices become bytes.

    origin (3,) float64 [m]: the low corner of the box; step [m]: of every axis; order (V,) int32: vertices as they
    follow one another; sources (V, 3) int32: of the k-th of them, vertices a, b and c that come before it and guess it
    as a + b - c; of the first ones without any before them, themselves (guessed as 0).
    """

    origin: np.ndarray
    step: float
    order: np.ndarray
    sources: np.ndarray

    @staticmethod
    def of(low: np.ndarray, high: np.ndarray, faces: np.ndarray, count: int, step: float = STEP) -> FrameCode:
        """For `count` vertices that stay within the box from low (3,) to high (3,) [m], faces (F, 3).

        Raises SimCoreError where the box is larger than 65 535 steps, or the step is coarser than STEP.
        """
        if not FINEST <= step <= STEP:
            raise SimCoreError(f"clip: step {step:g} m – give {FINEST:g} to {STEP:g}")
        size = float((np.asarray(high) - low).max())
        fine = min(step, max(size / FEWEST_STEPS, FINEST))
        if size > MOST_STEPS * fine:
            raise SimCoreError(
                f"clip: its meshes span {size:.3g} m, steps of {1000 * fine:g} mm bear {MOST_STEPS * fine:.3g} – "
                "hold the wearer's root in place, or make several clips"
            )
        return FrameCode(np.asarray(low, float), fine, *predecessors(faces, count))

    @property
    def count(self) -> int:
        """Vertices."""
        return len(self.order)

    def steps(self, positions: np.ndarray) -> np.ndarray:
        """Whole steps (…, V, 3) uint16 of positions (…, V, 3) [m]; raises SimCoreError for one beyond the box."""
        steps = np.round((np.asarray(positions, float) - self.origin) / self.step)
        if steps.size and not (steps.min() >= 0 and steps.max() <= MOST_STEPS):
            raise SimCoreError("clip: a vertex lies beyond the clip's box, or is not finite")
        return steps.astype(np.uint16)

    def positions(self, steps: np.ndarray) -> np.ndarray:
        """Positions (…, V, 3) float64 [m] of whole steps."""
        return self.origin + self.step * steps.astype(float)

    def packed(self, steps: np.ndarray, beside: bytes = b"") -> bytes:
        """The bytes of one frame by itself: steps (V, 3) uint16; `beside` follows them as it is."""
        whole = steps.astype(np.int32)
        a, b, c = self.sources.T
        rest = whole[self.order] - np.where((a == self.order)[:, None], 0, whole[a] + whole[b] - whole[c])
        return zlib.compress(_planes(zigzag(rest.astype(np.int16))) + beside, LEVEL)

    def unpacked(self, frames: list[bytes], beside: int = 0) -> tuple[np.ndarray, list[bytes]]:
        """Steps (T, V, 3) uint16 of packed frames, and the `beside` bytes that follow in each.

        Raises SimCoreError for a frame that is damaged.
        """
        length, behind = 6 * self.count, []
        found = np.zeros((self.count, len(frames), 3), np.uint16)  # a row a vertex: all frames at once
        for k, frame in enumerate(frames):
            plain = inflated(frame, length + beside, f"frame {k}")
            found[self.order, k] = _unzigzag(_from_planes(plain[:length], self.count))
            behind.append(plain[length:])
        for vertex, (a, b, c) in zip(self.order.tolist(), self.sources.tolist(), strict=True):
            if a != vertex:
                found[vertex] += found[a] + found[b] - found[c]  # of 65 536 steps the next is the first
        return np.ascontiguousarray(found.transpose(1, 0, 2)), behind


def zigzag(values: np.ndarray) -> np.ndarray:
    """Whole numbers from 0 of signed ones: 0, -1, 1, -2, … as unsigned of the same width."""
    bits = 8 * values.dtype.itemsize
    return ((values << 1) ^ (values >> (bits - 1))).view(f"u{values.dtype.itemsize}")


def _unzigzag(values: np.ndarray) -> np.ndarray:
    """Signed whole numbers of unsigned ones, as the unsigned ones of their bits."""
    return (values >> 1) ^ -(values & 1)


def _planes(values: np.ndarray) -> bytes:
    """(V, 3) uint16 as six planes of bytes: low and high of x, of y, of z."""
    return b"".join(
        ((values[:, k] >> shift) & 255).astype(np.uint8).tobytes() for k in range(3) for shift in (0, 8)
    )


def _from_planes(data: bytes, count: int) -> np.ndarray:
    planes = np.frombuffer(data, np.uint8).reshape(3, 2, count).astype(np.uint16)
    return (planes[:, 0] | (planes[:, 1] << 8)).T


def inflated(data: bytes, length: int, what: str) -> bytes:
    """The `length` bytes that were deflated; raises SimCoreError where it is others, or damaged."""
    reader = zlib.decompressobj()
    try:
        plain = reader.decompress(data, length + 1)
        whole = reader.eof or (not reader.decompress(reader.unconsumed_tail, 1) and reader.eof)
    except zlib.error as error:
        raise SimCoreError(f"clip: {what} is damaged ({error}) – bake it again") from error
    if len(plain) != length or not whole or reader.unused_data:
        raise SimCoreError(f"clip: {what} is cut off or of another length – bake it again")
    return plain


def predecessors(faces: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Order (V,) and sources (V, 3) of `FrameCode`: outwards from a face over the edges, then what has no face."""
    corners = faces.tolist()
    over = {}
    for number, (a, b, c) in enumerate(corners):
        over[a, b] = over[b, c] = over[c, a] = number
    order: list[int] = []
    sources: list[tuple[int, int, int]] = []
    seen, passed = bytearray(count), bytearray(len(corners))

    def place(vertex: int, guess: tuple[int, int, int]) -> None:
        if not seen[vertex]:
            seen[vertex] = 1
            order.append(vertex)
            sources.append(guess)

    def alone(vertex: int, beside: tuple[int, ...]) -> None:
        near = next((v for v in beside if seen[v]), order[-1] if order else vertex)
        place(vertex, (near, near, near))

    for start, face in enumerate(corners):
        if passed[start]:
            continue
        passed[start] = 1
        for vertex in face:
            alone(vertex, tuple(face))
        front = [start]
        for number in front:  # grows as it is gone through
            a, b, c = corners[number]
            for p, q, r in ((a, b, c), (b, c, a), (c, a, b)):
                beyond = over.get((q, p), number)
                if not passed[beyond]:
                    passed[beyond] = 1
                    front.append(beyond)
                    for vertex in corners[beyond]:
                        place(vertex, (p, q, r))
    for vertex in range(count):
        alone(vertex, ())
    return np.array(order, np.int32).reshape(-1), np.array(sources, np.int32).reshape(-1, 3)
