"""Motif files (TOML): a program by name and its parameters in millimetres; mistakes are named by file and key."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim_core.errors import WeaveError
from sim_core.validation.files import read_toml, shown
from sim_core.weave.draft.motifs.motif import Motif
from sim_core.weave.draft.motifs.programs import PROGRAMS

__all__ = ["motif_of_program", "program_of", "read_motif"]

MM = 1e-3  # [m]
Number = Annotated[float, Field(gt=0, le=4000)]


class _Title(BaseModel):
    model_config = ConfigDict(extra="forbid")
    zh: str
    en: str


class _MotifFile(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)
    name: str
    title: _Title | None = None
    source: str | None = None
    program: str
    parameters: dict[str, Number] = {}


def read_motif(path: Path, changes: Mapping[str, float] | None = None) -> Motif:
    """The motif of a file; changes: parameters that are to be others than the file says [mm, or counts].

    Raises FileProblem where the file cannot be read, WeaveError (file: key: what – remedy) for what it cannot mean.
    """
    return _drawn(path, changes)[2]


def program_of(path: Path, changes: Mapping[str, float] | None = None) -> tuple[str, dict[str, float]]:
    """Program and parameters of a motif file, those that `changes` names changed; raises as `read_motif` does."""
    program, parameters, _ = _drawn(path, changes)
    return program, parameters


def _drawn(path: Path, changes: Mapping[str, float] | None) -> tuple[str, dict[str, float], Motif]:
    values = read_toml(path, "a motif file (TOML), such as those in assets/motifs")
    try:
        file = _MotifFile.model_validate(values)
        parameters = file.parameters | dict(changes or {})
        return file.program, parameters, motif_of_program(file.name, file.program, parameters)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        key = ".".join(str(part) for part in first["loc"]) or "file"
        raise WeaveError(f"{path}: {key}: {shown(first.get('input'))}: {first['msg']}") from error
    except WeaveError as error:
        raise WeaveError(f"{path}: {error}") from error


def motif_of_program(name: str, program: str, parameters: Mapping[str, float] | None = None) -> Motif:
    """What a program draws. parameters: millimetres and counts by name, those that are not given as the program has
    them. Raises WeaveError for an unknown program or parameter, and for numbers it cannot draw with."""
    from shapely.affinity import scale
    from shapely.errors import ShapelyError

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
