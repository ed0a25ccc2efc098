"""Pictures of a scan, decoded: together no more pixels than a texture of ours can use."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np

from sim_core.mesh.scan.scan import ScanError

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["decoded", "plain"]

MOST = 16384  # [pixels] a side that is opened
ALL = 64_000_000  # [pixels] kept of all pictures together: three bytes each


def decoded(data: bytes, name: str, share: float = 1.0) -> np.ndarray:
    """(H, W, 3) uint8 sRGB of an encoded picture, scaled down to its share of what all may hold. Raises ScanError."""
    from PIL import Image

    try:
        with _opened(data) as picture:
            if max(picture.size) > MOST:
                what = f"its picture {name} has {picture.size[0]} x {picture.size[1]} pixels, at most {MOST} a side"
                raise ScanError(what, "scale it down and keep its name")
            most, many = share * ALL, picture.size[0] * picture.size[1]
            if many <= most:
                return np.array(picture.convert("RGB"))
            less = (most / many) ** 0.5
            size = (max(1, int(picture.size[0] * less)), max(1, int(picture.size[1] * less)))
            picture.draft("RGB", size)  # of a JPEG no more is decoded than is needed
            whole = picture if picture.mode == "RGB" else picture.convert("RGB")
            return np.array(whole.resize(size, Image.Resampling.BOX))
    except ScanError:
        raise
    except Exception as error:  # a decoder of foreign files may fail in any way
        raise ScanError(
            f"its picture {name} cannot be read, or is cut off", "copy or export it again"
        ) from error


def _opened(data: bytes) -> Image.Image:
    """A picture of which only the head was read. Pillow's own limit is less than scanners write, and ours is looked at
    before anything is decoded."""
    from PIL import Image

    kept, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
    try:
        return Image.open(io.BytesIO(data))
    finally:
        Image.MAX_IMAGE_PIXELS = kept


def plain(linear: np.ndarray) -> np.ndarray:
    """(1, 1, 3) uint8: a picture of one colour (3,) in linear light."""
    value = np.clip(linear, 0, 1)
    srgb = np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)
    return np.rint(255 * srgb).astype(np.uint8).reshape(1, 1, 3)
