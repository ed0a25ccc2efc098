"""A pattern sheet from a file, and what of it is to be meshed."""

from __future__ import annotations

import warnings
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
import shapely

from sim_core.errors import FileProblem, OutlineError, OutlineWarning
from sim_core.mesh.outline.contours import LARGEST
from sim_core.mesh.sheets.allowance import moved_outline
from sim_core.mesh.sheets.garment_code import GarmentCode, code_sheet, is_garment_code, read_garment_code
from sim_core.mesh.sheets.model import Piece, Sheet, Which
from sim_core.mesh.sheets.pieces import SCRIBBLES, sorted_sheet
from sim_core.mesh.sheets.strokes.dxf import dxf_strokes
from sim_core.mesh.sheets.strokes.svg import svg_strokes
from sim_core.validation.files import read_json

__all__ = ["UNITS", "Choice", "is_sheet", "panel_of", "read_sheet", "sheet_of_code"]

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "pt": 0.0254 / 72, "px": 0.0254 / 96}
SHOWN = 12  # names in a message
SMALL, LARGE = 0.02, 10.0  # [m] a sheet's largest piece is hardly beyond
MOST_NAMED = 8


@dataclass(frozen=True)
class Choice:
    """What of a sheet is wanted. piece: its name.  line: along which it is meshed.  layer: pieces of that layer or
    material only.  allowance: [m] between cutting and sewing line where the sheet draws one of them only."""

    piece: str | None = None
    line: Which = "cut"
    layer: str | None = None
    allowance: float = 0.0


def is_sheet(path: Path) -> bool:
    """Whether a file is a pattern sheet: a drawing, or JSON of GarmentCode."""
    return path.suffix.lower() in (".svg", ".dxf") or is_garment_code(path)


def read_sheet(path: Path, units: str | None = None, layer: str | None = None) -> Sheet:
    """The pieces of an SVG, DXF or GarmentCode file; units: of a drawing unit, one of `UNITS`.

    What is left out is told in an OutlineWarning. Raises FileProblem for a file without a piece.
    """
    metres = UNITS[units] if units else None
    if path.suffix.lower() not in (".svg", ".dxf"):
        code = read_garment_code(path, read_json(path, "a pattern of GarmentCode (JSON)"))
        return sheet_of_code(path, code, layer)
    drawn = (svg_strokes if path.suffix.lower() == ".svg" else dxf_strokes)(path, metres)
    for stroke in drawn.strokes:
        if not (np.abs(stroke.points) <= LARGEST).all():  # false for NaN too
            raise FileProblem(
                f"{path}: a line leaves the range of {LARGEST:g} m – draw it nearer to the origin, or say --units"
            )
    try:
        sheet = sorted_sheet(drawn.strokes, apparel=drawn.apparel, layer=layer or "")
        if layer and not _lying_on(sheet, layer):
            sheet = sorted_sheet(drawn.strokes, apparel=drawn.apparel)  # names the layers that there are
    except OutlineError as error:
        raise FileProblem(f"{path}: {error}") from error
    except (shapely.errors.ShapelyError, ValueError) as error:
        raise FileProblem(
            f"{path}: its lines cannot be sorted ({error}) – draw plain closed outlines"
        ) from error
    if not sheet.pieces:
        what, remedy = _lacking(sheet)
        raise FileProblem(f"{path}: {what} – {remedy}")
    left_out = +(drawn.left_out + Counter(sheet.left_out))
    _warn_left_out(path, left_out)
    remarks, notes = (*drawn.remarks, *sheet.remarks), (*drawn.notes, *_noted(sheet))
    return _on(path, replace(sheet, left_out=dict(left_out), remarks=remarks, notes=notes), layer)


def _lacking(sheet: Sheet) -> tuple[str, str]:
    """What a sheet without pieces has instead of them, and what to do about it."""
    if "closed lines of less than 2 mm" in sheet.left_out:
        return "only closed lines of less than 2 mm", "say what a drawing unit is, such as --units in"
    if SCRIBBLES in sheet.left_out:
        return f"only {SCRIBBLES}", "draw outlines that go around once"
    return "no closed line in it that may be a piece", "close the outline"


def _noted(sheet: Sheet) -> list[str]:
    """What may be wrong with a sheet that can be read."""
    widest = max(float(np.ptp(piece.outline, axis=0).max()) for piece in sheet.pieces)
    found = []
    if not SMALL <= widest <= LARGE:
        size = f"{1000 * widest:.0f} mm" if widest < 1 else f"{widest:.0f} m"
        found.append(
            f"its largest piece measures {size} – if that is wrong, say what a drawing unit is with --units"
        )
    halves = [piece.name for piece in sheet.pieces if piece.fold is not None]
    if halves:
        named = ", ".join(halves[:SHOWN]) + (", …" if len(halves) > SHOWN else "")
        found.append(f"to be cut on the fold, half of it is drawn: {named}")
    return found


def sheet_of_code(path: Path, code: GarmentCode, layer: str | None = None) -> Sheet:
    """The panels of a specification as pieces; raises FileProblem where none is on the layer."""
    return _on(path, code_sheet(code), layer)


def _on(path: Path, sheet: Sheet, layer: str | None) -> Sheet:
    """The pieces on one layer; raises FileProblem where there are none."""
    if layer is None:
        return sheet
    found = _lying_on(sheet, layer)
    if not found:
        known = sorted({piece.layer or "none" for piece in sheet.pieces})
        raise FileProblem(f"{path}: layer {layer!r}: no piece on it – layers: {', '.join(known[:SHOWN])}")
    return replace(sheet, pieces=found)


def _lying_on(sheet: Sheet, layer: str) -> tuple[Piece, ...]:
    return tuple(piece for piece in sheet.pieces if piece.layer.lower() == layer.lower())


def panel_of(path: Path, sheet: Sheet, choice: Choice) -> tuple[Piece, str]:
    """The piece chosen, its `cut` the outline to mesh and lines and holes inside it, and a remark or "".

    Raises FileProblem where the name is unknown, or missing while the sheet has several pieces.
    """
    names = [piece.name for piece in sheet.pieces]
    shown = ", ".join(names[:SHOWN]) + (", …" if len(names) > SHOWN else "")
    if choice.piece is None and len(names) > 1:
        raise FileProblem(f"{path}: {len(names)} pieces – choose one with --piece NAME: {shown}")
    if choice.piece is not None and choice.piece not in names:
        raise FileProblem(f"{path}: piece {choice.piece!r}: no such piece – pieces: {shown}")
    piece = sheet.pieces[names.index(choice.piece) if choice.piece is not None else 0]
    try:
        outline, remark = outline_along(piece, choice.line, choice.allowance)
    except OutlineError as error:
        raise FileProblem(f"{path}: {error}") from error
    holes = tuple(hole for hole in piece.holes if shapely.Polygon(hole).is_valid)
    lines, cut = _clipped(outline, holes, piece.lines)
    told = [remark] if remark else []
    if lost := len(piece.holes) - len(holes):
        told.append(f"{lost} holes cross themselves and are left out")
    if cut:
        told.append(f"{cut} inner lines are cut off where they leave the cloth")
    return replace(piece, cut=outline, sew=None, holes=holes, lines=lines), "; ".join(told)


def outline_along(piece: Piece, line: Which, allowance: float) -> tuple[np.ndarray, str]:
    """The cutting or the sewing line of a piece (n, 2) [m], and a remark where the other one serves for it.

    allowance: [m]; where only one of the two is drawn, the cutting line lies so far outside it, the sewing line inside.
    Raises OutlineError where nothing is left, or several parts.
    """
    drawn = piece.cut if line == "cut" else piece.sew
    other: Literal["cut", "sew"] = "sew" if line == "cut" else "cut"
    if drawn is not None and not (allowance and line == "cut" and piece.sew is None):
        left = (
            f"piece {piece.name}: its {line} line is drawn, --allowance changes nothing" if allowance else ""
        )
        return drawn, left
    if not allowance:
        return (
            piece.outline,
            f"piece {piece.name}: only its {other} line is drawn, taken for its {line} line too",
        )
    try:
        return moved_outline(piece.outline, allowance if line == "cut" else -allowance), ""
    except OutlineError as error:
        raise OutlineError(f"piece {piece.name}: {error}") from error


def _clipped(
    outline: np.ndarray, holes: tuple[np.ndarray, ...], lines: tuple[np.ndarray, ...]
) -> tuple[tuple[np.ndarray, ...], int]:
    """Inner lines within an outline and outside its holes, and how many had to be cut."""
    shape = shapely.Polygon(outline)
    if not shape.is_valid or not lines:
        return lines, 0
    for hole in holes:
        shape = shapely.difference(shape, shapely.Polygon(hole))
    found: list[np.ndarray] = []
    cut = 0
    grown = shapely.buffer(shape, 1e-9)
    for line in lines:
        whole = shapely.LineString(line)
        if grown.covers(whole):
            found.append(line)
            continue
        cut += 1
        for part in shapely.get_parts(shapely.intersection(whole, shape)):
            if isinstance(part, shapely.LineString) and part.length > 1e-3:
                found.append(np.array(part.coords))
    return tuple(found), cut


def _warn_left_out(path: Path, found: Counter[str]) -> None:
    """Warn of what was left out (name: how often), the most frequent first, if there is anything."""
    if not found:
        return
    named = [f"{count} {what[:40]}" for what, count in found.most_common(MOST_NAMED)]
    more = ["more"] if len(found) > MOST_NAMED else []
    warnings.warn(f"left out of {path.name}: {', '.join(named + more)}", OutlineWarning, stacklevel=2)
