"""Pattern sheets: the pieces of SVG, DXF and GarmentCode files."""

from sim_core.mesh.sheets.garment_code import CodeEdge, CodePanel, GarmentCode, Stitch, read_garment_code
from sim_core.mesh.sheets.model import Piece, Sheet
from sim_core.mesh.sheets.reading import Choice, panel_of, read_sheet

__all__ = [
    "Choice",
    "CodeEdge",
    "CodePanel",
    "GarmentCode",
    "Piece",
    "Sheet",
    "Stitch",
    "panel_of",
    "read_garment_code",
    "read_sheet",
]
