"""The light map's charts: packing, side by side; texels, the places in them; filters, what is done within each."""

from hall_app.light.atlas.filters import fill, frame_charts, frame_numbers, smooth
from hall_app.light.atlas.packing import BORDER, Atlas, atlas_of, pack
from hall_app.light.atlas.texels import Places, places_of

__all__ = [
    "BORDER",
    "Atlas",
    "Places",
    "atlas_of",
    "fill",
    "frame_charts",
    "frame_numbers",
    "pack",
    "places_of",
    "smooth",
]
