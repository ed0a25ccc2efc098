"""What an instrument reads, in SI units and in those of Kawabata's evaluation system (KES)."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

__all__ = ["GF_CM", "GF_CM2", "Reading", "banded", "mean_reading"]

GF = 9.80665e-3  # [N]
GF_CM = GF / 1e-2  # [N/m] of 1 gf/cm
GF_CM2 = GF / 1e-4  # [Pa] of 1 gf/cm2
# SI value of 1 unit of KES
UNITS = {
    "B": ("N m", "gf cm2/cm", GF * 1e-2),
    "2HB": ("N", "gf cm/cm", GF),
    "G": ("N/m per rad", "gf/(cm deg)", GF_CM / radians(1)),
    "2HG": ("N/m", "gf/cm", GF_CM),
    "2HG5": ("N/m", "gf/cm", GF_CM),
    "EMT": ("1", "%", 0.01),
    "LT": ("1", "1", 1.0),
    "WT": ("J/m2", "gf cm/cm2", GF * 1e-2 / 1e-4),
    "RT": ("1", "%", 0.01),
    "T0": ("m", "mm", 1e-3),
    "TM": ("m", "mm", 1e-3),
}


@dataclass(frozen=True)
class Reading:
    """name: of KES.  value, band: in SI units."""

    name: str
    value: float
    band: tuple[float, float]

    def to_dict(self) -> dict:
        """Value, unit, the same in KES units, and the band."""
        unit, theirs, size = UNITS[self.name]
        return {
            "value": self.value,
            "unit": unit,
            "kes": self.value / size,
            "kes_unit": theirs,
            "band": list(self.band),
        }


def banded(name: str, value: float, others: list[float]) -> Reading:
    """A reading, and the least and most of it under other assumptions."""
    return Reading(name, value, (min([value, *others]), max([value, *others])))


def mean_reading(readings: list[Reading], shares: list[float]) -> Reading:
    """Cells of a figured cloth side by side: means by area, of the values and of both ends of their bands, since what
    is assumed of one cell is true of all."""
    low, value, high = (
        sum(share * one for share, one in zip(shares, ends, strict=True))
        for ends in zip(*((one.band[0], one.value, one.band[1]) for one in readings), strict=True)
    )
    return Reading(readings[0].name, value, (low, high))
