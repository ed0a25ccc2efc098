"""Pictures as files: how large, and whether a browser can show them. Pillow reads them; a fault is one line."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["LARGEST", "PictureError", "in_eight_bits", "picture_fault", "picture_size"]

LARGEST = 8192  # [pixels] a side; beyond it graphics cards and Pillow's own guard refuse
FORMATS = {".jpg": "JPEG", ".jpeg": "JPEG", ".png": "PNG", ".webp": "WEBP", ".svg": "SVG"}
_SVG = "{http://www.w3.org/2000/svg}"


class PictureError(ValueError):
    """The bytes are no picture, or one too large to be opened."""


def picture_size(data: bytes) -> tuple[int, int]:
    """(width, height) [pixels] as the picture's head states it. Raises PictureError."""
    return _head(data)[1]


def in_eight_bits(picture: Image.Image) -> Image.Image:
    """Grey of sixteen bits, as archives scan it, in eight: Pillow shows all that is not nearly black as white."""
    if not picture.mode.startswith("I"):
        return picture
    _, most = picture.getextrema()
    if not isinstance(most, int | float) or most <= 255:
        return picture
    return picture.point(lambda value: value * (1.0 / 257.0))


def _head(data: bytes) -> tuple[str, tuple[int, int]]:
    from PIL import Image

    try:
        with warnings.catch_warnings():
            # Only the head is read here; who decodes looks at the size first.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(io.BytesIO(data)) as picture:
                return picture.format or "", picture.size
    except Image.DecompressionBombError as error:
        raise PictureError("it has more pixels than can be opened") from error
    except Exception as error:  # a reader of foreign files may fail in any way
        raise PictureError("it is no picture, or broken") from error


def picture_fault(path: Path) -> tuple[str, str] | None:
    """(what, fix) of a picture file no browser shows as it should, or None. Decodes the whole picture."""
    from PIL import Image

    try:
        data = path.read_bytes()
        if path.suffix.lower() == ".svg":
            return _drawing_fault(data)
        kind, size = _head(data)
    except OSError as error:
        return f"cannot be read ({error.strerror})", "check the file"
    except PictureError as error:
        return str(error), "export it again as JPEG, PNG or WebP"
    if max(size) > LARGEST:
        what = f"it has {size[0]} x {size[1]} pixels, at most {LARGEST} x {LARGEST}"
        return what, "scale it down"
    wanted = FORMATS.get(path.suffix.lower())
    if kind != wanted:
        return f"its name says {wanted}, but it is {kind}", "rename it by what it is, or export it again"
    try:
        with Image.open(io.BytesIO(data)) as picture:
            picture.load()
    except Exception as error:  # a decoder of foreign files may fail in any way
        return f"it is broken or cut off ({error})", "copy or export it again"
    return None


def _drawing_fault(data: bytes) -> tuple[str, str] | None:
    """The same of an SVG: it must be whole, and neither run anything nor ask for anything beyond itself."""
    from xml.etree import ElementTree

    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        return "it declares a document type, which may unfold without end", "export it again as plain SVG"
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        return f"it is broken or cut off ({error})", "copy or export it again"
    if root.tag != f"{_SVG}svg":
        return "it is no SVG", "export it again as SVG, or correct its name"
    for element in root.iter():
        called = [name for name in element.attrib if name.rpartition("}")[2].lower().startswith("on")]
        if element.tag in (f"{_SVG}script", f"{_SVG}foreignObject") or called:
            return "it holds a program, which the hall does not run", "remove scripts and on… attributes"
        links = [value for name, value in element.attrib.items() if name.rpartition("}")[2] == "href"]
        if any(not link.startswith(("#", "data:image/")) for link in links):
            return (
                "it asks for another file, which a picture cannot",
                "put what it shows into the file itself",
            )
    return None
