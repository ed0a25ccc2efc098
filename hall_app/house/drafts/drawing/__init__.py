"""Drawings that are brought as SVG, written anew: of their elements, attributes and styles those that draw.

elements: what is kept of the tree; styles: what values and style attributes say, by tinycss2; sheets: what style sheets
say; cost: how much it draws; dashes, outlines: what of that lies along lines.
"""

from hall_app.house.drafts.drawing.elements import redrawn

__all__ = ["redrawn"]
