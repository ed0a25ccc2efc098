"""Contours of a panel, checked and sampled.

`crossings` finds where they meet, `contours` what may be meshed (`touching_holes` become part of the outline),
`inner_lines` what edges must follow; `samples` makes the steps of all of them, as long as a `size_field` wants.
"""

from sim_core.mesh.outline.contours import (
    CORNER_DEGREES,
    check_count,
    check_edge,
    clean_contours,
    cleaned_contours,
    outline_turning,
    sharpest_corner,
    signed_area,
)
from sim_core.mesh.outline.crossings import close_contours, crossed_steps, enclosing, first_crossing
from sim_core.mesh.outline.inner_lines import clean_lines
from sim_core.mesh.outline.samples import Rim, sampled_contours, sampled_rim
from sim_core.mesh.outline.size_field import SizeField, read_size_field

__all__ = [
    "CORNER_DEGREES",
    "Rim",
    "SizeField",
    "check_count",
    "check_edge",
    "clean_contours",
    "clean_lines",
    "cleaned_contours",
    "close_contours",
    "crossed_steps",
    "enclosing",
    "first_crossing",
    "outline_turning",
    "read_size_field",
    "sampled_contours",
    "sampled_rim",
    "sharpest_corner",
    "signed_area",
]
