"""Cutting patterns: one flat panel or several sewn ones, read from TOML and checked before anything is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from sim_core.errors import FileProblem, OutlineError, SimCoreError
from sim_core.garment.pattern.cloth import MOST_VERTICES, Cloth, cut_cloth
from sim_core.garment.pattern.panels import Panel, Seam, Spot, Tie, check_extent
from sim_core.garment.pattern.tables import (
    CutProblem,
    Measure,
    Number,
    PanelTable,
    SeamTable,
    TieTable,
    read_cut,
    read_dye,
    read_measures,
)
from sim_core.mesh import PanelMesh, panel_mesh
from sim_core.mesh.outline import check_count, check_edge, clean_contours
from sim_core.validation.files import read_toml, shown

MOST_POINTS = 5000  # of an outline


@dataclass(frozen=True)
class Pattern:
    """A cutting pattern: outline (N, 2) [m], x along the weft, y (down) along the warp; edge [m] of its mesh; sRGB dye.

    A garment of several panels has panels and seams; mirror: they are one half, cut a second time turned over about
    x = 0, the middle. outline is then the first panel's.
    """

    name: str
    outline: np.ndarray
    edge: float
    title: dict[str, str] = field(default_factory=dict)
    dye: tuple[float, float, float] | None = None
    panels: tuple[Panel, ...] = ()
    seams: tuple[Seam, ...] = ()
    mirror: bool = False
    ties: tuple[Tie, ...] = ()
    measures: Mapping[str, float] = field(default_factory=dict)

    @staticmethod
    def load(path: Path, measures: Mapping[str, float | str] | None = None) -> Pattern:
        """Reads a pattern file, some measures [mm] replaced; raises FileProblem naming file, key, value and remedy."""
        path = Path(path)
        values = read_toml(
            path, "a pattern file (TOML); it needs name, edge, and size, outline or [[panel]] tables"
        )
        try:
            read = _PatternFile.model_validate(values)
        except ValidationError as error:
            raise FileProblem(f"{path}: {_first(error)}") from error
        for name in measures or {}:
            if name not in read.measures:
                known = ", ".join(read.measures) or "none"
                raise FileProblem(f"{path}: measures.{name}: no such measure – measures: {known}")
        pattern = _made(path, read.model_copy(update={"measures": {**read.measures, **(measures or {})}}))
        try:
            pattern.check()
        except OutlineError as error:
            raise FileProblem(f"{path}: {error}") from error
        return pattern

    def check(self) -> None:
        """Raises OutlineError where an outline cannot be cut: it crosses itself, has no area, … Nothing is meshed."""
        outlines = [panel.outline() for panel in self.panels] or [self.outline]
        names = [f"panel.{panel.name}: " for panel in self.panels] or [""]
        for name, outline in zip(names, outlines, strict=True):
            try:
                check_extent(outline)
                clean_contours(outline, ())
                check_edge(self.edge, [outline], MOST_VERTICES)
            except OutlineError as error:
                raise OutlineError(f"{name}{error}") from error

    def to_dict(self) -> dict[str, Any]:
        """A plain dictionary that JSON can hold: what is needed to mesh the pattern again."""
        return {
            "name": self.name,
            "outline": np.asarray(self.outline, float).tolist(),
            "edge": self.edge,
            "dye": self.dye and list(self.dye),
            "panels": [panel.to_dict() for panel in self.panels],
            "seams": [seam.to_dict() for seam in self.seams],
            "mirror": self.mirror,
            "ties": [asdict(tie) for tie in self.ties],
        }

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Pattern:
        """The pattern `to_dict` described; raises SimCoreError for any other dictionary."""
        try:
            return _restored(data)
        except (KeyError, TypeError, ValueError, IndexError) as error:
            raise SimCoreError(
                f"pattern: {error} – the dictionary must be one that Pattern.to_dict wrote"
            ) from error

    def panel(self, name: str) -> Panel:
        """The panel of that name; raises SimCoreError where there is none."""
        for panel in self.panels:
            if panel.name == name:
                return panel
        known = ", ".join(panel.name for panel in self.panels) or "none"
        raise SimCoreError(f"pattern {self.name}: no panel {name!r} – panels: {known}")

    def step(self, edge: float | None = None) -> float:
        """`edge` [m], or the pattern's own where it is None; raises SimCoreError unless it is above 0 and finite."""
        step = self.edge if edge is None else float(edge)
        if not (np.isfinite(step) and step > 0):
            raise SimCoreError(f"pattern {self.name}: edge {step} m – give a positive length in metres")
        return step

    def cloth(self, edge: float | None = None) -> Cloth:
        """All panels meshed at `edge` [m] (its own when left out), one half of a mirrored pattern."""
        if not self.panels:
            return Cloth.of(self.mesh(edge))
        return cut_cloth(self.panels, self.seams, self.step(edge))

    def whole(self, cut: Cloth) -> Cloth:
        """Its `cloth` with the other half where it is mirrored, panels of one side on that side alone."""
        if not self.mirror:
            return cut
        return cut.mirrored() if self.alike else cut.mirrored().only(self.kept(cut))

    @property
    def alike(self) -> bool:
        """Whether it is mirrored and both halves have the same panels."""
        return self.mirror and not any(panel.side for panel in self.panels)

    def kept(self, cut: Cloth) -> np.ndarray:
        """Which (2P,) vertices of a mirrored pattern's cloth (P) and of its image are cut."""
        halves = [np.array([panel.is_of(side) for panel in self.panels]) for side in ("left", "right")]
        return np.concatenate([half[cut.panel_of] for half in halves])

    def coloured(self, dye: str | None, dyes: Mapping[str, str]) -> Pattern:
        """The pattern in another colour '#rrggbb', and single panels in theirs; raises SimCoreError for no panel."""
        for name in dyes:
            self.panel(name)
        panels = tuple(
            replace(p, dye=read_dye(dyes[p.name]) if p.name in dyes else p.dye) for p in self.panels
        )
        return replace(self, dye=read_dye(dye) if dye else self.dye, panels=panels)

    def mesh(self, edge: float | None = None) -> PanelMesh:
        """The panel's mesh at `edge` [m] (its own when left out)."""
        step = self.step(edge)
        check_count(step, [self.outline], MOST_VERTICES)
        return panel_mesh(self.outline, edge=step)


def _restored(data: dict[str, Any]) -> Pattern:
    return Pattern(
        data["name"],
        np.asarray(data["outline"], float),
        data["edge"],
        {},
        tuple(data["dye"]) if data["dye"] else None,  # type: ignore[arg-type]
        tuple(Panel.from_dict(panel) for panel in data["panels"]),
        tuple(Seam.from_dict(seam) for seam in data["seams"]),
        data["mirror"],
        tuple(_tie(told) for told in data.get("ties", ())),
    )


def _tie(told: dict[str, Any]) -> Tie:
    a, b = (
        Spot(end["panel"], (end["place"][0], end["place"][1]), end["side"]) for end in (told["a"], told["b"])
    )
    return Tie(told["name"], a, b, told["length"])


class _PatternFile(BaseModel):
    model_config = ConfigDict(extra="forbid")
    name: str = Field(min_length=1)
    title: dict[str, str] = {}
    edge: Number = Field(gt=0, le=0.2, allow_inf_nan=False)
    size: tuple[Number, Number] | None = None
    outline: list[tuple[Number, Number]] | None = Field(None, max_length=MOST_POINTS)
    dye: str | None = Field(default=None, pattern=r"^#[0-9a-fA-F]{6}$")
    mirror: bool = False
    measures: dict[str, Measure] = {}
    panel: list[PanelTable] = Field([], max_length=100)
    seam: list[SeamTable] = Field([], max_length=400)
    tie: list[TieTable] = Field([], max_length=100)

    @model_validator(mode="after")
    def _one_shape(self) -> _PatternFile:
        if (self.size is None) + (self.outline is None) + (not self.panel) != 2:
            raise ValueError(
                "give either size = [width, length] or outline = [[x, y], …], in metres, or [[panel]] tables"
            )
        if not self.panel and (self.mirror or self.measures or self.seam or self.tie):
            raise ValueError("mirror, measures, seam and tie belong to [[panel]] tables – add them")
        if self.size and not all(np.isfinite(s) and 0 < s <= 20 for s in self.size):
            raise ValueError(f"size: {list(self.size)} – both above 0 and at most 20 m")
        if self.outline is not None and not all(np.isfinite(c) for point in self.outline for c in point):
            raise ValueError("outline: all coordinates must be finite")
        if self.outline is not None and len(self.outline) < 3:
            raise ValueError(f"outline: {len(self.outline)} points – a panel needs at least 3")
        return self

    def points(self) -> np.ndarray:
        if self.size is not None:
            w, h = self.size
            return np.array([[0, 0], [w, 0], [w, h], [0, h]], float)
        return np.asarray(self.outline, float)


def _made(path: Path, read: _PatternFile) -> Pattern:
    dye = read_dye(read.dye)
    if not read.panel:
        return Pattern(read.name, read.points(), read.edge, dict(read.title), dye)
    try:
        panels, seams, ties = read_cut(read.measures, read.panel, read.seam, read.tie, mirrored=read.mirror)
        known = read_measures(read.measures)
    except CutProblem as error:
        raise FileProblem(f"{path}: {error}") from error
    return Pattern(
        read.name,
        panels[0].outline(),
        read.edge,
        dict(read.title),
        dye,
        panels,
        seams,
        read.mirror,
        ties,
        known,
    )


def _first(error: ValidationError) -> str:
    """The first problem of a file in one line: key, what, value."""
    first = error.errors()[0]
    key = ".".join(str(part + 1) if isinstance(part, int) else str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        known = ", ".join(_PatternFile.model_fields)
        return f"{key[:80]}: unknown key – remove it or correct its name (known: {known})"
    text = first["msg"].removeprefix("Value error, ")
    value = f" (found {shown(first['input'])})" if key and first["type"] != "missing" else ""
    return f"{key}: {text}{value}" if key else text
