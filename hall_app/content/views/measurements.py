"""What the bake measured about a simulated garment, as lines for a visitor. No number is written here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def _millimetres(value: float) -> str:
    return f"{value * 1000:.2f} mm"


def _percent(value: float) -> str:
    return f"{value * 100:.2f} %"


def _count(value: float) -> str:
    return f"{value:,.0f}".replace(",", "\u2009")


def _seconds(value: float) -> str:
    return f"{value:.1f} s"


def _grams(value: float) -> str:
    return f"{value * 1000:.1f} g"


# Name in bake.json -> Chinese label, English label, how the value (SI units, shares 0..1) is written.
# In the order a visitor reads them; what is not named here is not shown.
ERRORS: dict[str, tuple[str, str, Callable[[float], str]]] = {
    "vertices": ("布料网格顶点", "Vertices of the cloth mesh", _count),
    "mass_kg": ("重量", "Weight", _grams),
    "area_strain_p95": ("面积应变（95 % 分位）", "Area strain, 95th percentile", _percent),
    "area_strain_max": ("面积应变（最大）", "Area strain, greatest", _percent),
    "inside_vertices": ("陷入所着之物的顶点", "Vertices inside what it lies on", _count),
    "inside_midpoints": ("陷入所着之物的边中点", "Edge midpoints inside what it lies on", _count),
    "inside_centroids": ("陷入所着之物的三角形中心", "Triangle centres inside what it lies on", _count),
    "inside_edges": (
        "与所着之物互相穿过的边",
        "Edges that pass through what it lies on, or its through the cloth",
        _count,
    ),
    "self_intersections": ("布面自交", "Self-intersections of the cloth", _count),
    "moving_deepest_m": ("行动中陷入身体最深", "While it moves: deepest in the body", _millimetres),
    "moving_self_intersections": (
        "行动中布面自交",
        "While it moves: self-intersections of the cloth",
        _count,
    ),
    "moving_area_strain_p95": (
        "行动中面积应变（95 % 分位）",
        "While it moves: area strain, 95th percentile",
        _percent,
    ),
    "rest_max_m": ("静止时每 1/25 秒的最大位移", "Greatest movement at rest in 1/25 s", _millimetres),
    "scan_triangles": ("扫描件三角形", "Triangles of the scan", _count),
    "close_triangles": ("近观模型三角形", "Triangles of the close-up model", _count),
    "close_hausdorff_mean": ("近观模型平均偏差", "Close-up model, mean deviation", _millimetres),
    "close_hausdorff_p99": (
        "近观模型偏差（99 % 分位）",
        "Close-up model, deviation, 99th percentile",
        _millimetres,
    ),
    "close_hausdorff_max": ("近观模型最大偏差", "Close-up model, greatest deviation", _millimetres),
    "hall_triangles": ("展厅模型三角形", "Triangles of the hall model", _count),
    "hall_hausdorff_mean": ("展厅模型平均偏差", "Hall model, mean deviation", _millimetres),
    "hall_hausdorff_p99": (
        "展厅模型偏差（99 % 分位）",
        "Hall model, deviation, 99th percentile",
        _millimetres,
    ),
    "hall_hausdorff_max": ("展厅模型最大偏差", "Hall model, greatest deviation", _millimetres),
}
SECONDS: dict[str, tuple[str, str]] = {
    "drape": ("垂挂模拟用时", "Time for the drape"),
    "film": ("拍摄影片用时", "Time for the film"),
    "models": ("制作模型用时", "Time for the models"),
    "all": ("全部用时", "Time in all"),
}


def measured_lines(bake: dict[str, Any]) -> list[dict[str, Any]]:
    """Lines {label{zh,en}, value{zh,en}} of a bake.json {errors: {name: number}, seconds: {name: number}, shown, …}.

    Errors come first, those of the garment that is shown, not of its belt; what is absent or no number is passed over.
    """
    errors, seconds = _numbers(bake.get("errors")), _numbers(bake.get("seconds"))
    before = f"{bake.get('shown')}_"
    own = {name.removeprefix(before): value for name, value in errors.items() if name.startswith(before)}
    errors = own or errors
    lines = [_line(zh, en, write(errors[name])) for name, (zh, en, write) in ERRORS.items() if name in errors]
    return lines + [
        _line(zh, en, _seconds(seconds[name])) for name, (zh, en) in SECONDS.items() if name in seconds
    ]


def _numbers(table: Any) -> dict[str, float]:
    if not isinstance(table, dict):
        return {}
    return {name: v for name, v in table.items() if isinstance(v, int | float) and not isinstance(v, bool)}


def _line(zh: str, en: str, value: str) -> dict[str, Any]:
    return {"label": {"zh": zh, "en": en}, "value": {"zh": value, "en": value}}
