"""Cutting patterns: one flat panel or several sewn ones, read from TOML and checked before anything is simulated."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from sim_core.errors import FileProblem, OutlineError, SimCoreError
from sim_core.garment.cut_file import CutProblem, PanelTable, SeamTable, read_cut, read_dye
from sim_core.garment.cutting import Panel, Seam
from sim_core.garment.cutting import Path as Path_
from sim_core.garment.sewing import Cloth, cut_cloth
from sim_core.mesh import PanelMesh, panel_mesh


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

    @staticmethod
    def load(path: Path) -> Pattern:
        """Reads a pattern file; raises FileProblem naming file, key, value and remedy."""
        path = Path(path)
        try:
            text = path.read_text("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise FileProblem(f"{path}: cannot be read ({error}) – give a pattern in TOML, UTF-8") from error
        if not text.strip():
            raise FileProblem(f"{path}: the file is empty – a pattern needs name, edge, and size or outline")
        try:
            read = _PatternFile.model_validate(tomllib.loads(text))
        except tomllib.TOMLDecodeError as error:
            raise FileProblem(f"{path}: not valid TOML – {error}") from error
        except ValidationError as error:
            raise FileProblem(f"{path}: {_first(error)}") from error
        pattern = _made(path, read)
        try:
            pattern.check()
        except OutlineError as error:
            raise FileProblem(f"{path}: outline: {error}") from error
        return pattern

    def check(self) -> None:
        """Raises OutlineError where the outline cannot be cut: it crosses itself, has no area, …"""
        if self.panels:
            self.cloth(max(0.04, self.edge))
            return
        low, high = self.outline.min(0), self.outline.max(0)
        panel_mesh(self.outline, edge=float((high - low).min()) / 4 or self.edge)

    def to_dict(self) -> dict[str, Any]:
        """A plain dictionary that JSON can hold: what is needed to mesh the pattern again."""
        return {
            "name": self.name,
            "outline": np.asarray(self.outline, float).tolist(),
            "edge": self.edge,
            "dye": self.dye and list(self.dye),
            "panels": [panel.to_dict() for panel in self.panels],
            "seams": [{"kind": s.kind, "a": str(s.a), "b": s.b and str(s.b)} for s in self.seams],
            "mirror": self.mirror,
        }

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Pattern:
        """The pattern `to_dict` described."""
        seams = [
            Seam(s["kind"], Path_.read(s["a"]), Path_.read(s["b"]) if s["b"] else None) for s in data["seams"]
        ]
        return Pattern(
            data["name"],
            np.asarray(data["outline"], float),
            data["edge"],
            {},
            tuple(data["dye"]) if data["dye"] else None,  # type: ignore[arg-type]
            tuple(Panel.from_dict(panel) for panel in data["panels"]),
            tuple(seams),
            data["mirror"],
        )

    def panel(self, name: str) -> Panel:
        """The panel of that name; raises SimCoreError where there is none."""
        for panel in self.panels:
            if panel.name == name:
                return panel
        known = ", ".join(panel.name for panel in self.panels) or "none"
        raise SimCoreError(f"pattern {self.name}: no panel {name!r} – panels: {known}")

    def cloth(self, edge: float | None = None) -> Cloth:
        """All panels meshed at `edge` [m] (its own when left out), one half of a mirrored pattern."""
        return cut_cloth(self.panels, self.seams, edge or self.edge)

    def mesh(self, edge: float | None = None) -> PanelMesh:
        """The panel's mesh at `edge` [m] (its own when left out)."""
        return panel_mesh(self.outline, edge=edge or self.edge)


class _PatternFile(BaseModel):
    model_config = ConfigDict(extra="forbid")
    name: str = Field(min_length=1)
    title: dict[str, str] = {}
    edge: float = Field(gt=0, le=0.2, allow_inf_nan=False)
    size: tuple[float, float] | None = None
    outline: list[tuple[float, float]] | None = None
    dye: str | None = Field(default=None, pattern=r"^#[0-9a-fA-F]{6}$")
    mirror: bool = False
    measures: dict[str, float | str] = {}
    panel: list[PanelTable] = []
    seam: list[SeamTable] = []

    @model_validator(mode="after")
    def _one_shape(self) -> _PatternFile:
        if (self.size is None) + (self.outline is None) + (not self.panel) != 2:
            raise ValueError(
                "give either size = [width, length] or outline = [[x, y], …], in metres, or [[panel]] tables"
            )
        if not self.panel and (self.mirror or self.measures or self.seam):
            raise ValueError("mirror, measures and seam belong to [[panel]] tables – add them")
        if self.size and not all(np.isfinite(s) and 0 < s <= 20 for s in self.size):
            raise ValueError(f"size: {list(self.size)} – both above 0 and at most 20 m")
        if self.outline is not None and not np.isfinite(np.asarray(self.outline, float)).all():
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
        panels, seams = read_cut(read.measures, read.panel, read.seam, mirrored=read.mirror)
    except CutProblem as error:
        raise FileProblem(f"{path}: {error}") from error
    return Pattern(
        read.name, panels[0].outline(), read.edge, dict(read.title), dye, panels, seams, read.mirror
    )


def _first(error: ValidationError) -> str:
    """The first problem of a file in one line: key, what, value."""
    first = error.errors()[0]
    key = ".".join(str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        return f"{key}: unknown key – remove it or correct its name (known: {', '.join(_PatternFile.model_fields)})"
    text = first["msg"].removeprefix("Value error, ")
    value = f" (found {first['input']!r})" if key and first["type"] != "missing" else ""
    return f"{key}: {text}{value}" if key else text
