"""Scans: dense meshes of things that exist, read, looked through, made coarse, painted anew.

scan: the value; files: GLB, PLY, OBJ; condition: what is broken in one; standing: in metres, upright; levels: coarser
meshes of measured deviation; texture: their pictures; model: the GLB. Names are handed out when they are asked for
(PEP 562), so that whoever looks for a scan's files compiles nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim_core.mesh.scan.condition import Condition, cleaned, largest_part
    from sim_core.mesh.scan.files import ENDINGS, LARGEST, read_scan, scan_companions
    from sim_core.mesh.scan.levels import Chosen, Deviation, Fine, Level, chosen_level, coarsened
    from sim_core.mesh.scan.model import scan_glb
    from sim_core.mesh.scan.scan import MOST_TRIANGLES, Progress, Scan, ScanError
    from sim_core.mesh.scan.standing import UPWARDS, Upwards, stood
    from sim_core.mesh.scan.texture import Colours, Layout, laid_out, painted

__all__ = [
    "ENDINGS",
    "LARGEST",
    "MOST_TRIANGLES",
    "UPWARDS",
    "Chosen",
    "Colours",
    "Condition",
    "Deviation",
    "Fine",
    "Layout",
    "Level",
    "Progress",
    "Scan",
    "ScanError",
    "Upwards",
    "chosen_level",
    "cleaned",
    "coarsened",
    "laid_out",
    "largest_part",
    "painted",
    "read_scan",
    "scan_companions",
    "scan_glb",
    "stood",
]

_HOME = {
    **dict.fromkeys(("Condition", "cleaned", "largest_part"), "condition"),
    **dict.fromkeys(("ENDINGS", "LARGEST", "read_scan", "scan_companions"), "files"),
    **dict.fromkeys(("Chosen", "Deviation", "Fine", "Level", "chosen_level", "coarsened"), "levels"),
    "scan_glb": "model",
    **dict.fromkeys(("MOST_TRIANGLES", "Progress", "Scan", "ScanError"), "scan"),
    **dict.fromkeys(("UPWARDS", "Upwards", "stood"), "standing"),
    **dict.fromkeys(("Colours", "Layout", "laid_out", "painted"), "texture"),
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
