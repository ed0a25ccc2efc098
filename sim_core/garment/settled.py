"""What a garment was settled with: contact, holds, damping, friction and the solids it lies on.

Whoever carries a garment on (lets it hang on, moves its wearer, learns from it) needs nothing else, and what hung
still goes on hanging still: cloth at rest is at rest between these forces and no others.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from sim_core.body.beneath import Beneath, Surface
from sim_core.body.stand import stand_of
from sim_core.cloth import Contact, Holds, Phase

__all__ = ["Settled"]


@dataclass(frozen=True)
class Lent:
    """A surface that lies in a garment file beside this one: its name, and the number of the surface there."""

    file: str
    number: int


@dataclass(frozen=True)
class Settled:
    """contact: how the cloth touched; last: the phase it came to rest in (gravity, damping, friction); holds: ties,
    bounds and the limit of its threads, of the draped vertices; beneath: what it lies on; even: whether the sheet's
    mass is shared out for longer steps (`cloth.sheet.evened`).
    """

    contact: Contact
    last: Phase
    holds: Holds
    beneath: Beneath = field(default_factory=Beneath)
    even: bool = True

    def phase(self, seconds: float, label: str = "standing") -> Phase:
        """More of what the garment came to rest in."""
        gravity, sewing = self.last.gravity[1], self.last.sewing[1]
        steady = {"gravity": (gravity, gravity), "sewing": (sewing, sewing)}
        return replace(self.last, seconds=seconds, label=label, rest=None, body=None, **steady)

    def on_grid(self, step: float) -> Settled:
        """The same, each coordinate of what it lies on a multiple of `step` [m]."""
        surfaces = tuple(
            replace(one, vertices=np.rint(one.vertices / step) * step) for one in self.beneath.surfaces
        )
        return replace(self, beneath=replace(self.beneath, surfaces=surfaces))

    def to_header(self, lent: Mapping[int, Lent] = MappingProxyType({})) -> dict[str, Any]:
        """What JSON can hold of it; `arrays` are the rest. lent: surfaces that another file holds."""
        return {
            "contact": asdict(self.contact),
            "last": asdict(self.last),
            "limit": list(self.holds.limit),
            "even": self.even,
            "stand": self.beneath.stand and self.beneath.stand.to_dict(),
            "cell": self.beneath.cell,
            "box": self.beneath.box,
            "floor": self.beneath.floor,
            **({"closing": self.beneath.closing} if self.beneath.closing else {}),
            "surfaces": [
                {"thicker": s.thicker, "hulls": len(s.hulls), "hulls_thicker": s.hulls_thicker}
                | (asdict(lent[k]) if k in lent else {})
                for k, s in enumerate(self.beneath.surfaces)
            ],
        }

    def arrays(self, lent: Collection[int] = ()) -> dict[str, np.ndarray]:
        """The arrays of a file, by name. lent: surfaces that another file holds."""
        out = {f"holds_{name}": getattr(self.holds, name) for name in _HOLDS}
        for k, surface in enumerate(self.beneath.surfaces):
            if k not in lent:
                out |= zip(_names(k, len(surface.hulls)), _arrays_of(surface), strict=True)
        return out

    def lent_by(self, other: Settled, file: str) -> dict[int, Lent]:
        """Which of its surfaces lie in a file of `other`, to the bit."""
        found: dict[int, Lent] = {}
        for k, own in enumerate(self.beneath.surfaces):
            for number, theirs in enumerate(other.beneath.surfaces):
                pairs = zip(_arrays_of(own), _arrays_of(theirs), strict=False)
                if len(own.hulls) == len(theirs.hulls) and all(np.array_equal(a, b) for a, b in pairs):
                    found[k] = Lent(file, number)
                    break
        return found

    @staticmethod
    def names(header: Mapping[str, Any]) -> dict[str, dict[str, str]]:
        """File -> the arrays that it holds of a garment with this header -> what they are called there; "" is the
        garment's own. Raises KeyError, TypeError or ValueError for what is no header."""
        found = {"": {f"holds_{name}": f"holds_{name}" for name in _HOLDS}}
        for k, told in enumerate(header["surfaces"]):
            hulls, file, number = int(told["hulls"]), str(told.get("file", "")), int(told.get("number", k))
            if file and Path(file).name != file:
                raise ValueError(f"a surface of {file!r}, which is no file beside it")
            found.setdefault(file, {}).update(zip(_names(k, hulls), _names(number, hulls), strict=True))
        return found

    @staticmethod
    def of(header: Mapping[str, Any], data: Mapping[str, np.ndarray]) -> Settled:
        """From `to_header` and `arrays`; raises KeyError, TypeError or ValueError for what is none."""
        surfaces = tuple(
            Surface(
                np.ascontiguousarray(data[f"surface{k}_vertices"], float),
                np.ascontiguousarray(data[f"surface{k}_faces"], np.int32),
                tuple(data[f"surface{k}_hull{j}"] for j in range(int(told["hulls"]))),
                float(told["thicker"]),
                float(told.get("hulls_thicker", 0.0)),  # of hands, not told by the first files
            )
            for k, told in enumerate(header["surfaces"])
        )
        stand = stand_of(header["stand"]) if header["stand"] else None
        shorter, longer = (float(share) for share in header["limit"])
        kept = {name: np.ascontiguousarray(data[f"holds_{name}"]) for name in _HOLDS}
        last: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in header["last"].items()}
        return Settled(
            Contact(**header["contact"]),
            Phase(**last),
            Holds(**kept, limit=(shorter, longer)),
            Beneath(
                surfaces,
                stand,
                float(header["cell"]),
                _box(header["box"]),
                bool(header.get("floor", False)),
                float(header.get("closing", 0.0)),
            ),
            bool(header["even"]),
        )


def _arrays_of(surface: Surface) -> list[np.ndarray]:
    """Vertices, faces and hulls of a surface, as `_names` calls them."""
    return [surface.vertices, surface.faces, *surface.hulls]


def _names(number: int, hulls: int) -> list[str]:
    return [f"surface{number}_{name}" for name in ("vertices", "faces", *(f"hull{j}" for j in range(hulls)))]


_HOLDS = ("pairs", "spans", "ends", "same", "low", "high", "slaves")


def _box(told: Any) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
    if told is None:
        return None
    (a, b, c), (d, e, f) = told
    return (float(a), float(b), float(c)), (float(d), float(e), float(f))
