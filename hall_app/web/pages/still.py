"""The still picture behind the door until the hall itself is drawn: what the room's environment shows of the view."""

from __future__ import annotations

import io
import math
from functools import lru_cache

__all__ = ["still_jpeg"]

WIDTH, HEIGHT = 192, 108
ACROSS = math.radians(112)  # wider than the first view, whose edges a tall window cuts
BLUR = 3.5  # [pixels] enough to hide that it is small
QUALITY = 60


@lru_cache(maxsize=2)
def still_jpeg(environment: bytes, yaw: float) -> bytes:
    """A JPEG of some 3 kB looking along `yaw` [rad], 0 = -z, out of an equirectangular JPEG of the room."""
    import numpy as np
    from PIL import Image, ImageFilter

    around = np.asarray(Image.open(io.BytesIO(environment)).convert("RGB"), np.float64)
    height, width, _ = around.shape
    half = math.tan(ACROSS / 2)
    right, up = np.meshgrid(
        half * (2 * (np.arange(WIDTH) + 0.5) / WIDTH - 1),
        half * HEIGHT / WIDTH * (1 - 2 * (np.arange(HEIGHT) + 0.5) / HEIGHT),
    )
    x = right * math.cos(yaw) - math.sin(yaw)
    z = -right * math.sin(yaw) - math.cos(yaw)
    # As three.js reads it: u = atan2(z, x) / 2π + 1/2, v from the top.
    column = (np.arctan2(z, x) / (2 * math.pi) + 0.5) * width
    row = (0.5 - np.arctan2(up, np.hypot(x, z)) / math.pi) * height
    seen = around[np.clip(row.astype(int), 0, height - 1), column.astype(int) % width]
    picture = Image.fromarray(seen.astype(np.uint8)).filter(ImageFilter.GaussianBlur(BLUR))
    out = io.BytesIO()
    picture.save(out, "JPEG", quality=QUALITY, optimize=True)
    return out.getvalue()
