"""What the baker takes and gives: surfaces with charts, spots, the light map."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["LightError", "LightMap", "Sampling", "Spot", "Surfaces"]

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]


class LightError(ValueError):
    """Surfaces, spots or settings that no light can be computed for; the message is one line with the remedy."""


@dataclass(frozen=True, slots=True)
class Surfaces:
    """What light falls on: C charts, V vertices, F triangles. Raises LightError where a value cannot be used.

    vertices: (V, 3) float64 [m]; faces: (F, 3) int32, counter-clockwise from outside;
    chart: (F,) int32, the chart of each face, −1: none (it hides and reflects light, but gets no texels);
    chart_uv: (F, 3, 2) float64 [m], the corners unrolled within their chart, lengths kept, smallest 0;
    density: (C,) float64, texels per metre; albedo: (F, 3) float32, mean linear reflectance 0..1;
    emission: (F, 3) float32, linear radiosity of lamps (of their front only), 0: none;
    two_sided: (C,) bool, a sheet lit from both sides, which shows the mean of both.
    """

    vertices: Floats
    faces: NDArray[np.int32]
    chart: NDArray[np.int32]
    chart_uv: Floats
    density: Floats
    albedo: Singles
    emission: Singles
    two_sided: NDArray[np.bool_]

    def __post_init__(self) -> None:
        count, charts = len(self.faces), len(self.density)
        if not count or not len(self.vertices):
            raise LightError("light: surfaces: no triangles – give at least one face")
        shapes = {
            "vertices": (len(self.vertices), 3),
            "faces": (count, 3),
            "chart": (count,),
            "chart_uv": (count, 3, 2),
            "density": (charts,),
            "albedo": (count, 3),
            "emission": (count, 3),
            "two_sided": (charts,),
        }
        for name, shape in shapes.items():
            value = getattr(self, name)
            if np.shape(value) != shape:
                raise LightError(f"light: surfaces.{name}: shape {np.shape(value)} – give {shape}")
            if value.dtype.kind == "f" and not np.isfinite(value).all():
                row = int(np.argwhere(~np.isfinite(value))[0][0])
                raise LightError(f"light: surfaces.{name}[{row}]: not a finite number – mend the mesh there")
        self._check_ranges(charts)

    def _check_ranges(self, charts: int) -> None:
        """Indices inside, reflectances below one, lamps not negative."""
        ranges = {
            "faces": (0, len(self.vertices) - 1),
            "chart": (-1, charts - 1),
            "albedo": (0.0, 1.0),
            "emission": (0.0, np.inf),
        }
        for name, (low, high) in ranges.items():
            value = np.asarray(getattr(self, name))
            wrong = (value < low) | (value > high)
            if wrong.any():
                row = int(np.argwhere(wrong)[0][0])
                raise LightError(
                    f"light: surfaces.{name}[{row}]: {value[row]} – keep it between {low} and {high}"
                )
        if charts and float(np.min(self.density)) <= 0:
            row = int(np.argmin(self.density))
            raise LightError(
                f"light: surfaces.density[{row}]: {self.density[row]} – give texels per metre > 0"
            )


@dataclass(frozen=True, slots=True)
class Spot:
    """A small round lamp that shines into a cone. Raises LightError where a value cannot be used.

    position, towards: (3,) [m] where it hangs and what it looks at; colour: (3,) linear;
    power: light on a white surface at 1 m, facing it; cone: half angle [degrees] of full light;
    soft: degrees further out over which it fades to nothing; radius: [m] of the lamp, the softness of its shadows.
    """

    position: Floats
    towards: Floats
    colour: Floats
    power: float
    cone: float
    soft: float
    radius: float = 0.05

    def __post_init__(self) -> None:
        for name in ("position", "towards", "colour"):
            value = np.asarray(getattr(self, name), np.float64)
            if value.shape != (3,) or not np.isfinite(value).all():
                raise LightError(f"light: spot.{name}: {value.tolist()} – give three finite numbers")
            object.__setattr__(self, name, value)
        if float(np.linalg.norm(self.towards - self.position)) < 1e-9:
            raise LightError("light: spot.towards: the spot's own position – aim it at another place")
        if not (0 < self.cone and 0 <= self.soft and self.cone + self.soft < 90):
            raise LightError(
                f"light: spot.cone, soft: {self.cone}, {self.soft} – give degrees > 0, together below 90"
            )
        if not (0 <= self.power < np.inf and 0 <= self.radius < np.inf and float(self.colour.min()) >= 0):
            raise LightError("light: spot.power, radius, colour: negative or not finite – give values ≥ 0")


@dataclass(frozen=True, slots=True)
class Sampling:
    """How finely light is gathered. Raises LightError without a ray a pass.

    rays: per texel and pass; the first pass finds direct light, each further one adds a bounce; seed: of their
    directions; lamp_share: points drawn on lamps per ray (0: none).
    """

    rays: tuple[int, ...] = (36, 49, 324)
    seed: int = 0
    lamp_share: float = 1 / 3

    def __post_init__(self) -> None:
        if not self.rays or min(self.rays) < 1:
            raise LightError("light: sampling.rays: none – give at least one ray a pass")


@dataclass(frozen=True)
class LightMap:
    """Light on every chart.

    image: (H, W, 3) float32, linear irradiance / π: albedo × image is the picture before `gain`
    (on lamps their own glow is in it); shown: (H, W, 3) float32, image × gain with its highlights rolled off so that
    albedo × shown ≤ 1 except on lamps, which is what light_jpeg encodes;
    uv: (F, 3, 2) float32 in 0..1, v down as glTF has it (TEXCOORD_1),
    zeros where a face has no chart; covered: (H, W) bool, texels that some chart shows;
    gain: factor on the image that brings pale walls to their brightness;
    record: seconds, cpu_seconds, rays, texels, noise (root mean square, relative), misses, inside …
    """

    image: Singles
    shown: Singles
    uv: Singles
    covered: NDArray[np.bool_]
    gain: float
    record: dict[str, Any]
