"""From a pydantic or TOML complaint to a Problem a curator understands."""

from __future__ import annotations

import difflib
import tomllib
import types
import typing
from typing import Any, Union

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from hall_app.content.problems import Problem

Location = tuple[int | str, ...]

LANGUAGES = ("zh", "en")
REMEDIES = {
    "blank_text": "write the text",
    "unsafe_path": "copy the file into the folder and write its path from there, with / and without ..",
    "one_footprint": "keep one of them and remove the others",
    "one_model": 'keep one: outfit = "outfits/….toml", scan = "….glb", or a [models] table',
    "scanned_alone": 'write scan = "….glb" above the first table, or remove [scanned]',
    "show_alone": "remove it",
    "one_source": 'write file = "media/…" or files = ["media/…", …]',
    "body_shape": 'write shape = "round" with radius, or shape = "box" with size = [width, depth]',
    "zero_length": "give the wall two different ends",
    "sign_shows": 'write kind = "picture" with picture = "media/….jpg", or remove picture',
    "sign_silent": "remove text",
    "sign_painted": "save it as .jpg, .png or .webp",
    "eye_order": "write min ≤ default ≤ max, in metres",
    "own_address": "write it whole, e.g. https://hall.example.org, without ? and #",
    "email": "write it whole, e.g. collection@example.org",
    "word_twice": "give one of them another id, or make one word of both",
    "one_place": 'keep one: url = "https://…", or file = "papers/….pdf"',
    "web_address": "write the whole address, https://…, or leave url out",
    "date_type": "write a date such as 2026-11-27, without quotation marks",
    "behaviour": "remove it or correct its spelling",
    "too_short": "add the missing entries",
    "too_long": "remove the surplus entries",
    "literal_error": "write one of the values named",
    "string_type": "put the text between quotation marks",
    "string_pattern_mismatch": "use only a-z, 0-9 and -",
    "finite_number": "write an ordinary number",
    "tuple_type": "write a list in [ ]",
    "model_type": 'write a table, e.g. { zh = "…", en = "…" }',
}

# Keys that files had once: what became of each, and what to write instead.
FORMER: dict[Location, tuple[str, str]] = {
    ("garment",): (
        "no longer a table: pattern, weave and wearer stand in an outfit file",
        'write outfit = "outfits/….toml" above the first table, and nearest and hall_error_px below [show]',
    )
}


def toml_problem(file: str, error: tomllib.TOMLDecodeError | UnicodeDecodeError) -> Problem:
    """A file that is not TOML; the message of tomllib carries line and column."""
    if isinstance(error, UnicodeDecodeError):
        return Problem(file, "", f"not UTF-8 at byte {error.start}", "save the file with the encoding UTF-8")
    return Problem(file, "", f"not TOML: {error}", "correct that line; a text stands between quotation marks")


def schema_problems(file: str, model: type[BaseModel], error: ValidationError) -> list[Problem]:
    """One problem for each complaint of pydantic about `file`."""
    return [_problem(file, model, detail) for detail in error.errors(include_url=False)]


def _problem(file: str, model: type[BaseModel], detail: ErrorDetails) -> Problem:
    location, kind, message = detail["loc"], detail["type"], detail["msg"]
    key = key_name(location)
    if kind == "extra_forbidden" and location in FORMER:
        return Problem(file, key, *FORMER[location])
    if kind == "extra_forbidden":
        known = _known_keys(model, location[:-1])
        close = difflib.get_close_matches(str(location[-1]), known, n=1)
        fix = f"did you mean {close[0]}?" if close else f"remove it; known keys are {', '.join(known)}"
        return Problem(file, key, "unknown key", fix)
    if kind == "missing" and isinstance(location[-1], int):
        return Problem(file, key, "missing", REMEDIES["too_short"])
    if kind == "missing":
        return Problem(file, key, "missing", f"add {location[-1]} = … to the file (its form: README.md)")
    given = detail.get("input")
    got = f" (got {given!r})" if isinstance(given, str | int | float | bool) else ""
    what = message[:1].lower() + message[1:] + got
    if kind == "blank_text" and location[-1] in LANGUAGES:
        return Problem(file, key, what, "write the text, in both languages")
    return Problem(file, key, what, _remedy(kind))


def _remedy(kind: str) -> str:
    if kind in REMEDIES:
        return REMEDIES[kind]
    if kind.startswith(("float", "int")):
        return "write a number such as 3.2, without quotation marks, with a point"
    if kind.startswith(("greater", "less")):
        return "write a number within the limit"
    return "correct the value (its form: README.md)"


def key_name(location: Location) -> str:
    """A place in the file as a curator counts: media[1].alt.zh is the first [[media]]."""
    name = ""
    for part in location:
        name += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if name else str(part)
    return name


def _known_keys(model: type[BaseModel], location: Location) -> list[str]:
    """The keys of the table at `location`."""
    for part in location:
        if isinstance(part, int):
            continue
        found = next((f for name, f in model.model_fields.items() if part in (name, f.alias)), None)
        inner = table_of(found.annotation) if found else None
        if inner is None:
            return []
        model = inner
    return [field.alias or name for name, field in model.model_fields.items()]


def table_of(annotation: Any) -> type[BaseModel] | None:
    """The table type inside `annotation`: itself, or within `… | None`, `tuple[…, ...]`, Annotated."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if typing.get_origin(annotation) in (tuple, Union, types.UnionType, typing.Annotated):
        return next((t for a in typing.get_args(annotation) if (t := table_of(a))), None)
    return None
