"""What surfaces look like: palette (colours, what glows), textures, lettering."""

from hall_app.room.surface.lettering import (
    SCROLLS,
    MissingFontError,
    Sheet,
    Writing,
    font_file,
    letter_size,
    shrunk,
    write,
)
from hall_app.room.surface.palette import BACKDROPS, MATERIALS, linear
from hall_app.room.surface.textures import TEXTURES, texture

__all__ = [
    "BACKDROPS",
    "MATERIALS",
    "SCROLLS",
    "TEXTURES",
    "MissingFontError",
    "Sheet",
    "Writing",
    "font_file",
    "letter_size",
    "linear",
    "shrunk",
    "texture",
    "write",
]
