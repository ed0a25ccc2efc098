"""Pieces and GarmentCode specifications written as pattern files: our TOML, or GarmentCode's JSON."""

from __future__ import annotations

import json
import math
import re
import tomllib
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.geometry.curves import bezier_points
from sim_core.mesh.sheets.garment_code import CodeEdge, CodePanel, GarmentCode
from sim_core.mesh.sheets.legs import Leg, cubic_through, legs_of

__all__ = ["code_of", "pattern_text", "toml_text", "write_pattern"]

EDGE = 0.01  # [m] of a pattern file's mesh unless somebody says otherwise
EASE = 0.02  # sides of a seam may differ by this share in a pattern file
MOST_LEGS = 200


def write_pattern(path: Path, code: GarmentCode, edge: float | None = None) -> list[str]:
    """Write a specification as .toml (a pattern file, meshed at `edge` [m]) or .json; returns remarks.

    What was a pattern file and has not been changed since becomes that file again, without its comments.
    Raises FileProblem for another kind of file, or one that cannot be written.
    """
    text, remarks = (json.dumps(code.to_dict(), indent=2) + "\n", [])
    if path.suffix.lower() == ".toml":
        text, remarks = _kept_text(code, edge)
        if not text:
            text, made = pattern_text(path.stem, code, edge or EDGE)
            remarks += made
    try:
        path.write_text(text, "utf-8")
    except OSError as error:
        remedy = "give a file in a folder that can be"
        raise FileProblem(f"{path}: cannot be written ({error.strerror}) – {remedy}") from error
    return remarks


def _kept_text(code: GarmentCode, edge: float | None) -> tuple[str, list[str]]:
    """The pattern file that a specification was made from, or nothing; and a remark where it has been changed since."""
    kept = code.rest.get("pattern_file")
    if not isinstance(kept, dict) or not isinstance(tables := kept.get("tables"), dict):
        return "", []
    if kept.get("digest") == code.digest():
        if edge is not None:
            tables = {**tables, "edge": edge}
        with suppress(TypeError, ValueError):
            text = toml_text(tables)
            if tomllib.loads(text) == tables:
                return text, []
    return "", ["changed since it was a pattern file, so names of corners, measures and layers are not kept"]


def code_of(outlines: dict[str, np.ndarray]) -> GarmentCode:
    """A specification of outlines (n, 2) [m], y down, by name: centimetres, no stitches."""
    panels = {}
    for name, outline in outlines.items():
        if _area(outline) < 0:
            outline = outline[::-1]  # counter-clockwise seen with y up, as GarmentCode has its right side
        legs = legs_of(outline)
        vertices = tuple((float(x), float(y)) for x, y in np.array([leg.start for leg in legs]) * (100, -100))
        edges = tuple(_edge(k, leg, legs[(k + 1) % len(legs)].start, len(legs)) for k, leg in enumerate(legs))
        panels[name] = CodePanel(vertices, edges, {"translation": [0, 0, 0], "rotation": [0, 0, 0]})
    properties = {
        "curvature_coords": "relative",
        "normalize_panel_translation": False,
        "normalized_edge_loops": True,
        "units_in_meter": 100,
    }
    return GarmentCode(panels, (), 100.0, {"parameters": {}, "parameter_order": [], "properties": properties})


def _area(outline: np.ndarray) -> float:
    """Twice the area, positive where an outline runs counter-clockwise seen with y up."""
    x, y = (outline - outline.mean(axis=0)).T
    return float((np.roll(x, -1) * y - x * np.roll(y, -1)).sum())


def _edge(number: int, leg: Leg, following: np.ndarray, count: int) -> CodeEdge:
    ends = (number, (number + 1) % count)
    if leg.controls is None:
        return CodeEdge(*ends)
    along = (following - leg.start) * (1, -1)
    left, square = np.array([-along[1], along[0]]), float(along @ along)
    away = (leg.controls - leg.start) * (1, -1)
    params = tuple((float(p @ along / square), float(p @ left / square)) for p in away)
    return CodeEdge(*ends, "cubic", params)


def pattern_text(name: str, code: GarmentCode, edge: float) -> tuple[str, list[str]]:
    """The text of a pattern file, panels in millimetres as the paper has them and stitches as seams; and remarks."""
    remarks: list[str] = []
    names = _keys(list(code.panels))
    parts = [f"name = {_text(name)}\nedge = {edge:.6g}"]
    scale = 1000 / code.per_metre
    for panel, key in names.items():
        held = code.panels[panel]
        if len(held.edges) > MOST_LEGS:
            raise FileProblem(
                f"{name}: panel {panel} has {len(held.edges)} edges – a pattern file bears {MOST_LEGS}"
            )
        rows = [f"  {{ {_row(code, panel, k, scale)} }}," for k in range(len(held.edges))]
        title = f"# {_text(panel)[1:-1]}\n" if panel != key else ""
        parts.append(f'{title}[[panel]]\nname = "{key}"\noutline = [\n' + "\n".join(rows) + "\n]")
    for number, stitch in enumerate(code.stitches):
        sides = (
            _way(code, stitch.a, names, turned=False),
            _way(code, stitch.b, names, turned=not stitch.right_wrong),
        )
        seam = f'[[seam]]\nsewn = ["{sides[0]}", "{sides[1]}"]'
        lengths = [_length(code, *side) for side in (stitch.a, stitch.b)]
        if abs(lengths[0] - lengths[1]) > EASE * max(lengths):
            both = " and ".join(f"{1000 * length:.1f}" for length in lengths)
            remarks.append(f"stitch {number}: sides of {both} mm are gathered, left out of the seams")
            seam = "\n".join(f"# {line}" for line in [f"gathered, {both} mm:", *seam.splitlines()])
        parts.append(seam)
    return "\n\n".join(parts) + "\n", remarks


def _row(code: GarmentCode, panel: str, number: int, scale: float) -> str:
    """The point at which an edge begins, with the curve that leads to it."""
    held = code.panels[panel]
    edge, before = held.edges[number], held.edges[number - 1]
    x, y = held.vertices[edge.start]
    text = f'name = "p{edge.start}", at = [{x * scale:.4f}, {-y * scale:.4f}]'
    if before.curve == "line":
        return text
    controls = _controls(code, panel, number - 1) * 1000
    pairs = ", ".join(f"[{a:.4f}, {b:.4f}]" for a, b in controls)
    return f"{text}, curve = [{pairs}]"


def _controls(code: GarmentCode, panel: str, number: int) -> np.ndarray:
    """Two control points (2, 2) [m], y down, of the cubic that an edge is or is nearest to."""
    held = code.panels[panel]
    edge = held.edges[number]
    if edge.curve == "circle":
        leg = code.leg(panel, number)
        return cubic_through(leg, np.linspace(0, 1, len(leg)))
    start, end = (np.array(held.vertices[k], float) for k in (edge.start, edge.end))
    along = end - start
    left = np.array([-along[1], along[0]])
    points = [start + p[0] * along + p[1] * left for p in edge.params]
    if edge.curve == "quadratic":
        points = [start + 2 / 3 * (points[0] - start), end + 2 / 3 * (points[0] - end)]
    return np.array(points) * (1, -1) / code.per_metre


def _way(code: GarmentCode, side: tuple[str, int], names: dict[str, str], *, turned: bool) -> str:
    """The path of an edge in a pattern file's words; turned: from its end to its beginning."""
    edge = code.panels[side[0]].edges[side[1]]
    start, end = f"p{edge.start}", f"p{edge.end}"
    return f"{names[side[0]]}: " + (f"{end} < {start}" if turned else f"{start} > {end}")


def _length(code: GarmentCode, panel: str, number: int) -> float:
    """Of an edge [m] as the pattern file has it: an arc is a cubic there, and a little longer or shorter."""
    leg = code.leg(panel, number)
    if code.panels[panel].edges[number].curve != "line":
        leg = np.vstack([leg[0], *bezier_points([leg[0], *_controls(code, panel, number), leg[-1]])])
    return float(np.hypot(*np.diff(leg, axis=0).T).sum())


def _keys(names: list[str]) -> dict[str, str]:
    """Names as pattern files have them: lower case, digits and underscores, no two alike."""
    found: dict[str, str] = {}
    for name in names:
        key = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
        key = key if key[:1].isalpha() else f"panel_{key}".rstrip("_")
        number = 1
        while (made := key if number == 1 else f"{key}_{number}") in found.values():
            number += 1
        found[name] = made
    return found


def toml_text(tables: dict[str, Any]) -> str:
    """TOML of tables as `tomllib` gives them; raises TypeError for other values than text, numbers, lists, tables."""
    lines = [f"{_key(key)} = {_value(value)}" for key, value in tables.items() if not _is_table(key, value)]
    parts = ["\n".join(lines)]
    for key, value in tables.items():
        if _is_table(key, value):
            rows, head = (
                (value, f"[[{_key(key)}]]") if isinstance(value, list) else ([value], f"[{_key(key)}]")
            )
            parts += ["\n".join([head, *(f"{_key(k)} = {_rows(v)}" for k, v in row.items())]) for row in rows]
    return "\n\n".join(part for part in parts if part) + "\n"


def _is_table(key: str, value: Any) -> bool:
    if isinstance(value, list):
        return bool(value) and all(isinstance(row, dict) for row in value)
    return isinstance(value, dict) and key != "title"  # short enough for one line


def _rows(value: Any) -> str:
    """A list of tables one a line, anything else on one line."""
    if isinstance(value, list) and value and all(isinstance(row, dict) for row in value):
        return "[\n" + "".join(f"  {_value(row)},\n" for row in value) + "]"
    return _value(value)


def _key(key: Any) -> str:
    text = str(key)
    bare = bool(text) and all(c.isascii() and (c.isalnum() or c in "-_") for c in text)
    return text if bare else _text(text)


def _text(value: str) -> str:
    """A text in quotation marks; halves of signs beyond 16 bits, which no file can hold, become question marks."""
    whole = value.encode("utf-8", "replace").decode()
    return json.dumps(whole, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, int) or (isinstance(value, float) and math.isfinite(value)):
        return repr(value)
    if isinstance(value, list):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    if isinstance(value, dict):
        return (
            "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }" if value else "{}"
        )
    raise TypeError(f"{type(value).__name__} has no TOML")
