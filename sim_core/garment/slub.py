"""A tileable slub relief: what remains of a silk's weave seen from a few steps away."""

from __future__ import annotations

import numpy as np


def slub_normal(pixels: int, *, depth: float = 1.2, seed: int = 7) -> np.ndarray:
    """Normal map (n, n, 3) uint8 of threads that swell here and there, along u mostly; periodic both ways."""
    rng = np.random.default_rng(seed)
    frequency = np.fft.fftfreq(pixels, 1 / pixels)
    u, v = np.meshgrid(frequency, frequency)

    def noise(along: float, across: float) -> np.ndarray:
        window = np.exp(-((u / along) ** 2) - (v / across) ** 2) * (1 - np.exp(-(u**2 + v**2) / 4))
        field = np.fft.ifft2(np.fft.fft2(rng.standard_normal((pixels, pixels))) * window).real
        return field / field.std()

    height = noise(5, 42) + 0.45 * noise(42, 5) + 0.25 * noise(60, 60)
    du = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / 2
    dv = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) / 2
    normal = np.stack([-depth * du, depth * dv, np.ones_like(height)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.round(127.5 + 127.5 * normal).astype(np.uint8)
