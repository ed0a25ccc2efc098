"""What is wrong with a scan, and what is only to be known of it, in a curator's words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from hall_app.content.schema.exhibit import Scanned

if TYPE_CHECKING:
    from sim_core.mesh.scan import Condition, Scan

__all__ = ["Finding", "condition_of", "findings", "refuse", "scan_cleaned"]

LYING = 1.5  # times as long as it is high, and flattest that way: perhaps another axis is up
ASIDE = 1.25  # times as large with its loose parts: they hide its true size
LOST = 0.02  # of its triangles without an area, or not finite: the export went wrong
TORN = 0.1  # of its edges open: a heap of single triangles
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
AXES = "xyz"


@dataclass(frozen=True)
class Finding:
    """One sentence about a scan: the key it is put right by, what is found, the remedy; stops: no model is made."""

    key: str
    what: str
    fix: str
    stops: bool

    def __str__(self) -> str:
        return f"{self.what} – {self.fix}"


def scan_cleaned(path: Path, content: Path) -> tuple[Scan, Condition]:
    """The scan at `path`, joined and without what is no surface, and its condition; what lies beside it must be in the
    content folder. Raises ScanError, OSError."""
    from sim_core.mesh.scan import cleaned, read_scan

    return cleaned(read_scan(path, content))


def condition_of(path: Path, content: Path) -> Condition:
    """The condition alone, kept as long as the file stays what it is."""
    stat = path.stat()
    return _condition(path, content, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=32)
def _condition(path: Path, content: Path, _mtime: int, _size: int) -> Condition:
    return scan_cleaned(path, content)[1]


def refuse(found: tuple[Finding, ...], toml: str) -> None:
    """Raises ScanError with the first of the findings that stops."""
    from sim_core.mesh.scan import ScanError

    for finding in found:
        if finding.stops:
            key = f": {finding.key}" if finding.key else ""
            raise ScanError(f"{toml}{key}: {finding.what}", finding.fix)


def findings(condition: Condition, scanned: Scanned, size_range: tuple[float, float]) -> tuple[Finding, ...]:
    """All there is to say of a scan that was saved so; size_range [m]: heights that are right.

    Of one that is damaged or torn nothing else is said: its parts and their size are not those of the piece.
    """
    surface = _surface(condition, scanned)
    if any(finding.stops for finding in surface):
        return tuple(surface)
    return (*_standing(condition, scanned, size_range), *surface, *_parts(condition, scanned))


def _standing(condition: Condition, scanned: Scanned, size_range: tuple[float, float]) -> list[Finding]:
    """Its axes and its size."""
    found = []
    extent = condition.whole if scanned.keep == "all" else condition.largest
    up = scanned.up or "y"
    if scanned.up is None and _lies(condition.largest):
        other = max("xz", key=lambda axis: condition.largest[AXES.index(axis)])
        other = "z" if condition.largest[2] >= LYING * condition.largest[1] else other
        x, y, z = (_metres(side * scanned.metres) for side in condition.largest)
        what = f"it seems to lie: it is {x} wide, {y} high and {z} deep"
        found.append(
            Finding(
                "scanned.up", what, f'write up = "{other}" below [scanned], or up = "y" if it is right', True
            )
        )
        up = other
    high = extent[AXES.index(up[-1])]
    low, most = size_range
    if not low <= high * scanned.metres <= most:
        what = f"it is {_metres(high * scanned.metres)} high, expected {low:g} to {most:g} m"
        found.append(Finding("scanned", what, _unit(high, size_range), True))
    return found


def _lies(extent: tuple[float, float, float]) -> bool:
    x, y, z = extent
    return y < min(x, z) and max(x, z) >= LYING * y


def _metres(length: float) -> str:
    return f"{length:,.0f} m" if length >= 100 else f"{length:.3g} m"


def _short(number: float) -> str:
    return f"{number:.0f}" if number >= 10 else f"{number:.2g}"


def _unit(high: float, size_range: tuple[float, float]) -> str:
    low, most = size_range
    middle = (low * most) ** 0.5
    fitting = [unit for unit, metres in UNITS.items() if low <= high * metres <= most]
    if fitting:  # several may: 45 is a coat in inches and a child's in centimetres
        unit = min(fitting, key=lambda name: abs(math.log(high * UNITS[name] / middle)))
        return f'write units = "{unit}" below [scanned] ({_metres(high * UNITS[unit])})'
    for power in range(-6, 7):
        if high > 0 and low <= high * 10.0**power <= most:
            return f"write scale = {10.0**power:g} below [scanned]"
    return "write scale = … below [scanned], or state its true size_range = [least, greatest]"


def _surface(condition: Condition, scanned: Scanned) -> list[Finding]:
    """What of it is no surface, open, or without colour."""
    found = []
    lost = (
        (condition.not_finite, "have a corner that is no number", "has a corner that is no number"),
        (condition.degenerate, "have no area", "has no area"),
        (condition.duplicated, "lie twice in one place", "lies twice in one place"),
    )
    for count, many, one in lost:
        if count:
            stops = count > LOST * condition.triangles and many != lost[2][1]
            what = f"{count} of its {condition.triangles} triangles {one if count == 1 else many}"
            fix = "export it again" if stops else "it is left out" if count == 1 else "they are left out"
            found.append(Finding("scan", what, fix, stops))
    if condition.open_edges > TORN:
        what = f"its triangles hardly hang together: {100 * condition.open_edges:.0f} % of all edges are open"
        found.append(Finding("scan", what, "merge its vertices by distance in the scanning software", True))
    elif condition.holes:
        millimetres = 1000 * condition.hole_width * scanned.metres
        many = "it has a hole" if condition.holes == 1 else f"it has {condition.holes} holes"
        what = f"{many}, the largest {millimetres:.0f} mm wide, beside {condition.rims} hems or wide openings"
        found.append(
            Finding("scan", what, "close them in the scanning software if they are none of the piece", False)
        )
    if condition.branching:
        what = f"more than two of its triangles meet in {condition.branching} edges"
        found.append(Finding("scan", what, "nothing to do: it is drawn as it is there", False))
    if not condition.coloured:
        fix = "export it with its texture or vertex colours; without them it is shown in one tone"
        found.append(Finding("scan", "it has neither texture nor vertex colours", fix, False))
    return found


def _parts(condition: Condition, scanned: Scanned) -> list[Finding]:
    if condition.parts == 1 or scanned.keep is not None:
        return []
    loose = condition.parts - 1
    larger = max(a / max(b, 1e-30) for a, b in zip(condition.whole, condition.largest, strict=True))
    many = "a loose part" if loose == 1 else f"{loose} loose parts"
    what = f"it has {many}, {_short(100 * condition.loose_area)} % of its area"
    if larger >= ASIDE:
        what += f", which make it {_short(larger)} times as large"
    fix = 'write keep = "largest" below [scanned] to leave them out, or keep = "all" if they belong to it'
    return [Finding("scanned.keep", what, fix, larger >= ASIDE)]
