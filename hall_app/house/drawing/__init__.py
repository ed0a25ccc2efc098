"""Pictures that are brought, drawn anew; drawings as SVG, written anew of what of them draws.

Little is imported here: every process that reads a large drawing begins with it.
raster: pictures of pixels; elements: what is kept of an SVG's tree; styles: what values and style attributes say, by
tinycss2; sheets: what style sheets say; cost: how much it draws; dashes, outlines: what of that lies along lines.
"""

from hall_app.house.drawing.elements import redrawn
from hall_app.house.drawing.raster import drawn_anew
from hall_app.house.drawing.reading import redrawn_or_refused

__all__ = ["drawn_anew", "redrawn", "redrawn_or_refused"]
