"""Baked garments against their limits: `hall check --garments`.

limits: what a figure may be; measurement: the cheap figures measured again; quality: both against the bake's record.
"""

from hall_app.check.garments.limits import Worn
from hall_app.check.garments.measurement import Measured, cloth_in, measured_again
from hall_app.check.garments.quality import Line, figure_lines, garment_lines, garments_checked, table

__all__ = [
    "Line",
    "Measured",
    "Worn",
    "cloth_in",
    "figure_lines",
    "garment_lines",
    "garments_checked",
    "measured_again",
    "table",
]
