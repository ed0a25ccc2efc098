"""Draft algebra: threading x tie-up x treadling <-> lift plan <-> drawdown, exact and with the fewest shafts."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from sim_core.errors import WeaveError

__all__ = ["Harness", "drawdown", "harness", "kinds_of", "lift_plan", "smallest_period", "tie_up"]


@dataclass(frozen=True, eq=False)
class Harness:
    """How a loom lifts: rising shed, any end on any number of shafts, any number of treadles a pick.

    threading: (ends, shafts) bool.  tieup: (shafts, treadles) bool.  treadling: (picks, treadles) bool.
    Raises WeaveError where the shapes do not fit.
    """

    threading: np.ndarray
    tieup: np.ndarray
    treadling: np.ndarray

    def __post_init__(self) -> None:
        for name in ("threading", "tieup", "treadling"):
            values = np.array(getattr(self, name))
            if values.ndim != 2 or (values.dtype != bool and not np.isin(values, (0, 1)).all()):
                raise WeaveError(f"harness: {name} has shape {values.shape} – give a matrix of 0 and 1")
            object.__setattr__(self, name, values.astype(bool, copy=False))
        if self.threading.shape[1] != self.tieup.shape[0] or self.treadling.shape[1] != self.tieup.shape[1]:
            raise WeaveError(
                f"harness: threading over {self.threading.shape[1]} shafts, tie-up {self.tieup.shape}, treadling over "
                f"{self.treadling.shape[1]} treadles – shafts and treadles must agree"
            )

    @property
    def lift(self) -> np.ndarray:
        """Drawdown: (picks, ends) bool."""
        return drawdown(self.threading, lift_plan(self.tieup, self.treadling))


def lift_plan(tieup: np.ndarray, treadling: np.ndarray) -> np.ndarray:
    """Shafts raised at each pick: (picks, shafts) bool from (shafts, treadles) and (picks, treadles)."""
    if tieup.shape[0] == tieup.shape[1] and np.array_equal(tieup, np.eye(len(tieup), dtype=bool)):
        return np.asarray(treadling, bool)  # one treadle a shaft: it is a lift plan
    return _product(np.asarray(treadling, bool), np.asarray(tieup, bool).T)


def drawdown(threading: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """Lift (picks, ends) bool from threading (ends, shafts) and lift plan (picks, shafts)."""
    return _product(np.asarray(threading, bool), np.asarray(plan, bool).T).T


def tie_up(plan: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The inverse of `lift_plan`: tie-up (shafts, treadles) and treadling, one treadle for each row that differs."""
    rows, which = kinds_of(np.asarray(plan, bool))
    return rows.T, np.eye(len(rows), dtype=bool)[which]


def harness(lift: np.ndarray) -> Harness:
    """The harness of a lift matrix with one end a shaft at most and the fewest shafts: one for each end that differs.

    Shafts and treadles are numbered as they first appear, so that the same lift yields the same harness.
    """
    columns, shaft = kinds_of(np.asarray(lift, bool).T)
    tieup, treadling = tie_up(columns.T)
    return Harness(np.eye(len(columns), dtype=bool)[shaft], tieup, treadling)


def smallest_period(values: Sequence) -> int:
    """After how many values the sequence repeats; the last repeat may be cut off."""
    border = [0] * len(values)  # Knuth, Morris and Pratt: longest proper prefix that ends here
    for k in range(1, len(values)):
        length = border[k - 1]
        while length and values[k] != values[length]:
            length = border[length - 1]
        border[k] = length + (values[k] == values[length])
    return len(values) - border[-1] if values else 0


def kinds_of(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows (n, m) bool that differ, in order of appearance, and for each of the n rows which of them it is."""
    seen: dict[bytes, int] = {}
    packed = np.packbits(rows, axis=1)
    kind = np.array([seen.setdefault(row.tobytes(), len(seen)) for row in packed], dtype=np.int64)
    _, first = np.unique(kind, return_index=True)
    return rows[first], kind


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    # Rows of a harness hold few ones; a float holds every count that 4,096 shafts can give.
    return (csr_matrix(a, dtype=np.float32) @ b.astype(np.float32)) > 0
