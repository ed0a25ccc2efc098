"""The outline to mesh, from a JSON file of its own or from one piece of a pattern sheet."""

import warnings
from pathlib import Path
from typing import Any, NamedTuple

from sim_core.errors import FileProblem, OutlineWarning
from sim_core.mesh.outline.size_field import check_numbers
from sim_core.mesh.sheets.model import Sheet
from sim_core.mesh.sheets.reading import Choice, is_sheet, panel_of, read_sheet
from sim_core.validation.files import read_json, shown

__all__ = ["Drawing", "drawing_of", "read_outline"]


class Drawing(NamedTuple):
    """What an outline file holds: outline [m], holes and inner lines, as lists of [x, y] or arrays, y down."""

    outline: Any
    holes: list
    constraints: list


def read_outline(path: Path, choice: Choice | None = None, units: str | None = None) -> Drawing:
    """The outline, holes and inner lines of a JSON file or of one piece of a pattern sheet, metres, y down.

    JSON: {"outline": [[x, y], ...], "holes": [...], "constraints": [...]}. Sheets (SVG, DXF, GarmentCode): `choice`
    says which piece along which line, `units` what a drawing unit is; remarks are OutlineWarnings.
    Raises FileProblem (path: what – remedy) for a file that is missing, empty, of another kind or shape.
    """
    choice = choice or Choice()
    if is_sheet(path):
        return drawing_of(path, read_sheet(path, units, choice.layer), choice)
    shape = 'it must hold {"outline": [[x, y], ...], "holes": [...], "constraints": [...]} in metres'
    values = read_json(path, f"an outline file (JSON): {shape}")
    if not isinstance(values, dict) or "outline" not in values:
        raise FileProblem(f"{path}: outline: missing – {shape}")
    unknown = sorted(set(values) - {"outline", "holes", "constraints"})
    if unknown:
        raise FileProblem(f"{path}: {unknown[0][:80]}: unknown key – {shape}")
    for name in ("holes", "constraints"):
        if not isinstance(values.get(name, []), list):
            raise FileProblem(f"{path}: {name}: {shown(values[name])} – give a list of lists of [x, y]")
    check_numbers(path, "outline", values["outline"], "[x, y] in metres")
    for name, kind in (("holes", "hole"), ("constraints", "constraint")):
        for k, rows in enumerate(values.get(name, [])):
            check_numbers(path, f"{kind} {k}", rows, "[x, y] in metres")
    return Drawing(values["outline"], values.get("holes", []), values.get("constraints", []))


def drawing_of(path: Path, sheet: Sheet, choice: Choice) -> Drawing:
    """The piece of a sheet that is chosen; remarks are OutlineWarnings. Raises FileProblem."""
    piece, remark = panel_of(path, sheet, choice)
    for told in (*sheet.remarks, *filter(None, [remark])):
        warnings.warn(told, OutlineWarning, stacklevel=3)
    return Drawing(piece.cut, list(piece.holes), list(piece.lines))
