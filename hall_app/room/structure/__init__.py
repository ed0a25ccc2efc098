"""What follows from the plan alone.

regions: which ceiling is where; frame: the columns, and the beams they carry.
"""

from hall_app.room.structure.frame import JOIST, Beam, Column, beams_of, columns_of
from hall_app.room.structure.regions import Region, Regions, bay_height

__all__ = [
    "JOIST",
    "Beam",
    "Column",
    "Region",
    "Regions",
    "bay_height",
    "beams_of",
    "columns_of",
]
