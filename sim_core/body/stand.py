"""What dress hangs on: a stand (yihang, 衣桁) of two turned posts with a round bar across, or a T-bar through both
sleeves, as collider and as mesh."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sim_core.cloth import Box, Capsule, Cylinder, HalfSpace, Solid, Union
from sim_core.cloth.contact.solid_meshes import solid_mesh
from sim_core.errors import SimCoreError

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Stand:
    """Sizes in metres: the bar's axis runs along x at `height`, the floor is y = 0, front is +z.

    bar_radius: what the cloth lies on; span: distance of the posts; overhang: bar beyond each post;
    upturn: how far the bar's ends rise.
    """

    height: float = 1.5
    span: float = 0.70
    bar_radius: float = 0.017
    post_radius: float = 0.016
    overhang: float = 0.13
    upturn: float = 0.035
    rail: float = 0.17

    def __post_init__(self) -> None:
        for name in ("height", "span", "bar_radius", "post_radius", "overhang", "rail"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise SimCoreError(f"stand.{name}: {getattr(self, name)} – must be a length above 0 [m]")

    def parts(self) -> tuple[Solid, ...]:
        """Every solid of the stand; what is collided with is exactly what is shown."""
        h, x, r = self.height, self.span / 2, self.bar_radius
        parts: list[Solid] = [Capsule((-x - 0.05, h, 0.0), (x + 0.05, h, 0.0), r)]
        for side in (-1.0, 1.0):
            parts += self._post(side * x)
            near, far = side * (x + 0.05), side * (x + self.overhang)
            tip = (far, h + self.upturn, 0.0)
            parts += [Capsule((near, h, 0.0), tip, r * 0.92), Capsule(tip, tip, r * 1.35)]
        parts.append(Capsule((-x, self.rail, 0.0), (x, self.rail, 0.0), r * 0.75))
        return tuple(parts)

    def _post(self, x: float) -> list[Solid]:
        """A foot, a turned post with rings, and the saddle under the bar."""
        r, top = self.post_radius, self.height

        def ring(y: float, radius: float, height: float) -> Cylinder:
            return Cylinder((x, y - height / 2, 0.0), (x, y + height / 2, 0.0), radius, 0.45 * height)

        return [
            Box((x, 0.024, 0.0), (0.062, 0.048, 0.44), 0.012),
            Box((x, 0.062, 0.0), (0.05, 0.03, 0.26), 0.012),
            Cylinder((x, 0.07, 0.0), (x, 0.115, 0.0), r * 1.75, 0.012),
            Capsule((x, 0.08, 0.0), (x, top, 0.0), r),
            ring(0.128, r * 1.45, 0.014),
            ring(self.rail, r * 1.5, 0.05),
            ring(top - 0.145, r * 1.3, 0.012),
            ring(top - 0.105, r * 1.5, 0.03),
            ring(top - 0.066, r * 1.3, 0.012),
        ]

    def to_dict(self) -> dict[str, Any]:
        """A plain dictionary that JSON can hold; `stand_of` reads it."""
        return asdict(self)

    def collider(self) -> Union:
        """The stand and the floor as one solid with exact distance."""
        return Union((*self.parts(), HalfSpace((0.0, 0.0, 0.0), (0.0, 1.0, 0.0))))

    def mesh(self, segments: int = 28) -> tuple[np.ndarray, np.ndarray]:
        """Closed display mesh, vertices (V, 3) [m] and faces (F, 3): one component per part, overlapping."""
        vertices, faces, count = [], [], 0
        for part in self.parts():
            v, f = solid_mesh(part, segments)
            vertices.append(v)
            faces.append(f + count)
            count += len(v)
        return np.concatenate(vertices), np.concatenate(faces).astype(np.int32)


@dataclass(frozen=True)
class TBar(Stand):
    """A post with a bar across, as museums spread a robe: the bar goes through both sleeves, `span` [m] from end to
    end; the post and its foot are hidden by what hangs there. overhang, upturn and rail are not used."""

    span: float = 1.8
    bar_radius: float = 0.02
    post_radius: float = 0.018

    def parts(self) -> tuple[Solid, ...]:
        """The bar with its end knobs, the post, and a cross of two feet."""
        h, x, r = self.height, self.span / 2, self.bar_radius
        ends = [Capsule((s * x, h, 0.0), (s * x, h, 0.0), 1.25 * r) for s in (-1.0, 1.0)]
        foot = 0.55 * min(self.span, 0.8)
        return (
            Capsule((-x, h, 0.0), (x, h, 0.0), r),
            *ends,
            Capsule((0.0, 0.05, 0.0), (0.0, h, 0.0), self.post_radius),
            Box((0.0, 0.024, 0.0), (0.05, 0.048, foot), 0.012),
            Box((0.0, 0.024, 0.0), (foot, 0.048, 0.05), 0.012),
            Cylinder((0.0, 0.05, 0.0), (0.0, 0.11, 0.0), 1.9 * self.post_radius, 0.012),
        )

    def to_dict(self) -> dict[str, Any]:
        return {"kind": "t_bar", **asdict(self)}


def stand_of(told: dict[str, Any]) -> Stand:
    """The stand `to_dict` described; raises TypeError for what is none."""
    kind, sizes = told.get("kind"), {name: value for name, value in told.items() if name != "kind"}
    return TBar(**sizes) if kind == "t_bar" else Stand(**sizes)
