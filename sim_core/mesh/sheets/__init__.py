"""Pattern sheets: the pieces of SVG, DXF and GarmentCode files.

`strokes` reads lines and the names around them, `contours` and `sorting` make pieces (`model`) of these, `reading` is
the door and `outline_file` what `simcore mesh` takes. `garment_code` holds that format, `pattern_file` writes it and
our TOML with `legs`; `picture` draws a sheet, `command` lists it.
"""

from sim_core.mesh.sheets.garment_code import CodeEdge, CodePanel, GarmentCode, Stitch, read_garment_code
from sim_core.mesh.sheets.legs import cubic_through
from sim_core.mesh.sheets.model import Piece, Sheet
from sim_core.mesh.sheets.outline_file import read_outline
from sim_core.mesh.sheets.pattern_file import toml_text
from sim_core.mesh.sheets.picture import apart, sheet_picture
from sim_core.mesh.sheets.reading import Choice, panel_of, read_sheet

__all__ = [
    "Choice",
    "CodeEdge",
    "CodePanel",
    "GarmentCode",
    "Piece",
    "Sheet",
    "Stitch",
    "apart",
    "cubic_through",
    "panel_of",
    "read_garment_code",
    "read_outline",
    "read_sheet",
    "sheet_picture",
    "toml_text",
]
