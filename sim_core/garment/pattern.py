"""Cutting patterns: one flat panel, read from a TOML file and checked before anything is simulated."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from sim_core.errors import FileProblem, OutlineError
from sim_core.mesh import PanelMesh, panel_mesh


@dataclass(frozen=True)
class Pattern:
    """A panel: outline (N, 2) [m], x along the weft, y (down) along the warp; edge [m] of its mesh; dye as sRGB."""

    name: str
    outline: np.ndarray
    edge: float
    title: dict[str, str] = field(default_factory=dict)
    dye: tuple[float, float, float] | None = None

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
        pattern = Pattern(read.name, read.points(), read.edge, dict(read.title), read.colour())
        try:
            pattern.check()
        except OutlineError as error:
            raise FileProblem(f"{path}: outline: {error}") from error
        return pattern

    def check(self) -> None:
        """Raises OutlineError where the outline cannot be cut: it crosses itself, has no area, …"""
        low, high = self.outline.min(0), self.outline.max(0)
        panel_mesh(self.outline, edge=float((high - low).min()) / 4 or self.edge)

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

    @model_validator(mode="after")
    def _one_shape(self) -> _PatternFile:
        if (self.size is None) == (self.outline is None):
            raise ValueError("give either size = [width, length] or outline = [[x, y], …], in metres")
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

    def colour(self) -> tuple[float, float, float] | None:
        if self.dye is None:
            return None
        r, g, b = (int(self.dye[k : k + 2], 16) / 255 for k in (1, 3, 5))
        return r, g, b


def _first(error: ValidationError) -> str:
    """The first problem of a file in one line: key, what, value."""
    first = error.errors()[0]
    key = ".".join(str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        return f"{key}: unknown key – remove it or correct its name (known: {', '.join(_PatternFile.model_fields)})"
    text = first["msg"].removeprefix("Value error, ")
    value = f" (found {first['input']!r})" if key and first["type"] != "missing" else ""
    return f"{key}: {text}{value}" if key else text
