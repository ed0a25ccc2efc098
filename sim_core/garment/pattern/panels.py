"""Panels and seams of a garment as values: outlines made of legs between named corners, paths along them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from sim_core.errors import OutlineError
from sim_core.garment.pattern.pleats import Pleat

__all__ = ["Panel", "Path", "Seam", "Spot", "Tie", "check_extent"]

NARROWEST, LONGEST = 0.002, 20.0  # [m] of a panel

Colour = tuple[float, float, float]
SeamKind = Literal["joined", "sewn", "middle"]


@dataclass(frozen=True)
class Panel:
    """One piece of cloth.

    corners: names in order; legs: leg k runs from corner k to the next one, (n, 2) [m] with both ends, y down along
    the warp; doubled: cut twice as high and folded along its length; along: the path of another panel that it is laid
    beside before sewing (None: it lies in the garment's own plane, x outwards from the middle, y = 0 the shoulder
    fold); dye: sRGB 0..1 (None: the pattern's); pleats: folded into it before it is placed; side: "left" or "right" of
    the wearer where a mirrored pattern has it once, "" where each half has it.
    """

    name: str
    corners: tuple[str, ...]
    legs: tuple[np.ndarray, ...]
    doubled: bool = False
    along: Path | None = None
    dye: Colour | None = None
    pleats: tuple[Pleat, ...] = ()
    side: str = ""

    def outline(self) -> np.ndarray:
        """The closed outline (N, 2) [m], first point not repeated."""
        return np.concatenate([leg[:-1] for leg in self.legs])

    def path(self, start: str, end: str, *, ahead: bool) -> tuple[int, ...]:
        """Numbers of the legs from corner `start` to corner `end`, in the outline's order or against it."""
        i, j, count = self.corners.index(start), self.corners.index(end), len(self.corners)
        steps = (j - i) % count if ahead else (i - j) % count
        return tuple((i + k) % count if ahead else (i - k - 1) % count for k in range(steps))

    def to_dict(self) -> dict[str, Any]:
        """A plain dictionary that JSON can hold."""
        legs = [leg.tolist() for leg in self.legs]
        told: dict[str, Any] = {
            "name": self.name,
            "corners": list(self.corners),
            "legs": legs,
            "doubled": self.doubled,
            "along": self.along and str(self.along),
            "dye": self.dye and list(self.dye),
        }
        if self.pleats:
            told["pleats"] = [pleat.to_list() for pleat in self.pleats]
        return {**told, "side": self.side} if self.side else told

    def is_of(self, side: str) -> bool:
        """Whether the half on that side of the wearer, "left" or "right", has it."""
        return self.side in ("", side)

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Panel:
        """The panel `to_dict` described, also one of a garment saved when panels had a `layer`."""
        return Panel(
            data["name"],
            tuple(data["corners"]),
            tuple(np.asarray(leg, float) for leg in data["legs"]),
            data["doubled"],
            Path.read(data["along"]) if data["along"] else None,
            tuple(data["dye"]) if data["dye"] else None,
            tuple(Pleat(*told) for told in data.get("pleats", ())),
            data.get("side", ""),
        )


@dataclass(frozen=True)
class Path:
    """A way along a panel's outline from one corner to another; ahead: in the order in which they are listed."""

    panel: str
    start: str
    end: str
    ahead: bool

    def __str__(self) -> str:
        return f"{self.panel}: {self.start} {'>' if self.ahead else '<'} {self.end}"

    def legs(self, panel: Panel) -> list[np.ndarray]:
        """The legs (n, 2) [m] in the path's direction."""
        numbers = panel.path(self.start, self.end, ahead=self.ahead)
        return [panel.legs[k] if self.ahead else panel.legs[k][::-1] for k in numbers]

    def length(self, panel: Panel) -> float:
        """[m]"""
        return float(sum(arc_length(leg)[-1] for leg in self.legs(panel)))

    @staticmethod
    def read(text: str) -> Path:
        """'panel: from > to' runs in the order of the outline, 'panel: from < to' against it.

        Raises ValueError for anything else.
        """
        panel, colon, way = text.partition(":")
        ahead = ">" in way
        start, sign, end = way.partition(">" if ahead else "<")
        if not (colon and sign and panel.strip() and start.strip() and end.strip()):
            raise ValueError(f"{text!r} – write 'panel: from > to', or '<' for against the outline's order")
        return Path(panel.strip(), start.strip(), end.strip(), ahead)


@dataclass(frozen=True)
class Seam:
    """joined: flat before dressing; sewn: drawn together on the figure; middle: to its own mirror image (b None).

    The first point of a meets the first point of b. notches: fractions of a's length, above 0 and below 1.
    """

    kind: SeamKind
    a: Path
    b: Path | None = None
    notches: tuple[float, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """A plain dictionary that JSON can hold."""
        told = {"kind": self.kind, "a": str(self.a), "b": self.b and str(self.b)}
        return {**told, "notches": list(self.notches)} if self.notches else told

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Seam:
        """The seam `to_dict` described."""
        b = Path.read(data["b"]) if data["b"] else None
        return Seam(data["kind"], Path.read(data["a"]), b, tuple(data.get("notches", ())))


@dataclass(frozen=True)
class Spot:
    """A point of a garment: panel, place (2,) [m] in the panel's own coordinates, of which the nearest vertex is meant;
    side: of a mirrored pattern, "left" or "right" of the wearer, "" for both halves alike."""

    panel: str
    place: tuple[float, float]
    side: str = ""

    def __str__(self) -> str:
        x, y = (1000 * c for c in self.place)
        return f"{' '.join(filter(None, (self.panel, self.side)))} at {x:.0f}, {y:.0f} mm"


@dataclass(frozen=True)
class Tie:
    """Two points that a tie, loop or pin draws together to `length` [m]."""

    name: str
    a: Spot
    b: Spot
    length: float


def arc_length(points: np.ndarray) -> np.ndarray:
    """Length [m] along a polyline (n, 2) up to each point."""
    return np.r_[0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]


def at_length(points: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Points (m, 2) of a polyline (n, 2) at arc lengths (m,) [m]."""
    arc = arc_length(points)
    return np.column_stack([np.interp(lengths, arc, points[:, 0]), np.interp(lengths, arc, points[:, 1])])


def check_extent(outline: np.ndarray) -> None:
    """Raise OutlineError unless an outline (N, 2) [m] measures 2 mm to 20 m both ways: else it is a slip of units."""
    for side, length in zip(("wide", "long"), np.ptp(outline, axis=0).tolist(), strict=True):
        if not NARROWEST <= length <= LONGEST:
            raise OutlineError(
                f"outline: {length:.4g} m {side} – a panel measures {NARROWEST} to {LONGEST:g} m both ways"
            )
