"""What surfaces look like: palette (colours, what glows), textures, lettering."""

from hall_app.room.surface.lettering import MissingFontError, Sheet, Writing, font_file, write
from hall_app.room.surface.palette import BACKDROPS, MATERIALS, linear
from hall_app.room.surface.textures import TEXTURES, texture

__all__ = [
    "BACKDROPS",
    "MATERIALS",
    "TEXTURES",
    "MissingFontError",
    "Sheet",
    "Writing",
    "font_file",
    "linear",
    "texture",
    "write",
]
