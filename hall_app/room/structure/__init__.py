"""What follows from the plan alone.

regions: which ceiling is where; frame: the columns, and the beams they carry.
"""

from hall_app.room.structure.frame import beams_of
from hall_app.room.structure.regions import Regions

__all__ = ["Regions", "beams_of"]
