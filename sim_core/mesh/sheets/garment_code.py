"""Patterns of GarmentCode (Korosteleva and Sorkine-Hornung, SIGGRAPH Asia 2023) as values, from their JSON and back.

A panel is vertices, and edges between them in order, straight or curved; lengths in `units_in_meter`, y up, the right
side of the cloth towards the reader where edges run counter-clockwise. Curvature is relative to the edge: (0, 0) its
beginning, (1, 0) its end, (0, 1) as far to its left as it is long. A stitch joins two edges, the end of one to the
beginning of the other, so that right side meets right side; the word "right_wrong" joins beginning to beginning.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.geometry.curves import arc_points, bezier_points
from sim_core.mesh.sheets.model import Piece, Sheet
from sim_core.validation.files import read_json, shown

__all__ = [
    "CodeEdge",
    "CodePanel",
    "GarmentCode",
    "Stitch",
    "code_sheet",
    "is_garment_code",
    "read_garment_code",
]

REMEDY = "give a specification as GarmentCode writes it"
KINDS = {dict: "table", list: "list", str: "text", int: "whole number"}
Curve = Literal["line", "quadratic", "cubic", "circle"]


@dataclass(frozen=True)
class CodeEdge:
    """From vertex `start` to vertex `end`. curve: its kind.  params: control points relative to the edge; of a circle
    its radius, whether it is the larger arc, and whether it bulges to the right.  rest: what else the file says."""

    start: int
    end: int
    curve: Curve = "line"
    params: tuple = ()
    rest: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class CodePanel:
    """vertices: pairs of numbers.  edges: in order around.  rest: translation, rotation, label, …"""

    vertices: tuple[tuple[float, float], ...]
    edges: tuple[CodeEdge, ...]
    rest: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Stitch:
    """a, b: (panel, number of the edge).  right_wrong: beginning meets beginning; otherwise beginning meets end."""

    a: tuple[str, int]
    b: tuple[str, int]
    right_wrong: bool = False


@dataclass(frozen=True)
class GarmentCode:
    """A specification. per_metre: units of length in a metre.  rest, pattern_rest: what else the file says at its top
    and under "pattern"."""

    panels: dict[str, CodePanel]
    stitches: tuple[Stitch, ...]
    per_metre: float = 100.0
    rest: dict[str, Any] = field(default_factory=dict)
    pattern_rest: dict[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """What JSON holds; of a file that was read, the same as in it."""
        panels = {name: _panel_dict(panel) for name, panel in self.panels.items()}
        stitches = [
            [
                {"panel": s.a[0], "edge": s.a[1]},
                {"panel": s.b[0], "edge": s.b[1]},
                *["right_wrong"][: s.right_wrong],
            ]
            for s in self.stitches
        ]
        return {"pattern": {"panels": panels, "stitches": stitches, **self.pattern_rest}, **self.rest}

    def digest(self) -> str:
        """Of panels and stitches: the same only while nobody has changed them."""
        held = self.to_dict()["pattern"]
        text = json.dumps([held["panels"], held["stitches"]], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    def leg(self, panel: str, number: int) -> np.ndarray:
        """The points of an edge (n, 2) [m], y down, both ends included."""
        held = self.panels[panel]
        edge = held.edges[number]
        start, end = (np.array(held.vertices[k], float) for k in (edge.start, edge.end))
        return np.vstack([start, *_steps(edge, start, end)]) * (1, -1) / self.per_metre

    def outline(self, panel: str) -> np.ndarray:
        """The outline of a panel (n, 2) [m], y down, not closed."""
        return np.concatenate([self.leg(panel, k)[:-1] for k in range(len(self.panels[panel].edges))])


def _panel_dict(panel: CodePanel) -> dict[str, Any]:
    edges = []
    for edge in panel.edges:
        made: dict[str, Any] = {"endpoints": [edge.start, edge.end], **edge.rest}
        if edge.curve != "line" and "curvature" not in edge.rest:
            made["curvature"] = {"type": edge.curve, "params": [_plain(p) for p in edge.params]}
        edges.append(made)
    return {"vertices": [list(v) for v in panel.vertices], "edges": edges, **panel.rest}


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _steps(edge: CodeEdge, start: np.ndarray, end: np.ndarray) -> list[np.ndarray]:
    """Points of an edge after its beginning, y up."""
    if edge.curve == "line":
        return [end]
    if edge.curve == "circle":
        radius, large, right = edge.params
        return arc_points(start, (radius, radius), 0.0, bool(large), bool(right), end)
    along = end - start
    left = np.array([-along[1], along[0]])
    controls = [start + p[0] * along + p[1] * left for p in edge.params]
    return bezier_points([start, *controls, end])


def is_garment_code(path: Path) -> bool:
    """Whether a JSON file holds a pattern with panels; False for a file that cannot be read."""
    if path.suffix.lower() != ".json":
        return False
    try:
        values = read_json(path, "")
    except FileProblem:
        return False
    return (
        isinstance(values, dict) and isinstance(values.get("pattern"), dict) and "panels" in values["pattern"]
    )


def read_garment_code(path: Path, values: Any) -> GarmentCode:
    """The specification that a JSON file holds; raises FileProblem naming panel, edge or stitch and the remedy."""
    try:
        pattern = dict(_told("the file", values, "pattern", dict))
        properties = values.get("properties") or {}
        if not isinstance(properties, dict):
            raise ValueError(f"properties: {shown(properties)} – give units_in_meter in it, or leave it out")
        per_metre = properties.get("units_in_meter", 100)
        if type(per_metre) not in (int, float) or not 1e-3 <= per_metre <= 1e6:
            raise ValueError(f"properties.units_in_meter: {shown(per_metre)} – 100 for centimetres")
        coords = properties.get("curvature_coords", "relative")
        if coords not in ("relative", "absolute"):
            raise ValueError(f"properties.curvature_coords: {shown(coords)} – 'relative' or 'absolute'")
        given = _told("pattern", pattern, "panels", dict).items()
        panels = {str(name): _panel(str(name), panel, coords == "absolute") for name, panel in given}
        sewn = _told("pattern", {"stitches": [], **pattern}, "stitches", list)
        stitches = tuple(_stitch(k, stitch, panels) for k, stitch in enumerate(sewn))
        rest = {key: value for key, value in values.items() if key != "pattern"}
        others = {key: value for key, value in pattern.items() if key not in ("panels", "stitches")}
        return GarmentCode(panels, stitches, float(per_metre), rest, others)
    except ValueError as error:
        raise FileProblem(f"{path}: {error}") from error


def _told(what: str, values: Any, key: str, kind: type) -> Any:
    """What a table says under a key; raises ValueError naming what it is of."""
    if not isinstance(values, dict):
        raise ValueError(f"{what}: {shown(values)} is no table – {REMEDY}")
    if key not in values:
        raise ValueError(f"{what}: {key}: missing – {REMEDY}")
    if not isinstance(values[key], kind):
        raise ValueError(f"{what}: {key}: {shown(values[key])} is no {KINDS[kind]} – {REMEDY}")
    return values[key]


def _panel(name: str, values: Any, absolute: bool) -> CodePanel:
    what = f"panel {shown(name)[1:-1]}"
    places = _told(what, values, "vertices", list)
    vertices = tuple(_pair(f"{what}: vertex {k}", v) for k, v in enumerate(places))
    if len(set(vertices)) < 2:
        raise ValueError(f"{what}: its vertices all lie in one place – give it a size")
    edges = tuple(
        _edge(f"{what}: edge {k}", edge, vertices, absolute)
        for k, edge in enumerate(_told(what, values, "edges", list))
    )
    if len({edge.start for edge in edges}) < len(edges):
        raise ValueError(f"{what}: its edges come twice through a vertex – go around once")
    ends = [(edge.end, edges[(k + 1) % len(edges)].start) for k, edge in enumerate(edges)]
    if len(edges) < 2 or any(end != start for end, start in ends):
        raise ValueError(f"{what}: its edges do not follow each other around – order them end to start")
    return CodePanel(vertices, edges, {k: v for k, v in values.items() if k not in ("vertices", "edges")})


def _pair(what: str, values: Any) -> tuple[float, float]:
    numbers = isinstance(values, list) and all(type(v) in (int, float) and abs(v) < 1e9 for v in values)
    if not numbers or len(values) != 2:
        raise ValueError(f"{what}: {shown(values)} – give two numbers")
    return values[0], values[1]


def _edge(what: str, values: Any, vertices: tuple[tuple[float, float], ...], absolute: bool) -> CodeEdge:
    ends = _told(what, values, "endpoints", list)
    count = len(vertices)
    if len(ends) != 2 or not all(type(v) is int and 0 <= v < count for v in ends) or ends[0] == ends[1]:
        raise ValueError(f"{what}: endpoints {shown(ends)} – two different numbers below {count}")
    start, end = ends
    rest = {key: value for key, value in values.items() if key not in ("endpoints", "curvature")}
    bent = values.get("curvature")
    if bent is None:
        return CodeEdge(
            start, end, "line", (), rest if "curvature" not in values else {**rest, "curvature": None}
        )
    if isinstance(bent, list):  # files before 2023: one control point
        point = _pair(what, bent)
        if absolute:
            point = _relative(point, vertices[start], vertices[end])
        return CodeEdge(start, end, "quadratic", (point,), {**rest, "curvature": bent})
    if absolute:
        raise ValueError(f"{what}: curvature {shown(bent)} of absolute coordinates – give one control point")
    kind, params = (
        _told(f"{what}: curvature", bent, key, of) for key, of in (("type", str), ("params", list))
    )
    if kind == "circle":
        radius = params[0] if len(params) == 3 else 0
        if type(radius) not in (int, float) or not 0 < radius < 1e9:
            raise ValueError(f"{what}: circle {shown(params)} – give radius, large arc and direction")
        return CodeEdge(start, end, "circle", tuple(params), rest)
    if (kind, len(params)) not in (("quadratic", 1), ("cubic", 2)):
        raise ValueError(
            f"{what}: curvature {shown(bent)} – quadratic, cubic or circle with its control points"
        )
    return CodeEdge(start, end, kind, tuple(_pair(what, p) for p in params), rest)


def _relative(
    point: tuple[float, float], start: tuple[float, float], end: tuple[float, float]
) -> tuple[float, float]:
    """A point as shares of the edge, along it and to its left."""
    along, away = complex(*end) - complex(*start), complex(*point) - complex(*start)
    if not along:
        raise ValueError(f"edge from {shown(start)} to itself – give it a length")
    share = away / along
    return share.real, share.imag


def _stitch(number: int, values: Any, panels: dict[str, CodePanel]) -> Stitch:
    what = f"stitch {number}"
    if not isinstance(values, list):
        raise ValueError(f"{what}: {shown(values)} – two sides in a list")
    sides = []
    for side in values[:2]:
        name, edge = _told(what, side, "panel", str), _told(what, side, "edge", int)
        if name not in panels or type(edge) is not int or not 0 <= edge < len(panels[name].edges):
            raise ValueError(f"{what}: {shown(side)} – no such panel or edge")
        sides.append((name, edge))
    if values[2:] not in ([], ["right_wrong"]) or len(sides) != 2:
        raise ValueError(f"{what}: {shown(values)} – two sides, and 'right_wrong' or nothing after them")
    if sides[0] == sides[1]:
        raise ValueError(f"{what}: {shown(values[0])} to itself – name two edges")
    return Stitch(sides[0], sides[1], bool(values[2:]))


def code_sheet(code: GarmentCode) -> Sheet:
    """The panels as pieces; their outlines are sewing lines."""
    pieces = []
    for name, panel in code.panels.items():
        pieces.append(Piece(name, str(panel.rest.get("label") or ""), None, code.outline(name)))
    return Sheet(tuple(pieces))
