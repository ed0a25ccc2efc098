"""The `Garment` value: flat panels, how they are welded, the drape, weave, material and where all of it came from."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import FileProblem, SimCoreError
from sim_core.garment.pattern import Panel, creases_of, unsided
from sim_core.garment.settled import Settled
from sim_core.validation.files import read_npz, shown, written_whole

FORMAT = 3
_ARRAYS: dict[str, tuple[type, int]] = {
    "pattern": (float, 2),
    "pattern_faces": (np.int32, 3),
    "weld": (np.int32, 0),
    "panel": (np.int32, 0),
    "positions": (float, 3),
}

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Garment:
    """A draped garment. P pattern vertices, V draped vertices, F faces.

    pattern (P, 2) [m] in pattern axes (x weft, y down the warp), each panel in its own; pattern_faces (F, 3) int32;
    weld (P,) int32: the draped vertex of each pattern vertex, one for all twins of a seam; positions (V, 3) [m], y up;
    panel (F,) int32 into panels (names); dyes: sRGB per panel, None: `dye`, the garment's; cut: the pattern it was
    meshed from (`Pattern.to_dict`); weave, weaves (of panels that have their own) and material as plain dictionaries;
    origins: per panel, where a corner of the weave's repeat lies in its pattern axes [m] (empty: all at 0, 0);
    provenance: inputs, seed, versions, seconds per stage, measured errors; settled: what it came to rest in,
    for whoever carries it on.
    """

    name: str
    pattern: np.ndarray
    pattern_faces: np.ndarray
    weld: np.ndarray
    panel: np.ndarray
    positions: np.ndarray
    panels: tuple[str, ...] = ("cloth",)
    dyes: tuple[Colour | None, ...] = (None,)
    cut: dict[str, Any] = field(default_factory=dict)
    weave: dict[str, Any] = field(default_factory=dict)
    weaves: dict[str, Any] = field(default_factory=dict)
    material: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    dye: Colour | None = None
    settled: Settled | None = None
    origins: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        for name, (kind, width) in _ARRAYS.items():
            array, shape = getattr(self, name), f"(n, {width})" if width else "(n,)"
            if array.ndim != (2 if width else 1) or array.shape[-1] != (width or len(array)):
                raise SimCoreError(
                    f"garment.{name}: {array.shape} {array.dtype} – expected {shape} {np.dtype(kind)}"
                )
            if array.dtype != np.dtype(kind):
                raise SimCoreError(
                    f"garment.{name}: {array.shape} {array.dtype} – expected {shape} {np.dtype(kind)}"
                )
            if kind is float and not np.isfinite(array).all():
                raise SimCoreError(f"garment.{name}: holds numbers that are not finite")
        if len(self.pattern) != len(self.weld) or len(self.pattern_faces) != len(self.panel):
            raise SimCoreError(
                f"garment: {len(self.pattern)} pattern vertices, {len(self.weld)} welds, {len(self.pattern_faces)} "
                f"faces, {len(self.panel)} panels – must agree"
            )
        if len(self.panels) != len(self.dyes):
            raise SimCoreError(f"garment: {len(self.panels)} panels, {len(self.dyes)} dyes – must agree")
        if self.origins and len(self.panels) != len(self.origins):
            raise SimCoreError(
                f"garment: {len(self.panels)} panels, {len(self.origins)} origins – must agree"
            )
        for name, count in (
            ("pattern_faces", len(self.pattern)),
            ("weld", len(self.positions)),
            ("panel", len(self.panels)),
        ):
            index = getattr(self, name)
            if index.size and (index.min() < 0 or index.max() >= count):
                raise SimCoreError(f"garment.{name}: names number {index.max()} of {count}")
        if self.weld.size and len(np.unique(self.weld)) != len(self.positions):
            raise SimCoreError(
                f"garment.weld: not every one of {len(self.positions)} draped vertices is named"
            )

    @property
    def faces(self) -> np.ndarray:
        """Faces (F, 3) int32 of the draped vertices: welded panels share theirs along a seam."""
        return self.weld[self.pattern_faces]

    def worn(self) -> np.ndarray:
        """Draped positions (P, 3) [m] of the pattern vertices."""
        return self.positions[self.weld]

    def rest_corners(self) -> np.ndarray:
        """Pattern coordinates (F, 3, 2) [m] of every face's corners."""
        return self.pattern[self.pattern_faces]

    def creases(self) -> np.ndarray:
        """Edges (C, 2) of draped vertices along the folds of pleats."""
        told = self.cut.get("panels") or ()
        if not any(panel.get("pleats") for panel in told):
            return np.zeros((0, 2), np.int32)
        cut = [Panel.from_dict(panel) for panel in told]
        return self.weld[creases_of(cut, self.pattern, self.pattern_faces, self.panel)]

    def dye_of(self, panel: int) -> Colour | None:
        """The dye of a panel: its own, else the garment's; None of cloth woven of several colours, which keeps them."""
        weave = self.weaves.get(unsided(self.panels[panel]), self.weave)
        if any(len({str(c) for c in weave.get(f"{side}_colours", ())}) > 1 for side in ("warp", "weft")):
            return None
        return self.dyes[panel] or self.dye

    def cloth_places(self) -> np.ndarray:
        """Where every pattern vertex lies in the cloth (P, 2) [m], from the corner of a repeat: x weft, y down."""
        if not self.origins:
            return self.pattern
        places, origins = self.pattern.copy(), np.array(self.origins)
        for number in range(len(self.panels)):
            own = np.unique(self.pattern_faces[self.panel == number])
            places[own] = self.pattern[own] - origins[number]
        return places

    def save(self, path: Path, beside: tuple[str, Garment] | None = None) -> None:
        """Writes one .npz: the arrays and a JSON header (text) under `header`; raises FileProblem where it cannot.

        beside: a garment that is written under such a name in the same folder. What both lie on is read from there.
        """
        lent = {}
        if beside is not None and self.settled and beside[1].settled:
            lent = self.settled.lent_by(beside[1].settled, beside[0])
        header = {
            "format": FORMAT,
            "name": self.name,
            "dye": self.dye,
            "panels": self.panels,
            "dyes": self.dyes,
            "origins": self.origins,
            "cut": self.cut,
            "weave": self.weave,
            "weaves": self.weaves,
            "material": self.material,
            "provenance": self.provenance,
            "settled": self.settled and self.settled.to_header(lent),
        }
        text = np.frombuffer(json.dumps(header, ensure_ascii=False, sort_keys=True).encode(), np.uint8)
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        arrays |= self.settled.arrays(lent) if self.settled else {}
        with written_whole(Path(path)) as stream:
            np.savez_compressed(stream, header=text, **arrays)

    @staticmethod
    def load(path: Path) -> Garment:
        """Reads what `save` wrote; raises FileProblem on a missing, damaged or foreign file, it or one beside it."""
        path = Path(path)
        what, remedy = "a garment file", "bake the garment again"
        try:
            header = json.loads(read_npz(path, ("header",), what, remedy)["header"].tobytes().decode())
        except FileProblem:
            raise
        except (ValueError, RecursionError) as error:
            raise FileProblem(f"{path}: not a garment file ({error}) – bake the garment again") from error
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise FileProblem(f"{path}: written in another format – bake the garment again")
        try:
            told = header["settled"]
            names = Settled.names(told) if told else {"": {}}
        except (KeyError, TypeError, ValueError) as error:
            raise FileProblem(f"{path}: damaged ({error}) – bake the garment again") from error
        data = read_npz(path, (*_ARRAYS, *names.pop("").values()), what, remedy)
        for file, lent in names.items():
            found = read_npz(path.with_name(file), lent.values(), what, remedy)
            data |= {own: found[theirs] for own, theirs in lent.items()}
        try:
            return Garment(
                name=str(header["name"]),
                panels=tuple(str(name) for name in header["panels"]),
                dyes=tuple(_colour(dye) for dye in header["dyes"]),
                cut=_facts(header, "cut"),
                weave=_facts(header, "weave"),
                weaves=_facts(header, "weaves"),
                material=_facts(header, "material"),
                provenance=_facts(header, "provenance"),
                dye=_colour(header.get("dye")),
                settled=Settled.of(told, data) if told else None,
                origins=tuple((float(x), float(y)) for x, y in header.get("origins", ())),
                **{name: np.ascontiguousarray(data[name]) for name in _ARRAYS},
            )
        except (SimCoreError, KeyError, TypeError, ValueError, OverflowError) as error:
            raise FileProblem(f"{path}: damaged ({error}) – bake the garment again") from error

    def digest(self) -> str:
        """A hash of the arrays: equal for two bakes that are equal to the bit, whatever time they took."""
        hashed = hashlib.sha256()
        for name in _ARRAYS:
            array = getattr(self, name)
            hashed.update(f"{name} {array.shape} {array.dtype}".encode() + array.tobytes())
        return hashed.hexdigest()

    def on_grid(self, step: float) -> Garment:
        """The same garment, each coordinate of it and of what it lies on a multiple of `step` [m], best a power of two:
        what a simulation leaves in the last digits is no longer kept, and files are smaller for it."""
        settled = self.settled and self.settled.on_grid(step)
        return replace(self, positions=np.rint(self.positions / step) * step, settled=settled)

    def noted(self, **facts: Any) -> Garment:
        """The same garment with more provenance."""
        return replace(self, provenance={**self.provenance, **facts})


def _colour(dye: Any) -> Colour | None:
    if not dye:
        return None
    r, g, b = (float(share) for share in dye)
    if not all(0 <= share <= 1 for share in (r, g, b)):
        raise ValueError(f"dye {dye}: sRGB goes from 0 to 1")
    return r, g, b


def _facts(header: dict[str, Any], name: str) -> dict[str, Any]:
    if not isinstance(header[name], dict):
        raise TypeError(f"{name} is {shown(header[name])}, no table")
    return header[name]
