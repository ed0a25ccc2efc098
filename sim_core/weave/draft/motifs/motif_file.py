"""Motif files (TOML): a program by name and its parameters, a drawing, or a layout of several, all in millimetres.

Mistakes are named by file and key.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim_core.errors import SimCoreError, WeaveError
from sim_core.validation.files import read_toml, shown
from sim_core.weave.draft.motifs.drawing import Area, areas_of, read_drawing
from sim_core.weave.draft.motifs.layout import Part, laid_out
from sim_core.weave.draft.motifs.motif import MOST_COLOURS, Motif
from sim_core.weave.draft.motifs.programs import PROGRAMS

__all__ = ["Recipe", "motif_of_program", "read_motif", "recipe_of"]

MM = 1e-3  # [m]
LAYOUT = "layout"  # the program of motif files with [[part]] tables
DRAWING = "drawing"  # of those that name a drawing
Number = Annotated[float, Field(gt=0, le=4000)]
Side = Annotated[float, Field(ge=0.1, le=4000)]
Colour = Annotated[str, Field(pattern="^#[0-9a-fA-F]{6}$")]
Place = Annotated[float, Field(ge=-4000, le=4000)]


class _Title(BaseModel):
    model_config = ConfigDict(extra="forbid")
    zh: str
    en: str


class _PartTable(BaseModel):
    """A rectangle of a layout: a motif file beside this one, or one number all over."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)
    motif: Annotated[str, Field(pattern=r"\.toml$", max_length=200)] | None = None
    parameters: dict[str, Number] = {}
    fill: Annotated[int, Field(ge=0, lt=MOST_COLOURS)] | None = None
    within: tuple[float, float, float, float] | None = None
    at: tuple[Place, Place] | None = None
    turned: bool = False
    numbers: list[Annotated[int, Field(ge=0, lt=MOST_COLOURS)]] = []


class _MotifFile(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)
    name: str
    title: _Title | None = None
    source: str | None = None
    program: str | None = None
    svg: Annotated[str, Field(pattern=r"\.svg$", max_length=200)] | None = None
    colours: Annotated[dict[Colour, Annotated[int, Field(ge=0, lt=MOST_COLOURS)]], Field(max_length=64)] = {}
    parameters: dict[str, Number] = {}
    repeat: tuple[Side, Side] | None = None
    part: Annotated[list[_PartTable], Field(max_length=64)] = []


@dataclass(frozen=True)
class Recipe:
    """What a motif file says: a program with its parameters [mm], or the programs `layout` and `drawing` (width and
    height) with their parts or areas."""

    program: str
    parameters: tuple[tuple[str, float], ...]
    parts: tuple[Part, ...] = ()
    areas: tuple[Area, ...] = ()

    def motif(self, name: str) -> Motif:
        """What it draws; raises WeaveError."""
        return replace(_drawn(self), name=name)


@lru_cache(maxsize=32)
def _drawn(recipe: Recipe) -> Motif:
    size = dict(recipe.parameters)
    if recipe.program == DRAWING:
        return Motif(DRAWING, (MM * size["width"], MM * size["height"]), areas_of(recipe.areas))
    return motif_of_program(recipe.program, recipe.program, size, recipe.parts)


def read_motif(path: Path, changes: Mapping[str, float] | None = None) -> Motif:
    """The motif of a file; changes: parameters that are to be others than the file says [mm, or counts].

    Raises FileProblem where the file cannot be read, WeaveError (file: key: what – remedy) for what it cannot mean.
    """
    return _read(path, changes)[1]


def recipe_of(path: Path, changes: Mapping[str, float] | None = None) -> Recipe:
    """The recipe of a motif file, those parameters that `changes` names changed; raises as `read_motif` does."""
    return _read(path, changes)[0]


def _read(path: Path, changes: Mapping[str, float] | None) -> tuple[Recipe, Motif]:
    file = _checked(path)
    try:
        recipe = _recipe(file, path.parent, dict(changes or {}))
        return recipe, recipe.motif(file.name)
    except WeaveError as error:
        raise WeaveError(f"{path}: {error}") from error


def _checked(path: Path) -> _MotifFile:
    values = read_toml(path, "a motif file (TOML), such as those in assets/motifs")
    try:
        return _MotifFile.model_validate(values)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        place = (str(part + 1) if isinstance(part, int) else str(part) for part in first["loc"])
        key = ".".join(place) or "file"
        raise WeaveError(f"{path}: {key}: {shown(first.get('input'))}: {first['msg']}") from error


def _recipe(file: _MotifFile, folder: Path, changes: dict[str, float]) -> Recipe:
    if (file.program is not None) + (file.svg is not None) + bool(file.part) != 1:
        raise WeaveError("program: give a program, or svg, or [[part]] tables and their repeat – one of them")
    if file.colours and file.svg is None:
        raise WeaveError("colours: of a drawing – name it by svg, or leave them out")
    if file.svg is not None:
        if file.parameters:
            raise WeaveError("parameters: a drawing has none – write its repeat = [width, height]")
        if not file.colours:
            raise WeaveError(
                'colours: missing – give every colour of the drawing a number, { "#c02020" = 1 }'
            )
        (width, height), areas = read_drawing(folder / file.svg, file.colours, file.repeat, changes)
        return Recipe(DRAWING, (("height", height), ("width", width)), areas=areas)
    if file.program is not None:
        if file.repeat:
            raise WeaveError("repeat: of [[part]] tables – a program has its own; leave it out")
        return Recipe(file.program, tuple(sorted((file.parameters | changes).items())))
    if file.repeat is None:
        raise WeaveError("repeat: missing – give [width, height] in millimetres, along the weft and the warp")
    if file.parameters or changes:
        raise WeaveError(
            "parameters: a layout has none of its own – change those of its parts, in the motif file"
        )
    size = {"height": file.repeat[1], "width": file.repeat[0]}
    parts = tuple(_part(k, table, folder, file.repeat) for k, table in enumerate(file.part, 1))
    return Recipe(LAYOUT, tuple(size.items()), parts)


def _part(number: int, table: _PartTable, folder: Path, repeat: tuple[float, float]) -> Part:
    within = table.within or (0.0, 0.0, *repeat)
    key = f"part.{number}"
    if (table.motif is None) == (table.fill is None):
        raise WeaveError(f"{key}: give it a motif file or fill, one of both")
    if table.motif is None:
        if table.parameters or table.at or table.numbers or table.turned:
            raise WeaveError(f"{key}: parameters, at, turned and numbers are a motif's – leave them out")
        return Part(within, numbers=(int(table.fill or 0),))
    try:
        file = _checked(folder / table.motif)
        if file.part:
            raise WeaveError(f"{table.motif} is a layout, too – name a motif with a program")
        inner = _recipe(file, folder, table.parameters)
        inner.motif(file.name)
    except SimCoreError as error:
        raise WeaveError(f"{key}.motif: {error}") from error
    return Part(
        within, inner.program, inner.parameters, table.at, tuple(table.numbers), table.turned, inner.areas
    )


def motif_of_program(
    name: str,
    program: str,
    parameters: Mapping[str, float] | None = None,
    parts: Sequence[Part] = (),
) -> Motif:
    """What a program draws. parameters: millimetres and counts by name, those that are not given as the program has
    them; parts: of the program `layout`. Raises WeaveError for an unknown program or parameter, and for numbers it
    cannot draw with."""
    from shapely.affinity import scale
    from shapely.errors import ShapelyError

    if program == LAYOUT and parts:
        size = parameters or {}
        inner = [
            Recipe(p.program, p.parameters, areas=p.areas).motif(p.program) if p.program else None
            for p in parts
        ]
        return laid_out(name, (size["width"], size["height"]), list(zip(parts, inner, strict=True)))
    if program not in PROGRAMS:
        raise WeaveError(f"program: {shown(program)} – there are {', '.join(PROGRAMS)}")
    draw = PROGRAMS[program]
    known = inspect.signature(draw).parameters
    given: dict[str, Any] = {}
    for key, value in (parameters or {}).items():
        if key not in known:
            raise WeaveError(f"parameters.{key}: unknown – {program} has {', '.join(known)}")
        if isinstance(known[key].default, int):
            if value != int(value) or not 1 <= value <= 400:
                raise WeaveError(f"parameters.{key}: {value:g} – a whole number from 1 to 400")
            value = int(value)
        given[key] = value
    try:
        size, areas = draw(**given)
    except (ShapelyError, ValueError, ZeroDivisionError) as error:
        raise WeaveError(
            f"parameters: {program} cannot draw with these ({str(error).splitlines()[0][:80]}) – change them by less"
        ) from error
    return Motif(
        name,
        (MM * size[0], MM * size[1]),
        tuple((number, scale(area, MM, MM, origin=(0, 0))) for number, area in areas),
    )
