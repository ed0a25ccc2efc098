"""Patches: about every coarse vertex a cubic displacement in its own tangent frame, blended over coarse faces.

What a network says of a coarse vertex is a patch, the ten coefficients of a cubic in the rest plane for each of the
frame's directions. A fine vertex takes the mean of the patches of its coarse face's corners, by its barycentric weights
(a partition of unity, Babuska and Melenk 1997): a field that is continuous whatever the patches are, on any fine mesh,
and that goes along when the cloth is moved and turned.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.patches.kernels import add_up, carry_over, draw_down, scale, turn_into
from sim_core.learn.topology import checked_sheet, unsigned
from sim_core.learn.upsampling import located
from sim_core.validation import coordinates

__all__ = ["CUBIC", "Patches"]

CUBIC = 10  # coefficients of a cubic in two variables
RIDGE = 1e-2  # of a patch's mean moment: fits of a dozen vertices


@dataclass(frozen=True)
class Patches:
    """Between C coarse and V fine vertices. length [m]: of a coarse edge, about.

    corner: (V, 3) int32, the coarse face in which each fine vertex lies at rest; share: (V, 3) float32, its weights;
    lift: (V, 3, CUBIC) float32, shares times monomials about each corner, in lengths, 0 where held; fit: likewise, of
    least squares.
    """

    count: int
    length: float
    corner: np.ndarray
    share: np.ndarray
    lift: np.ndarray
    fit: np.ndarray

    @staticmethod
    def of(
        rest_coarse: np.ndarray,
        faces_coarse: np.ndarray,
        rest_fine: np.ndarray,
        *,
        held: tuple[int, ...] = (),
    ) -> Patches:
        """From the coarse sheet at rest, (C, 2) [m] and (G, 3), and fine vertices at rest (V, 2) [m].

        held: fine vertices that no patch displaces. Raises SimCoreError for arrays of other shapes.
        """
        rest, faces = checked_sheet(rest_coarse, faces_coarse)
        fine = coordinates("rest_fine", rest_fine)
        if fine.ndim != 2 or fine.shape[1] != 2:
            raise SimCoreError(f"rest_fine: shape {fine.shape} – the flat positions (V, 2) [m] are meant")
        length = float(np.sqrt(np.prod(np.ptp(rest, axis=0)) / len(rest)))
        face, share = located(rest, faces, fine)
        corner = np.ascontiguousarray(faces[face], np.int32)
        monomials = _monomials((fine[:, None] - rest[corner]) / length)
        lift = share[..., None] * monomials
        moments = np.zeros((len(rest), CUBIC, CUBIC))
        np.add.at(moments, corner.ravel(), _outer(lift, monomials).reshape(-1, CUBIC, CUBIC))
        mean = np.trace(moments, axis1=1, axis2=2) / CUBIC
        moments += (RIDGE * np.maximum(mean, 1e-12))[:, None, None] * np.eye(CUBIC)
        fit = np.einsum("vcij,vcj->vci", np.linalg.inv(moments)[corner], lift)
        lift[list(held)] = 0.0
        arrays = (np.ascontiguousarray(array, np.float32) for array in (share, lift, fit))
        return Patches(len(rest), length, corner, *arrays)

    def displaced(self, patches: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Displacements (V, 3) float32 of patches (C, CUBIC, 3) in tangent frames (C, 3, 3), in columns."""
        out = np.zeros((len(self.corner), 3), np.float32)
        draw_down(_single(patches), _single(turn), unsigned(self.corner), self.lift, out)
        return out

    def fitted(self, fine: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """The patches (C, CUBIC, 3) float32 that are nearest to displacements (V, 3), each to those about it."""
        out = np.zeros((self.count, CUBIC, 3), np.float32)
        add_up(_single(fine), _single(turn), unsigned(self.corner), self.fit, out)
        return out

    def carried(self, fine: np.ndarray, before: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Displacements (V, 3) as they were in tangent frames `before` (C, 3, 3), turned along into those of `turn`."""
        out = np.zeros((len(self.corner), 3), np.float32)
        corner = unsigned(self.corner)
        carry_over(_single(fine), _single(before), _single(turn), corner, self.share, out)
        return out

    def scaled(self, fine: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Displacements (V, 3), each times what coarse vertices say (C,), blended."""
        out = np.zeros((len(self.corner), 3), np.float32)
        scale(_single(fine), _single(values), unsigned(self.corner), self.share, out)
        return out

    def turned(self, vectors: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Vectors (C, 3) of coarse vertices as their tangent frames (C, 3, 3) see them."""
        out = np.zeros_like(vectors)
        turn_into(vectors, turn, out)
        return out


def _single(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array, np.float32)


def _outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., :, None] * b[..., None, :]


def _monomials(place: np.ndarray) -> np.ndarray:
    """1, x, y and all products of two and three of them, (…, CUBIC) for places (…, 2)."""
    x, y = place[..., 0], place[..., 1]
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3], axis=-1)
