"""A folder of sequences: places as 16-bit numbers over the scene's box, in blocks of their own, and a manifest.

    DIR/manifest.json       scene, recipes, and of each finished sequence its file, SHA-256, frames and times
    DIR/flag-03.seq         a line of JSON, then blocks: 32-bit length, zstd of byte planes of differences

A file is written beside and moved into place whole, so whatever ends a run, only whole sequences are there. Places are
off by half a step of the box at most: 0.02 mm of a box 2.5 m wide.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import zstandard

from sim_core.errors import SimCoreError
from sim_core.learn.data.film import Film
from sim_core.learn.data.lead import MADE_BY
from sim_core.learn.data.recipe import Recipe

__all__ = ["MANIFEST", "Manifest", "packed", "read_films", "read_sequence"]

MANIFEST, FORMAT = "manifest.json", 1
BLOCK = 50  # frames
LEVELS = 65_535
COMPRESSION = 6


def packed(recipe: Recipe, film: Film) -> bytes:
    """A sequence's file."""
    low = np.minimum(film.coarse.min((0, 1)), film.fine.min((0, 1))).astype(float)
    high = np.maximum(film.coarse.max((0, 1)), film.fine.max((0, 1))).astype(float)
    step = np.maximum((high - low).max(), 1e-6) / LEVELS
    both = np.concatenate([film.coarse, film.fine], axis=1)
    steps = np.round((both - low) / step).astype(np.uint16)
    head = {
        "format": FORMAT,
        "recipe": recipe.told(),
        "origin": low.tolist(),
        "step": float(step),
        "coarse": film.coarse.shape[1],
        "fine": film.fine.shape[1],
        "frames": len(steps),
        "coarse_ms": film.coarse_ms,
        "fine_ms": film.fine_ms,
    }
    coder = zstandard.ZstdCompressor(level=COMPRESSION)
    parts = [json.dumps(head).encode() + b"\n"]
    for begin in range(0, len(steps), BLOCK):
        block = coder.compress(_planes(steps[begin : begin + BLOCK]))
        parts += [len(block).to_bytes(4, "little"), block]
    return b"".join(parts)


def _planes(steps: np.ndarray) -> bytes:
    """Frames (T, N, 3) uint16: each but the first less the one before, low bytes, then high ones."""
    change = np.concatenate([steps[:1], np.diff(steps, axis=0)]).astype(np.uint16)
    return b"".join([(change & 255).astype(np.uint8).tobytes(), (change >> 8).astype(np.uint8).tobytes()])


def _steps(planes: bytes, count: int) -> np.ndarray:
    low, high = np.frombuffer(planes, np.uint8).reshape(2, -1, count, 3).astype(np.uint16)
    return np.cumsum(low | (high << 8), axis=0, dtype=np.uint16)


def read_sequence(path: Path) -> tuple[Recipe, Film]:
    """A sequence's file; raises SimCoreError for one that is none, is cut short or damaged."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise _damaged(path, error) from None
    return _unpacked(path, data)


def _damaged(path: Path, error: Exception) -> SimCoreError:
    return SimCoreError(f"{path}: not a sequence, or damaged ({error}) – make it again")


def _unpacked(path: Path, data: bytes) -> tuple[Recipe, Film]:
    """What the bytes of a file say."""
    try:
        head, _, blocks = data.partition(b"\n")
        told = json.loads(head)
        if told["format"] != FORMAT:
            raise SimCoreError(
                f"{path}: format {told['format']} – this version reads {FORMAT}: make it again"
            )
        count, at, frames = told["coarse"] + told["fine"], 0, []
        while at < len(blocks):
            size = int.from_bytes(blocks[at : at + 4], "little")
            frames.append(
                _steps(zstandard.ZstdDecompressor().decompress(blocks[at + 4 : at + 4 + size]), count)
            )
            at += 4 + size
        steps = np.concatenate(frames)
        if len(steps) != told["frames"]:
            raise SimCoreError(f"{path}: {len(steps)} of {told['frames']} frames – cut short: make it again")
        places = (np.array(told["origin"]) + told["step"] * steps).astype(np.float32)
        coarse, fine = np.split(places, [told["coarse"]], axis=1)
        return Recipe(**told["recipe"]), Film(coarse, fine, told["coarse_ms"], told["fine_ms"])
    except (ValueError, KeyError, TypeError, zstandard.ZstdError) as error:
        raise _damaged(path, error) from None


@dataclass(frozen=True)
class Manifest:
    """What a folder holds: its recipes, and of each finished one by name file, sha256, vertices, frames, coarse_ms,
    fine_ms; made: the engine's version and how the fine sheet is led."""

    recipes: tuple[Recipe, ...]
    done: Mapping[str, Mapping[str, Any]]
    made: Mapping[str, Any] = field(default_factory=lambda: dict(MADE_BY))

    @property
    def digest(self) -> str:
        """SHA-256 of what is finished: by it weights tell what they were trained on."""
        lines = "".join(f"{name} {self.done[name]['sha256']}\n" for name in sorted(self.done))
        return hashlib.sha256(lines.encode()).hexdigest()

    @staticmethod
    def of(folder: Path, recipes: Sequence[Recipe]) -> Manifest:
        """That of a folder for these recipes, with what of them is whole there.

        Raises SimCoreError where the folder is for others.
        """
        found = Manifest.matching(folder, recipes)
        whole = {
            name: kept
            for name, kept in found.done.items()
            if _digest(folder / kept["file"]) == kept["sha256"]
        }
        return replace(found, done=whole)

    @staticmethod
    def matching(folder: Path, recipes: Sequence[Recipe]) -> Manifest:
        """The same as it is noted, without a look at the files."""
        wanted = tuple(recipes)
        try:
            found = Manifest.load(folder)
        except FileNotFoundError:
            return Manifest(wanted, {})
        if found.recipes != wanted:
            raise SimCoreError(
                f"{folder}: holds {found.words} – other settings; give another folder, or the same sequences, "
                "frames and seed"
            )
        found.check_engine(folder, "give another folder")
        return found

    def check_engine(self, folder: Path, remedy: str) -> None:
        """Raises SimCoreError where the data are of another engine than this one."""
        if self.made != MADE_BY:
            raise SimCoreError(
                f"{folder}: was made by another engine ({self.made}, this is {MADE_BY}) – {remedy}"
            )

    @staticmethod
    def load(folder: Path) -> Manifest:
        """Reads a folder's; raises FileNotFoundError where there is none, SimCoreError where it is damaged."""
        path = folder / MANIFEST
        try:
            told = json.loads(path.read_text("utf-8"))
            recipes = tuple(Recipe(**values) for values in told["recipes"])
            return Manifest(recipes, dict(told["done"]), dict(told["made"]))
        except FileNotFoundError:
            raise
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise SimCoreError(f"{path}: damaged ({error}) – delete it and make the data again") from None

    @property
    def words(self) -> str:
        """Its recipes in a few words."""
        first = self.recipes[0]
        return f"{len(self.recipes)} × {first.frames} frames of {first.scene}, seed {first.seed // 1000}"

    @property
    def left(self) -> tuple[Recipe, ...]:
        """What is not there yet."""
        return tuple(recipe for recipe in self.recipes if recipe.name not in self.done)

    def adding(self, folder: Path, recipe: Recipe, data: bytes, told: Mapping[str, Any]) -> Manifest:
        """The manifest with one more sequence, whose file and which itself are written."""
        if (made := told.get("made", self.made)) != self.made:
            raise SimCoreError(
                f"{recipe.name}: a worker has another engine ({made}, this is {self.made}) – install this version there"
            )
        name = f"{recipe.name}.seq"
        _write(folder / name, data)
        kept = {"file": name, "sha256": hashlib.sha256(data).hexdigest(), **told}
        more = replace(self, done={**self.done, recipe.name: kept})
        more.save(folder)
        return more

    def save(self, folder: Path) -> None:
        """Writes it into its folder."""
        told = {"made": self.made, "recipes": [one.told() for one in self.recipes], "done": self.done}
        _write(folder / MANIFEST, json.dumps(told, indent=1).encode())


def read_films(folder: Path) -> dict[str, tuple[Recipe, Film]]:
    """All sequences of a folder by name, in order; raises SimCoreError where one is missing or other than its hash."""
    try:
        manifest = Manifest.load(folder)
    except FileNotFoundError:
        raise SimCoreError(
            f"{folder}: no data – make them with `simcore learn data … --out {folder}`"
        ) from None
    manifest.check_engine(folder, "make the data again in another folder")
    if manifest.left:
        raise SimCoreError(
            f"{folder}: {len(manifest.left)} of {len(manifest.recipes)} sequences are missing – run the same "
            "`simcore learn data` again, it goes on"
        )
    films = {}
    for recipe in manifest.recipes:
        kept = manifest.done[recipe.name]
        path = folder / kept["file"]
        data = path.read_bytes() if path.is_file() else b""
        if hashlib.sha256(data).hexdigest() != kept["sha256"]:
            raise SimCoreError(f"{path}: not what was made – run the same `simcore learn data` again")
        films[recipe.name] = _unpacked(path, data)
    return films


def _digest(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def _write(path: Path, data: bytes) -> None:
    """Whole or not at all."""
    beside = path.with_name(f".{path.name}.part")
    beside.write_bytes(data)
    beside.replace(path)
