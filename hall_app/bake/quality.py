"""What a baked garment was measured to be, against what it must be: the table of `hall check --garments`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..content.loading import Content
from .places import baked_here, read_record

__all__ = ["Line", "garment_lines", "table"]


@dataclass(frozen=True)
class Limit:
    """A measured figure and what it may be; recipes: which it is asked of (empty: all)."""

    name: str
    most: float | None = None
    least: float | None = None
    recipes: tuple[str, ...] = ()


ROBE, SCARF, PIBO = "robe_on_figure", "scarf_on_stand", "pibo_on_figure"
LIMITS = (
    Limit("inside_vertices", 0),
    Limit("inside_midpoints", 0),
    Limit("inside_centroids", 0),
    Limit("seam_gap_sewn_m", 1e-3, recipes=(ROBE,)),
    Limit("seam_gap_m", 1e-4, recipes=(ROBE,)),
    Limit("area_strain_p95", 0.03),
    Limit("area_strain_max", 0.10),
    Limit("rest_p99_m", 1e-5, recipes=(ROBE, PIBO)),
    Limit("rest_p99_m", 1e-4, recipes=(SCARF,)),
    Limit("self_intersections", 0, recipes=(SCARF,)),
    Limit("self_intersections", 25, recipes=(ROBE,)),
    Limit("self_intersections", 300, recipes=(PIBO,)),
    Limit("asymmetry_m", 0.010, recipes=(ROBE, PIBO)),
    Limit("triangles", least=11_000, recipes=(ROBE, PIBO)),
    Limit("hall_all_triangles", 6_000, recipes=(ROBE, PIBO)),
    Limit("hall_hausdorff_p99"),
    Limit("hall_hausdorff_max"),
    Limit("drape_s", 180),
    Limit("drape_cpu_s", recipes=(ROBE,)),
)


@dataclass(frozen=True)
class Line:
    """One figure of one garment: its value, the limit in words, and whether it keeps it."""

    exhibit: str
    name: str
    value: float | None
    limit: str
    kept: bool

    def as_json(self) -> dict[str, Any]:
        """The line as plain values."""
        return dict(self.__dict__)


def garment_lines(content: Content) -> list[Line]:
    """The figures of every baked garment beside its exhibit; one line 'bake' for a garment that has none."""
    lines: list[Line] = []
    for exhibit in content.exhibits:
        if exhibit.file.garment is None:
            continue
        record = read_record(baked_here(exhibit))
        if record is None:
            lines.append(Line(exhibit.id, "bake", None, f"run: hall build --exhibit {exhibit.id}", False))
            continue
        lines += _of(exhibit.id, exhibit.file.garment.recipe, record)
    return lines


def _of(exhibit: str, recipe: str, record: dict[str, Any]) -> list[Line]:
    measured = {**record.get("errors", {}), "drape_s": record.get("seconds", {}).get("drape")}
    measured["drape_cpu_s"] = record.get("stages", {}).get("drape_cpu")
    lines = []
    for limit in LIMITS:
        if limit.recipes and recipe not in limit.recipes:
            continue
        value = measured.get(limit.name)
        if value is None:
            lines.append(Line(exhibit, limit.name, None, "not measured – bake it again", False))
            continue
        kept = (limit.most is None or value <= limit.most) and (limit.least is None or value >= limit.least)
        lines.append(Line(exhibit, limit.name, float(value), _words(limit), kept))
    return lines


def _words(limit: Limit) -> str:
    write = _writer(limit.name)
    if limit.most is not None:
        return f"at most {write(limit.most)}"
    return f"at least {write(limit.least)}" if limit.least is not None else ""


def _writer(name: str) -> Callable[[float], str]:
    if name.endswith(("_m", "hausdorff_p99", "hausdorff_max")):
        return lambda value: f"{value * 1000:.3f} mm"
    if "strain" in name:
        return lambda value: f"{value:.2%}"
    return (lambda value: f"{value:.1f} s") if name.endswith("_s") else (lambda value: f"{value:.0f}")


def table(lines: list[Line]) -> str:
    """The lines as text, one garment below the other."""
    rows, last = [], ""
    for line in lines:
        if line.exhibit != last:
            rows.append(line.exhibit)
            last = line.exhibit
        value = "–" if line.value is None else _writer(line.name)(line.value)
        rows.append(f"  {'  ' if line.kept else '! '}{line.name:<22} {value:>12}   {line.limit}".rstrip())
    broken = sum(not line.kept for line in lines)
    rows.append("all limits kept" if not broken else f"{broken} of {len(lines)} figures break their limit")
    return "\n".join(rows) + "\n"


def garments_checked(folder: Path, *, as_json: bool) -> tuple[str, int]:
    """What `hall check --garments` writes, and its exit status."""
    import json

    from ..content.loading import load

    lines = garment_lines(load(folder))
    if as_json:
        text = json.dumps(
            {"folder": str(folder), "figures": [line.as_json() for line in lines]},
            ensure_ascii=False,
            indent=1,
        )
        return text + "\n", int(not all(line.kept for line in lines))
    return table(lines), int(not all(line.kept for line in lines))
