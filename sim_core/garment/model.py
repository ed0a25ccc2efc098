"""The `Garment` value: flat rest mesh, drape, weave, material and where all of it came from."""

from __future__ import annotations

import hashlib
import json
import zipfile
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import FileProblem, SimCoreError

FORMAT = 1
_ARRAYS = {
    "outline": (float, 2),
    "rest": (float, 2),
    "faces": (np.int32, 3),
    "positions": (float, 3),
    "seams": (np.int32, 2),
}


@dataclass(frozen=True)
class Garment:
    """A draped garment.

    outline (N, 2) and rest (V, 2) [m] in pattern axes (x weft, y down the warp); faces (F, 3) int32;
    positions (V, 3) [m], y up; seams (K, 2) int32 vertex pairs sewn together; weave and material as plain
    dictionaries; provenance: inputs, seed, versions, seconds per stage, measured errors.
    """

    name: str
    outline: np.ndarray
    rest: np.ndarray
    faces: np.ndarray
    positions: np.ndarray
    seams: np.ndarray
    weave: dict[str, Any] = field(default_factory=dict)
    material: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    dye: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        for name, (kind, width) in _ARRAYS.items():
            array = getattr(self, name)
            if array.ndim != 2 or array.shape[1] != width or array.dtype != np.dtype(kind):
                raise SimCoreError(
                    f"garment.{name}: {array.shape} {array.dtype} – expected (n, {width}) {np.dtype(kind)}"
                )
            if kind is float and not np.isfinite(array).all():
                raise SimCoreError(f"garment.{name}: holds numbers that are not finite")
        if len(self.rest) != len(self.positions):
            raise SimCoreError(
                f"garment: {len(self.rest)} rest and {len(self.positions)} draped vertices – must agree"
            )
        for name in ("faces", "seams"):
            index = getattr(self, name)
            if index.size and (index.min() < 0 or index.max() >= len(self.rest)):
                raise SimCoreError(f"garment.{name}: names vertex {index.max()} of {len(self.rest)}")

    def save(self, path: Path) -> None:
        """Writes one .npz: the arrays and a JSON header (text) under `header`."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        header = {
            "format": FORMAT,
            "name": self.name,
            "dye": self.dye,
            "weave": self.weave,
            "material": self.material,
            "provenance": self.provenance,
        }
        text = np.frombuffer(json.dumps(header, ensure_ascii=False, sort_keys=True).encode(), np.uint8)
        beside = path.with_name(path.name + ".part")
        with beside.open("wb") as stream:
            np.savez_compressed(stream, header=text, **{name: getattr(self, name) for name in _ARRAYS})
        beside.replace(path)

    @staticmethod
    def load(path: Path) -> Garment:
        """Reads what `save` wrote; raises FileProblem on a missing, damaged or foreign file."""
        path = Path(path)
        try:
            # Opened here, since numpy leaves a damaged file open.
            with path.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
                header = json.loads(data["header"].tobytes().decode())
                arrays = {name: np.ascontiguousarray(data[name]) for name in _ARRAYS}
        except FileNotFoundError as error:
            raise FileProblem(f"{path}: no such file – bake the garment first") from error
        except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError, TypeError) as error:
            raise FileProblem(f"{path}: not a garment file ({error}) – bake the garment again") from error
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise FileProblem(f"{path}: written in another format – bake the garment again")
        dye = header.get("dye")
        try:
            return Garment(
                name=header["name"],
                weave=header["weave"],
                material=header["material"],
                provenance=header["provenance"],
                dye=(dye[0], dye[1], dye[2]) if dye else None,
                **arrays,
            )
        except (SimCoreError, KeyError) as error:
            raise FileProblem(f"{path}: damaged ({error}) – bake the garment again") from error

    def digest(self) -> str:
        """A hash of the arrays: equal for two bakes that are equal to the bit, whatever time they took."""
        hashed = hashlib.sha256()
        for name in _ARRAYS:
            array = getattr(self, name)
            hashed.update(f"{name} {array.shape} {array.dtype}".encode() + array.tobytes())
        return hashed.hexdigest()

    def noted(self, **facts: Any) -> Garment:
        """The same garment with more provenance."""
        return replace(self, provenance={**self.provenance, **facts})
