"""A pattern file as a specification of GarmentCode: every half that is cut, legs as edges, seams as stitches.

The file's own tables (corner names, measures, dye) go along under "pattern_file", with a digest of panels and
stitches: while those are untouched, the way back gives the same pattern file.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path as FilePath
from typing import Any, NamedTuple

import numpy as np

from sim_core.garment.pattern import Pattern
from sim_core.garment.pattern.panels import Panel, Path, Seam, arc_length
from sim_core.mesh.outline import signed_area
from sim_core.mesh.sheets import CodeEdge, CodePanel, GarmentCode, Stitch, cubic_through
from sim_core.validation.files import read_toml

__all__ = ["code_of_pattern", "read_pattern_code"]

CENTIMETRES = 100.0
DIGITS = 10  # of a centimetre: what a pattern file says in millimetres comes back as it was
OTHER = "other"  # half of a mirrored garment
PROPERTIES = {
    "curvature_coords": "relative",
    "normalize_panel_translation": False,
    "normalized_edge_loops": True,
    "units_in_meter": 100,
}

Cuts = dict[tuple[str, int], list[float]]


class _Half(NamedTuple):
    """A panel in GarmentCode's axes. edges: number and whether it runs along the leg, by leg, in the leg's order."""

    panel: CodePanel
    edges: dict[int, list[tuple[int, bool]]]


def read_pattern_code(path: FilePath) -> GarmentCode:
    """The specification of a pattern file; raises FileProblem as `Pattern.load` does."""
    pattern = Pattern.load(path)
    return code_of_pattern(pattern, read_toml(path, "a pattern file (TOML)"))


def code_of_pattern(pattern: Pattern, tables: dict[str, Any] | None = None) -> GarmentCode:
    """The specification of a pattern, centimetres, edges counter-clockwise seen from the right side.

    tables: of its file, for the way back. Where one leg is sewn to several, it becomes as many edges.
    """
    panels = pattern.panels or (_plain_panel(pattern),)
    cuts = _cuts(panels, pattern.seams)
    there = [
        (panel, turned)
        for turned, side in ((False, "left"), (True, "right"))
        for panel in panels
        if (panel.is_of(side) if pattern.mirror else not turned)
    ]
    names = {(p.name, turned): _name(p, panels, turned=turned) for p, turned in there}
    halves = {names[panel.name, turned]: _half(panel, cuts, turned=turned) for panel, turned in there}
    known = {panel.name: panel for panel in panels}
    stitches: list[Stitch] = []
    for seam in pattern.seams:
        if seam.b is None:
            sides = [(seam.a, names[seam.a.panel, False]), (seam.a, names[seam.a.panel, True])]
            stitches += _stitches(sides, known, halves)
            continue
        for turned in (False, True):
            if all((way.panel, turned) in names for way in (seam.a, seam.b)):
                sides = [(way, names[way.panel, turned]) for way in (seam.a, seam.b)]
                stitches += _stitches(sides, known, halves)
    made = {name: half.panel for name, half in halves.items()}
    rest: dict[str, Any] = {"parameters": {}, "parameter_order": [], "properties": dict(PROPERTIES)}
    code = GarmentCode(made, tuple(stitches), CENTIMETRES, rest, {"panel_order": list(made)})
    if tables is not None:
        rest["pattern_file"] = {"digest": code.digest(), "tables": tables}
    return code


def _plain_panel(pattern: Pattern) -> Panel:
    """The one panel of a pattern that has no [[panel]]."""
    closed = np.vstack([pattern.outline, pattern.outline[:1]])
    legs = tuple(np.stack(pair) for pair in pairwise(closed))
    return Panel(pattern.name, tuple(f"p{k}" for k in range(len(legs))), legs)


def _name(panel: Panel, panels: tuple[Panel, ...], *, turned: bool) -> str:
    """What a panel, or its image, is called: a name that no other has."""
    if not turned or panel.side:
        return panel.name
    taken, name = {panel.name for panel in panels}, f"{panel.name}_{OTHER}"
    while name in taken:
        name += "_"
    return name


def _cuts(panels: tuple[Panel, ...], seams: tuple[Seam, ...]) -> Cuts:
    """Where single legs are cut since several are sewn to them: shares of the leg's parameter, by panel and leg."""
    known = {panel.name: panel for panel in panels}
    found: Cuts = {}
    for seam in seams:
        if seam.b is None:
            continue
        for one, many in ((seam.a, seam.b), (seam.b, seam.a)):
            numbers = known[one.panel].path(one.start, one.end, ahead=one.ahead)
            lengths = [arc_length(leg)[-1] for leg in many.legs(known[many.panel])]
            if len(numbers) == 1 < len(lengths):
                shares = np.cumsum(lengths)[:-1] / np.sum(lengths)
                leg = known[one.panel].legs[numbers[0]]
                arc = arc_length(leg)
                along = shares if one.ahead else 1 - shares[::-1]
                at = np.interp(along * arc[-1], arc, np.linspace(0, 1, len(leg)))
                found[one.panel, numbers[0]] = at.tolist()
    return found


def _half(panel: Panel, cuts: Cuts, *, turned: bool) -> _Half:
    """A panel as it is drawn, or turned over about x = 0."""
    scale = np.array([-CENTIMETRES if turned else CENTIMETRES, -CENTIMETRES])
    runs: list[tuple[int, np.ndarray]] = []
    for number, leg in enumerate(panel.legs):
        ends = [0.0, *cuts.get((panel.name, number), []), 1.0]
        runs += [(number, _part(leg, a, b) * scale) for a, b in pairwise(ends)]
    ahead = bool(signed_area(panel.outline()) > 0) != turned
    if not ahead:
        runs = [(number, points[::-1]) for number, points in reversed(runs)]
    vertices = tuple(_rounded(points[0]) for _, points in runs)
    edges = tuple(_edge(k, points, len(runs)) for k, (_, points) in enumerate(runs))
    by_leg: dict[int, list[tuple[int, bool]]] = {}
    for k, (number, _) in enumerate(runs):
        by_leg.setdefault(number, []).append((k, ahead))
    if not ahead:
        by_leg = {number: found[::-1] for number, found in by_leg.items()}
    return _Half(CodePanel(vertices, edges, {"translation": [0, 0, 0], "rotation": [0, 0, 0]}), by_leg)


def _part(leg: np.ndarray, a: float, b: float) -> np.ndarray:
    """Ends (2, 2) of a straight leg between two shares, or the control points (4, 2) of a cubic one."""
    if len(leg) == 2:
        return np.stack([leg[0] + a * (leg[1] - leg[0]), leg[0] + b * (leg[1] - leg[0])])
    points = np.vstack([leg[:1], cubic_through(leg, np.linspace(0, 1, len(leg))), leg[-1:]])
    return points if (a, b) == (0.0, 1.0) else np.array([_blossom(points, *t) for t in _blends(a, b)])


def _blends(a: float, b: float) -> tuple[tuple[float, float, float], ...]:
    return (a, a, a), (a, a, b), (a, b, b), (b, b, b)


def _blossom(points: np.ndarray, r: float, s: float, t: float) -> np.ndarray:
    """The polar form of a cubic: (a, a, b) and so on give the control points of its part from a to b (Ramshaw 1987)."""
    for share in (r, s, t):
        points = points[:-1] + share * np.diff(points, axis=0)
    return points[0]


def _rounded(point: np.ndarray) -> tuple[float, float]:
    x, y = (round(float(v), DIGITS) + 0.0 for v in point)  # + 0: no minus before a nought
    return x, y


def _edge(number: int, points: np.ndarray, count: int) -> CodeEdge:
    ends = (number, (number + 1) % count)
    if len(points) == 2:
        return CodeEdge(*ends)
    start, *controls, end = (complex(*_rounded(point)) for point in points)
    shares = [(control - start) / (end - start) for control in controls]
    return CodeEdge(*ends, "cubic", tuple((share.real, share.imag) for share in shares))


def _stitches(
    sides: list[tuple[Path, str]], known: dict[str, Panel], halves: dict[str, _Half]
) -> list[Stitch]:
    """Stitches of a seam, first point to first point."""
    rows = []
    for way, name in sides:
        row: list[tuple[int, bool]] = []
        for leg in known[way.panel].path(way.start, way.end, ahead=way.ahead):
            found = halves[name].edges[leg]
            row += [(k, ahead == way.ahead) for k, ahead in (found if way.ahead else found[::-1])]
        rows.append(row)
    names = [name for _, name in sides]
    return [
        Stitch((names[0], a), (names[1], b), right_wrong=along_a == along_b)
        for (a, along_a), (b, along_b) in zip(*rows, strict=True)
    ]
