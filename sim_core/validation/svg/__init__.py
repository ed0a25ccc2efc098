"""SVG drawings from outside as polylines: pattern sheets and motifs are read by one reader.

`tree` decodes a file, bounds its entities, depth and `<use>`, and turns nested viewports into groups; `shapes` makes
polylines of what is drawn.
"""

from sim_core.validation.svg.shapes import PIXEL, curves_of, drawing_of, polylines
from sim_core.validation.svg.tree import (
    LENGTHS,
    MOST_VISITED,
    NUMBER,
    check_bounds,
    left_out_of,
    svg_root,
    told,
)

__all__ = [
    "LENGTHS",
    "MOST_VISITED",
    "NUMBER",
    "PIXEL",
    "check_bounds",
    "curves_of",
    "drawing_of",
    "left_out_of",
    "polylines",
    "svg_root",
    "told",
]
