"""Lines of a drawing with the names around them, before anyone says what they are.

`svg` names lines of drawings that `sim_core.validation.svg` reads, `dxf` what ezdxf reads; both give a `stroke` its
`words`.
"""

from sim_core.mesh.sheets.strokes.dxf import dxf_strokes
from sim_core.mesh.sheets.strokes.joining import joined
from sim_core.mesh.sheets.strokes.stroke import Drawn, Stroke
from sim_core.mesh.sheets.strokes.svg import svg_strokes

__all__ = ["Drawn", "Stroke", "dxf_strokes", "joined", "svg_strokes"]
