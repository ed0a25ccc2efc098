"""The two sheets of a sequence, simulated or pooled, and the matrices between their vertices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.sparse import csr_array

from sim_core.cloth import Sheet
from sim_core.learn.data.lead import Lead
from sim_core.learn.data.recipe import Recipe
from sim_core.learn.pooling import Pooled
from sim_core.learn.upsampling import biharmonic, linear

__all__ = ["Pair"]

CUT = 1e-3  # weights of the base that are less of a row's greatest are left out


@dataclass(frozen=True)
class Pair:
    """A coarse sheet of C vertices and a fine one of V.

    spread (V, C): the coarse surface, linear in between; mean (C, V): the mean, by mass, of fine vertices about each
    coarse one; base (V, C): the smoothest fine sheet whose means are the coarse surface's, which is what the fine one
    is led to be. pins: the pinned vertices of both. kept: where the coarse sheet was pooled from the fine one, the fine
    vertices that it is; base goes through them, and nothing is led.
    """

    coarse: Sheet
    fine: Sheet
    spread: csr_array
    mean: csr_array
    base: csr_array
    pins: tuple[tuple[int, ...], tuple[int, ...]]
    kept: tuple[int, ...] = ()

    @property
    def kind(self) -> str:
        """What sheets have in common that differ in size alone: vertices of both, and the ratio of their sides."""
        width, height = np.ptp(self.fine.rest, axis=0)
        return f"{len(self.coarse.rest)}-{len(self.fine.rest)}-{round(float(width / height), 6)}"

    @staticmethod
    def of(recipe: Recipe) -> Pair:
        """Those of a sequence; sequences on the same sheets share the matrices."""
        coarse, fine = recipe.on(recipe.coarse), recipe.on(recipe.fine)
        flat, mass = (_Flat.of(coarse.sheet), _Flat.of(fine.sheet)), np.asarray(fine.sheet.mass, float)
        matrices = _matrices(*flat, mass.tobytes())
        return Pair(coarse.sheet, fine.sheet, *matrices, (tuple(coarse.pins), tuple(fine.pins)))

    @staticmethod
    def pooled(recipe: Recipe, pooled: Pooled) -> Pair:
        """The fine sheet of a sequence and what pooling keeps of it, which sequences of one size may share."""
        scene = recipe.on(recipe.fine)
        fine, kept = scene.sheet, np.asarray(pooled.kept)
        coarse = Sheet.of(fine.rest[kept], pooled.faces, fine.material)
        flat, mass = (_Flat.of(coarse), _Flat.of(fine)), np.asarray(fine.mass, float)
        matrices = _matrices(*flat, mass.tobytes(), kept.astype(np.int64).tobytes())
        pins = tuple(np.flatnonzero(np.isin(kept, list(scene.pins))).tolist())
        return Pair(coarse, fine, *matrices, (pins, tuple(scene.pins)), tuple(kept.tolist()))


@dataclass(frozen=True)
class _Flat:
    """A flat mesh that can be a key."""

    rest: bytes
    faces: bytes

    @staticmethod
    def of(sheet: Sheet) -> _Flat:
        return _Flat(np.asarray(sheet.rest, float).tobytes(), np.asarray(sheet.faces, np.int32).tobytes())

    @property
    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        return np.frombuffer(self.rest).reshape(-1, 2), np.frombuffer(self.faces, np.int32).reshape(-1, 3)


@lru_cache(maxsize=8)
def _matrices(
    coarse: _Flat, fine: _Flat, mass: bytes, kept: bytes = b""
) -> tuple[csr_array, csr_array, csr_array]:
    (flat, faces), (rest, fine_faces) = coarse.arrays, fine.arrays
    spread = linear(flat, faces, rest)
    mean = csr_array(Lead.of(spread, np.frombuffer(mass)).mean)
    if kept:
        return spread, mean, biharmonic(rest, fine_faces, np.frombuffer(kept, np.int64), cut=CUT).matrix
    smooth = biharmonic(rest, fine_faces, mean, cut=CUT).matrix
    return spread, mean, csr_array(smooth @ csr_array(mean @ spread))
