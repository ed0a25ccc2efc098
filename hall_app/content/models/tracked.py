"""What was tracked of a wearer in motion, as a file: points over figure and garment, M and Delta, frame by frame.

    HALLPNTS  uint32 length  {"format": 1, …}  deflated: points, cloth, m, delta, lost

Numbers are little endian. What is deflated are whole numbers, a row a frame, as differences down each column, zigzag,
in four planes of bytes (so clips have them, too): points (T, 3 P) and cloth (T, 3 Q) in steps of 0.25 mm, m (T, L) of
1/1000, delta (T, L) of 0.1 mm, lost (T, P) 0 or 1. hall_app/page/look/points reads the same.
"""

from __future__ import annotations

import json
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["TrackedError", "TrackedMotion"]

FORMAT = 1
MARK = b"HALLPNTS"
STEP = 0.25e-3  # [m]
M_STEP, DELTA_STEP = 1e-3, 1e-4  # [1], [m]
MOST_FRAMES, MOST_POINTS, LARGEST = 100_000, 10_000, 200_000_000  # LARGEST [bytes] once unpacked


class TrackedError(ValueError):
    """A file that holds no tracked points, or damaged ones."""


@dataclass(frozen=True)
class TrackedMotion:
    """A motion as it was followed: rows at a rate [Hz], from the row `begin` on the frames of a clip; those before them
    tell how the model stands that no clip moves.

    points (T, P, 3) [m], the joints ahead of the points between them; torso (P,) bool: X1, the others are X2; bones
    (B, 2): joints that each lies between; worn (Q,): numbers of the points that have one on the garments, and cloth
    (T, Q, 3) [m]: these; limbs (L,): numbers of the bones that m and delta (T, L), [1] and [m], tell of (Eq. 16-17);
    lost (T, P) bool. noise [m] an axis of the sensor; m0 of Eq. 17; rounds of correction a frame at most.
    """

    points: np.ndarray
    torso: np.ndarray
    bones: np.ndarray
    worn: np.ndarray
    cloth: np.ndarray
    limbs: np.ndarray
    m: np.ndarray
    delta: np.ndarray
    lost: np.ndarray
    noise: float
    m0: float
    rounds: int
    rate: float
    loop: bool
    begin: int = 0

    @property
    def frames(self) -> int:
        """How many the clip has."""
        return len(self.points) - self.begin

    def to_bytes(self) -> bytes:
        """The file's bytes; places are rounded to STEP, M and Delta to theirs."""
        low = (
            np.concatenate([self.points.min((0, 1))[None], self.cloth.min((0, 1))[None]])
            if len(self.worn)
            else self.points.min((0, 1))[None]
        )
        origin = np.floor(low.min(0) / STEP) * STEP
        rows = (
            np.round((self.points - origin) / STEP),
            np.round((self.cloth - origin) / STEP),
            np.round(self.m / M_STEP),
            np.round(self.delta / DELTA_STEP),
            self.lost,
        )
        body = b"".join(_planes(array.reshape(len(self.points), -1)) for array in rows)
        header = {
            "format": FORMAT,
            "rate": self.rate,
            "loop": self.loop,
            "rows": len(self.points),
            "begin": self.begin,
            "points": self.points.shape[1],
            "torso": np.flatnonzero(self.torso).tolist(),
            "bones": self.bones.tolist(),
            "worn": self.worn.tolist(),
            "limbs": self.limbs.tolist(),
            "noise": self.noise,
            "m0": self.m0,
            "rounds": self.rounds,
            "origin": [round(float(c), 6) for c in origin],
            "steps": {"place": STEP, "m": M_STEP, "delta": DELTA_STEP},
        }
        text = json.dumps(header, separators=(",", ":")).encode()
        return b"".join((MARK, struct.pack("<I", len(text)), text, zlib.compress(body, 9)))

    def save(self, path: Path) -> None:
        """Writes the file."""
        path.write_bytes(self.to_bytes())

    @staticmethod
    def load(path: Path) -> TrackedMotion:
        """Raises TrackedError saying what is wrong with the file, OSError where it cannot be read."""
        return TrackedMotion.from_bytes(path.read_bytes())

    @staticmethod
    def from_bytes(data: bytes) -> TrackedMotion:
        """Raises TrackedError on what is damaged, cut off or something else."""
        begin = len(MARK) + 4
        if data[: len(MARK)] != MARK or len(data) < begin:
            raise TrackedError("no tracked points")
        (length,) = struct.unpack_from("<I", data, len(MARK))
        try:
            header = json.loads(data[begin : begin + length].decode())
            if not isinstance(header, dict) or header.get("format") != FORMAT:
                raise TrackedError("written in another format")
            return _read(header, data[begin + length :])
        except TrackedError:
            raise
        except (KeyError, IndexError, TypeError, ValueError, OverflowError, RecursionError) as error:
            raise TrackedError(f"damaged ({type(error).__name__}: {error})"[:160]) from error


def _read(header: dict[str, Any], packed: bytes) -> TrackedMotion:
    frames, begin, count = (int(header[name]) for name in ("rows", "begin", "points"))
    if not (0 <= begin < frames <= MOST_FRAMES and 0 < count <= MOST_POINTS):
        raise TrackedError(f"damaged ({frames} rows from {begin} on, of {count} points)")
    bones = _numbers(header["bones"], count).reshape(-1, 2)
    worn, limbs = _numbers(header["worn"], count), _numbers(header["limbs"], len(bones))
    torso = np.zeros(count, bool)
    torso[_numbers(header["torso"], count)] = True
    columns = (3 * count, 3 * len(worn), len(limbs), len(limbs), count)
    whole = 4 * frames * sum(columns)
    if whole > LARGEST:
        raise TrackedError(f"{whole} bytes once unpacked, more than are read")
    body = _inflated(packed, whole)
    rows, at = [], 0
    for width in columns:
        rows.append(_from_planes(body[at : at + 4 * frames * width], frames, width))
        at += 4 * frames * width
    origin, steps = np.array(header["origin"], float), header["steps"]
    rate, noise, m0 = float(header["rate"]), float(header["noise"]), float(header["m0"])
    if origin.shape != (3,) or not np.isfinite([*origin, rate, noise, m0]).all() or rate <= 0:
        raise TrackedError("damaged (origin, rate, noise or m0)")
    points, cloth, m, delta, lost = rows
    place = float(steps["place"])
    return TrackedMotion(
        points=points.reshape(frames, count, 3) * place + origin,
        torso=torso,
        bones=bones,
        worn=worn,
        cloth=cloth.reshape(frames, -1, 3) * place + origin,
        limbs=limbs,
        m=m * float(steps["m"]),
        delta=delta * float(steps["delta"]),
        lost=lost != 0,
        noise=noise,
        m0=m0,
        rounds=int(header["rounds"]),
        rate=rate,
        loop=header["loop"] is True,
        begin=begin,
    )


def _numbers(told: Any, below: int) -> np.ndarray:
    found = np.array(told, np.int64)
    if found.size and not (found.min() >= 0 and found.max() < below):
        raise TrackedError(f"damaged (a number beyond the {below} there are)")
    return found


def _inflated(packed: bytes, size: int) -> bytes:
    reader = zlib.decompressobj()
    try:
        body = reader.decompress(packed, size + 1)
    except zlib.error as error:
        raise TrackedError(f"damaged ({error})") from error
    if len(body) != size or not reader.eof or reader.unused_data:
        raise TrackedError("cut off, or longer than it says")
    return body


def _planes(rows: np.ndarray) -> bytes:
    """Whole numbers (T, N) as differences down each column, zigzag, in four planes of bytes."""
    apart = np.diff(rows.astype(np.int32), axis=0, prepend=np.zeros((1, rows.shape[1]), np.int32))
    folded = ((apart << 1) ^ (apart >> 31)).view(np.uint32)
    return b"".join(((folded >> shift) & 255).astype(np.uint8).tobytes() for shift in (0, 8, 16, 24))


def _from_planes(data: bytes, frames: int, width: int) -> np.ndarray:
    planes = np.frombuffer(data, np.uint8).reshape(4, frames, width).astype(np.int64)
    folded = planes[0] | planes[1] << 8 | planes[2] << 16 | planes[3] << 24
    return np.cumsum((folded >> 1) ^ -(folded & 1), axis=0)
