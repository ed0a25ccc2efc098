"""`simcore mesh SHEET --list` and `--pattern`: what a sheet holds, named, drawn or written as a pattern file."""

import argparse
import json
import sys
import warnings
from pathlib import Path
from unicodedata import combining, east_asian_width

import numpy as np

from sim_core.errors import FileProblem, OutlineError, OutlineWarning
from sim_core.mesh.files import write_picture
from sim_core.mesh.sheets.garment_code import GarmentCode, is_garment_code, read_garment_code
from sim_core.mesh.sheets.model import Piece, Sheet
from sim_core.mesh.sheets.pattern_file import code_of, write_pattern
from sim_core.mesh.sheets.picture import sheet_picture
from sim_core.mesh.sheets.reading import Choice, is_sheet, outline_along, read_sheet, sheet_of_code
from sim_core.validation.files import read_json

__all__ = ["run_sheet"]


def run_sheet(args: argparse.Namespace) -> int:
    """List the pieces of a sheet, draw them, write them as a pattern file; returns the exit status."""
    own = args.file.suffix.lower() == ".toml"
    if not own and not is_sheet(args.file):
        raise FileProblem(
            f"{args.file}: not a pattern sheet – give a .svg, .dxf or .toml, or a .json of GarmentCode"
        )
    code = args.pattern_code(args.file) if own else None
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", OutlineWarning)
        if code is None:
            sheet = read_sheet(args.file, args.units, args.layer)
        else:
            sheet = sheet_of_code(args.file, code, args.layer)
    remarks = [*(str(warning.message) for warning in told), *sheet.remarks, *sheet.notes]
    if args.pattern:
        remarks += _write(args, sheet, code)
    if args.picture:
        write_picture(args.picture, sheet_picture(sheet))
    for remark in remarks:
        sys.stderr.write(f"simcore mesh: {args.file}: {remark}\n")
    rows = [_row(piece) for piece in sheet.pieces]
    if args.json:
        held = {"pieces": rows, "left_out": sheet.left_out, "remarks": remarks}
        sys.stdout.write(json.dumps(held, indent=2, ensure_ascii=False) + "\n")
    elif args.list:
        sys.stdout.write(_table(args.file, rows) + "\n")
    return 0


def _write(args: argparse.Namespace, sheet: Sheet, code: GarmentCode | None) -> list[str]:
    """Write the pattern file; returns remarks. code: of a file that is one already."""
    remarks: list[str] = []
    chosen = args.piece or args.layer or args.allowance
    if code is not None and not chosen:
        pass
    elif is_garment_code(args.file) and not chosen:
        code = read_garment_code(args.file, read_json(args.file, "a pattern of GarmentCode (JSON)"))
    else:
        code = _code(
            args.file, sheet, Choice(args.piece, args.line, args.layer, args.allowance / 1000), remarks
        )
    return [*remarks, *write_pattern(args.pattern, code, args.edge)]


def _code(path: Path, sheet: Sheet, choice: Choice, remarks: list[str]) -> GarmentCode:
    """The pieces of a sheet as panels."""
    pieces = [piece for piece in sheet.pieces if choice.piece in (None, piece.name)]
    if not pieces:
        known = ", ".join(piece.name for piece in sheet.pieces)
        raise FileProblem(f"{path}: piece {choice.piece!r}: no such piece – pieces: {known}")
    outlines: dict[str, np.ndarray] = {}
    for piece in pieces:
        try:
            outlines[piece.name], remark = outline_along(piece, choice.line, choice.allowance)
        except OutlineError as error:
            raise FileProblem(f"{path}: {error}") from error
        remarks += [remark] if remark else []
        if piece.holes:
            remarks.append(
                f"piece {piece.name}: its {len(piece.holes)} holes are not written, a pattern file has none"
            )
    return code_of(outlines)


def _row(piece: Piece) -> dict:
    """What a list says of a piece; lengths in millimetres."""
    width, height = (1000 * np.ptp(piece.outline, axis=0)).round(1).tolist()
    grain = None
    if piece.grain is not None:
        along = piece.grain[1] - piece.grain[0]
        grain = round(float(np.degrees(np.arctan2(-along[1], along[0]))) % 180, 1)
    return {
        "piece": piece.name,
        "layer": piece.layer,
        "width_mm": width,
        "height_mm": height,
        "lines": [name for name, line in (("cut", piece.cut), ("sew", piece.sew)) if line is not None],
        "holes": len(piece.holes),
        "inner_lines": len(piece.lines),
        "notches": len(piece.notches),
        "grain_deg": grain,
        "on_fold": piece.fold is not None,
    }


def _wide(text: str) -> int:
    """Columns of a terminal: Chinese signs take two, accents that are put on letters none."""
    return sum(0 if combining(c) else 2 if east_asian_width(c) in "WF" else 1 for c in text)


def _plain(text: str) -> str:
    """A text on one line, without signs that command a terminal."""
    return "".join(sign if sign.isprintable() else "?" for sign in text)


def _table(path: Path, rows: list[dict]) -> str:
    """The list for people."""
    head = ("piece", "layer", "width", "height", "lines", "holes", "inner", "notches", "grain", "fold")
    cells = [
        (
            _plain(row["piece"]),
            _plain(row["layer"]) or "-",
            f"{row['width_mm']:.1f} mm",
            f"{row['height_mm']:.1f} mm",
            "+".join(row["lines"]),
            str(row["holes"]),
            str(row["inner_lines"]),
            str(row["notches"]),
            "-" if row["grain_deg"] is None else f"{row['grain_deg']:.0f} deg",
            "half" if row["on_fold"] else "-",
        )
        for row in rows
    ]
    widths = [max(_wide(line[k]) for line in (head, *cells)) for k in range(len(head))]
    lines = []
    for line in (head, *cells):
        padded = (text + " " * (wide - _wide(text)) for text, wide in zip(line, widths, strict=True))
        lines.append("  ".join(padded).rstrip())
    return "\n".join([f"{path}: {len(rows)} piece{'s' * (len(rows) != 1)}", *lines])
