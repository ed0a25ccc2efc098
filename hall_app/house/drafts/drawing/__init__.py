"""Drawings that are brought as SVG, written anew: of their elements, attributes and styles those that draw.

elements: what is kept of the tree; styles: what style sheets and attributes say, by tinycss2; cost: how much it draws.
"""

from hall_app.house.drafts.drawing.elements import redrawn

__all__ = ["redrawn"]
