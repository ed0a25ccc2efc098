"""Mesh steps of an outfit's layers, chosen by what `simcore dress --study` measured: as coarse as the exhibit's error
allows, and as fine as its patience does."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hall_app.content.bakes.inputs import outfit_files
from hall_app.content.folder import Content, Exhibit
from hall_app.content.schema.exhibit import Show

__all__ = [
    "PATIENCE",
    "PATIENCE_WHOLE",
    "Step",
    "Study",
    "beneath_budget",
    "budget",
    "chosen_steps",
    "hall_budget",
    "read_study",
    "study_of",
]

SCREEN = 1080  # [pixels] height of the picture a pixel's budget is reckoned for
FIELD_OF_VIEW = math.radians(58)
HALL_BENEATH = 0.004  # [m] by how much what is worn beneath may deviate in the hall, p99
# Times that by which what stands may deviate: of what moves, triangles are shared between all its moments.
MOVING = 3.0
# [s] of processor time that dressing a layer may take: of one half against its image, and of one dressed whole
PATIENCE, PATIENCE_WHOLE = 180.0, 900.0
GRID = 0.0005  # [m] that steps are rounded up to
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Edge = Annotated[float, Field(ge=0.002, le=0.2)]


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Apart(Table):
    """Two-sided distance of two drapes [m]."""

    mean_m: Positive
    p99_m: Positive


class Step(Table):
    """A layer's mesh step [m], the distance (p99) [m] its drape is reckoned to be from one infinitely fine, what drapes
    scatter by at the coarsest step, and what decided: error, patience or the steps that were measured."""

    edge: float
    error_p99_m: float
    budget_m: float
    scatter_p99_m: float
    cpu_seconds: float
    by: str


class LayerStudy(Table):
    """edges [m], coarsest first; triangles and processor seconds at each; how far each drape is from the next finer."""

    name: str
    whole: bool
    edges: list[Edge] = Field(min_length=2, max_length=20)
    triangles: list[int]
    cpu_seconds: list[Positive]
    apart: list[Apart]
    scatter: Apart

    def model_post_init(self, context: Any, /) -> None:
        count = len(self.edges)
        counts = len(self.triangles), len(self.cpu_seconds), len(self.apart) + 1
        if any(number != count for number in counts) or sorted(set(self.edges), reverse=True) != self.edges:
            raise ValueError(
                f"layer {self.name}: {count} edges, coarsest first, and as many figures are meant"
            )

    @property
    def order(self) -> float:
        """The power of the step that the error goes with: measured where there are three steps, else 1, as bending
        converges on irregular meshes."""
        if len(self.edges) < 3:
            return 1.0
        ratio = math.log(self.apart[-2].p99_m / self.apart[-1].p99_m)
        return min(2.0, max(0.5, ratio / math.log(self.edges[-2] / self.edges[-1])))

    def error(self, edge: float) -> float:
        """Distance (p99) [m] at a step from an infinitely fine mesh, extrapolated from the two finest (Richardson)."""
        coarse, fine = self.edges[-2:]
        return self.apart[-1].p99_m * edge**self.order / (coarse**self.order - fine**self.order)

    def seconds(self, edge: float) -> float:
        """Of a processor at a step: by the power law through the coarsest and the finest."""
        (first, last), (begin, end) = (
            self.cpu_seconds[:: len(self.edges) - 1],
            self.edges[:: len(self.edges) - 1],
        )
        power = min(5.0, max(1.0, math.log(last / first) / math.log(begin / end)))
        return last * (end / edge) ** power

    def step(self, budget: float) -> Step:
        """The coarsest step whose error stays within `budget` [m]; a finer one than the patience bears, or than was
        measured, is not taken."""
        coarsest, finest = self.edges[0], self.edges[-1]
        wanted = finest * (budget / self.error(finest)) ** (1 / self.order)
        patience = PATIENCE_WHOLE if self.whole else PATIENCE
        low, high = finest, coarsest
        for _ in range(60):  # the finest that is borne
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.seconds(middle) <= patience else (middle, high)
        borne = finest if self.seconds(finest) <= patience else high
        edge = min(coarsest, max(wanted, borne, finest))
        by = (
            "error"
            if edge == wanted or edge == coarsest
            else "patience"
            if borne > finest
            else "finest measured"
        )
        edge = min(coarsest, math.ceil(edge / GRID - 1e-9) * GRID)
        return Step(
            edge=round(edge, 6),
            error_p99_m=round(self.error(edge), 6),
            budget_m=round(budget, 6),
            scatter_p99_m=self.scatter.p99_m,
            cpu_seconds=round(self.seconds(edge), 1),
            by=by,
        )


class Study(Table):
    """What `simcore dress --study` writes; inputs: a hash of the outfit without its steps."""

    outfit: str
    inputs: str
    layers: list[LayerStudy] = Field(min_length=1, max_length=20)

    def steps(self, beneath: float, outermost: float) -> tuple[Step, ...]:
        """The steps of the layers, whose errors [m] may be `beneath`, the outermost one's `outermost`."""
        budgets = [beneath] * (len(self.layers) - 1) + [outermost]
        return tuple(layer.step(budget) for layer, budget in zip(self.layers, budgets, strict=True))


def budget(nearest: float, pixels: float) -> float:
    """The length [m] that `pixels` of a full-screen picture show at the nearest viewing distance [m]."""
    return pixels * 2 * nearest * math.tan(FIELD_OF_VIEW / 2) / SCREEN


def hall_budget(nearest: float, pixels: float, *, moving: bool = False) -> float:
    """How far (p99) an exhibit's model in the hall may deviate [m], of one that moves at every time."""
    return budget(nearest, pixels) * (MOVING if moving else 1.0)


def beneath_budget(show: Show) -> float:
    """The same of what is worn beneath [m]."""
    pixels = show.hall_beneath_px
    return HALL_BENEATH if pixels is None else budget(show.nearest, pixels)


def study_of(content: Content, exhibit: Exhibit) -> Study | None:
    """The study that an exhibit's outfit names, None where it names none.

    Raises ValueError and what `outfit_files` raises for files that cannot be read.
    """
    outfit = exhibit.file.outfit
    named = dict(outfit_files(content.folder, outfit)) if outfit is not None else {}
    return read_study(content.folder / named["study"]) if "study" in named else None


def chosen_steps(content: Content, exhibit: Exhibit) -> tuple[Step, ...]:
    """The steps of an exhibit's layers, none where its outfit names no study; raises as `study_of` does."""
    study, show = study_of(content, exhibit), exhibit.file.show
    return study.steps(beneath_budget(show), budget(show.nearest, show.hall_error_px)) if study else ()


def read_study(path: Path) -> Study:
    """The study in a file. Raises ValueError, naming the key, for what is none, and OSError."""
    try:
        return Study.model_validate_json(path.read_bytes())
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part + 1) if isinstance(part, int) else str(part) for part in first["loc"])
        what = first["msg"].removeprefix("Value error, ")
        raise ValueError(
            f"{f'{key}: ' if key else ''}{what} – write it anew by `simcore dress OUTFIT.toml --study FILE.json`"
        ) from error
