"""Tiling pictures of the room's materials, made from filtered noise."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["TEXTURES", "texture"]

Floats = NDArray[Any]
SIZE = 512  # [pixels]


def texture(name: str, colour: str, *, seed: int = 11) -> NDArray[np.uint8]:
    """(512, 512, 3) uint8 sRGB: the texture of that name, its mean the colour "#rrggbb"; u runs along the grain."""
    shade = TEXTURES[name](np.random.default_rng([seed, *name.encode()]))
    base = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)], float)
    picture = base * shade if shade.ndim == 3 else base * shade[..., None]
    picture *= base / np.maximum(picture.mean((0, 1)), 1e-6)
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)


def noise(rng: np.random.Generator, along: float, across: float) -> Floats:
    """(512, 512) tiling Gaussian noise of unit deviation, blurred by that many pixels along u and across."""
    white = np.fft.fft2(rng.standard_normal((SIZE, SIZE)))
    f = np.fft.fftfreq(SIZE)
    weight = np.exp(-2 * np.pi**2 * ((f[None, :] * along) ** 2 + (f[:, None] * across) ** 2))
    field = np.fft.ifft2(white * weight).real
    field -= field.mean()
    return field / field.std()


def _plaster(rng: np.random.Generator) -> Floats:
    """Troweled lime: ±1 %, no more, or it reads as marble."""
    return 1 + 0.0055 * noise(rng, 46, 30) + 0.004 * noise(rng, 9, 5) + 0.0045 * noise(rng, 1.1, 1.1)


def _stone(rng: np.random.Generator) -> Floats:
    pits = np.minimum(noise(rng, 1.6, 1.6) + 1.4, 0)
    return (
        1 + 0.022 * noise(rng, 40, 24) + 0.025 * noise(rng, 3, 3) + 0.03 * noise(rng, 0.8, 0.8) + 0.10 * pits
    )


def _tiles(rng: np.random.Generator) -> Floats:
    """Four by four square tiles with narrow joints, each a little lighter or darker, bevelled by wear."""
    tile = SIZE // 4
    tone = 0.022 * rng.standard_normal((4, 4))
    shade = 1 + np.kron(tone, np.ones((tile, tile)))
    shade += 0.012 * noise(rng, 30, 30) + 0.012 * noise(rng, 5, 5) + 0.018 * noise(rng, 1.0, 1.0)
    shade += 0.05 * np.minimum(noise(rng, 1.5, 1.5) + 1.7, 0)
    at = np.arange(SIZE) % tile
    away = np.minimum(at, tile - at).astype(float)  # pixels to the nearest joint's middle
    rim = np.minimum(away[None, :], away[:, None])
    shade *= 1 - 0.46 * np.exp(-((rim / 1.25) ** 2)) - 0.05 * np.exp(-((rim / 5.0) ** 2))
    return shade


def _grain(rng: np.random.Generator, strength: float) -> Floats:
    """Long fibres, growth rings that wander, pores."""
    wander = 2.2 * noise(rng, 130, 40)
    v = np.arange(SIZE)[:, None] / SIZE
    rings = np.sin(2 * np.pi * (7 * v) + wander) * 0.5 + np.sin(2 * np.pi * (17 * v) + 1.7 * wander) * 0.3
    fibre = noise(rng, 26, 1.3)
    pores = np.minimum(noise(rng, 11, 0.7) + 1.5, 0)
    return 1 + strength * (0.55 * rings + 0.75 * fibre + 0.45 * noise(rng, 90, 8) + 0.9 * pores)


def _warm(shade: Floats, amount: float) -> Floats:
    """(H, W, 3): where wood is darker it is redder as well."""
    return shade[..., None] ** (1 + amount * np.array([-0.3, 0.1, 0.35]))


def _wood(rng: np.random.Generator) -> Floats:
    return _warm(_grain(rng, 0.085), 0.8)


def _lacquer(rng: np.random.Generator) -> Floats:
    return _warm(_grain(rng, 0.040) + 0.015 * noise(rng, 60, 40)[...], 0.5)


def _planked(rng: np.random.Generator, count: int, strength: float, gap: float) -> Floats:
    """Boards along u, each of its own tone and grain, dark joints between them."""
    high = SIZE // count
    grain = _grain(rng, strength)
    shade = np.ones((SIZE, SIZE))
    for k in range(count):
        rows = slice(k * high, (k + 1) * high)
        shade[rows] = np.roll(grain[rows], int(rng.integers(SIZE)), axis=1) + 0.05 * rng.standard_normal()
    at = np.arange(SIZE) % high
    away = np.minimum(at, high - at)[:, None].astype(float)
    shade *= 1 - gap * np.exp(-((away / 1.2) ** 2)) - 0.10 * np.exp(-((away / 4.0) ** 2))
    return _warm(shade, 0.8)


def _boards(rng: np.random.Generator) -> Floats:
    return _planked(rng, 8, 0.075, 0.55)


def _panel(rng: np.random.Generator) -> Floats:
    return _planked(rng, 4, 0.075, 0.45)


def _cloth(rng: np.random.Generator) -> Floats:
    """A plain weave with slubs: threads a few pixels wide, some of them thicker."""
    threads = noise(rng, 24, 0.9) + noise(rng, 0.9, 24)
    at = np.arange(SIZE)
    weave = np.sin(2 * np.pi * at / 4)[None, :] * np.sin(2 * np.pi * at / 4)[:, None]
    return 1 + 0.020 * threads + 0.016 * weave + 0.006 * noise(rng, 70, 70)


def _paper(rng: np.random.Generator) -> Floats:
    """Mulberry paper against the light: long fibres, faint clouds."""
    fibres = np.minimum(noise(rng, 14, 0.8) + 2.0, 0) + np.minimum(noise(rng, 0.8, 14) + 2.0, 0)
    return 1 + 0.010 * noise(rng, 60, 60) + 0.03 * fibres + 0.006 * noise(rng, 2, 2)


def _lantern(rng: np.random.Generator) -> Floats:
    """Paper on bamboo ribs (two to a tile), brightest round the flame a little above the middle."""
    u, v = np.arange(SIZE)[None, :] / SIZE, np.arange(SIZE)[:, None] / SIZE
    rib = np.abs((2 * u + 0.5) % 1 - 0.5) * 2  # 0 on a rib, 1 between
    glow = 0.80 + 0.24 * np.exp(-(((v - 0.46) / 0.30) ** 2))
    shade = glow * (0.86 + 0.14 * np.sqrt(np.sin(np.pi / 2 * rib)))
    shade = shade * (1 + 0.008 * noise(rng, 20, 20))
    warm = np.clip(1.12 - shade, 0, 1)[..., None]
    return shade[..., None] * (1 - warm * np.array([0.0, 0.25, 0.7]))


TEXTURES: dict[str, Callable[[np.random.Generator], Floats]] = {
    "plaster": _plaster,
    "stone": _stone,
    "tiles": _tiles,
    "wood": _wood,
    "lacquer": _lacquer,
    "boards": _boards,
    "panel": _panel,
    "cloth": _cloth,
    "paper": _paper,
    "lantern": _lantern,
}
