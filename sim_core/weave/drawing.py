"""A lit picture of a cloth from its maps (the last boxes of the paper's Fig. 1), for looking at a weave."""

import numpy as np

from sim_core.weave.geometry import TextureMaps

__all__ = ["lit_picture"]

LIGHT = np.array([-0.45, 0.55, 0.7])
SHINE = 14.0


def lit_picture(maps: TextureMaps, *, tiles: int = 1, backdrop: float = 0.08) -> np.ndarray:
    """Lambert and a soft highlight over a dark backdrop that shows through the gaps. Returns (n, m, 3) uint8.

    tiles: repeats in both directions, to see whether seams or patterns catch the eye.  backdrop: grey, 0 to 1.
    """
    light = LIGHT / np.linalg.norm(LIGHT)
    half = light + np.array([0.0, 0.0, 1.0])
    half /= np.linalg.norm(half)
    normal = maps.normal / 127.5 - 1
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    albedo = (maps.albedo / 255.0) ** 2.2
    diffuse = 0.25 + 0.85 * np.clip(normal @ light, 0, 1)
    shine = 0.16 * np.clip(normal @ half, 0, 1) ** SHINE
    cover = maps.opacity[..., None] / 255.0
    linear = cover * (albedo * diffuse[..., None] + shine[..., None]) + (1 - cover) * backdrop**2.2
    picture = np.rint(np.clip(linear, 0, 1) ** (1 / 2.2) * 255).astype(np.uint8)
    return np.tile(picture, (tiles, tiles, 1))
