"""Lines of a drawing sorted into pieces: outline, seam, holes, inner lines, notches and grain of each."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from sim_core.mesh.sheets.model import Piece, Sheet
from sim_core.mesh.sheets.pieces.contours import GENERIC, Contour, contours, owner_of, piece_name, seam_inside
from sim_core.mesh.sheets.pieces.scribbles import is_scribble
from sim_core.mesh.sheets.pieces.sizes import graded_apart, size_layers, size_of
from sim_core.mesh.sheets.strokes.joining import joined
from sim_core.mesh.sheets.strokes.stroke import Stroke
from sim_core.mesh.sheets.strokes.words import (
    NEVER_CLOSED,
    Role,
    furnishes,
    layer_name,
    names_piece,
    role_of,
    speaks,
    spoken,
)

__all__ = ["SCRIBBLES", "sorted_sheet"]

SCRIBBLES = "lines that cross themselves all over"  # as they are told
NEAR = 0.005  # [m] a mark may lie outside its piece
TOUCHES, APART = 5e-4, 0.003  # [m] from a notch to the outline; between two notches
SHORT = 0.015, 0.05  # [m] most of a notch, and of its piece's diagonal
SLENDER = 8  # how many times longer than wide a filled arrow is
LEAST, HAIR = 0.6, 1e-6  # of a cutting line's area: least of its seam's; [m]
LEAST_WIDE = 0.02  # [m] of what may be a piece though its layer speaks of marks
STYLE = re.compile(r"(cls|st|fil|str|style|s|c)?[-_]?\d+", re.IGNORECASE)  # classes that a program made up
ARROW = 0.05  # of its piece's diagonal: least length of a filled arrow


def sorted_sheet(strokes: list[Stroke], *, apparel: bool = False, layer: str = "") -> Sheet:
    """The pieces that lines make; see `Piece` and `Sheet`. A line is what its layer, class or group says (`words`);
    one that says nothing is an outline where it is closed and outermost, a hole where it lies in one, a seam where it
    follows one, and an inner line where it is open. apparel: numbers of layers are certainly those of AAMA or ASTM.
    layer: outlines of other layers and sizes are passed over before any is sorted."""
    remarks: list[str] = []
    left_out: Counter[str] = Counter()
    numbered = _numbered(strokes, apparel=apparel)
    sizes = {} if numbered else size_layers(stroke.layer for stroke in strokes)
    strokes = _of_layer(strokes, layer.lower(), sizes, numbered=numbered) if layer else strokes
    outlines: list[tuple[Stroke, Role]] = []
    others: list[tuple[Stroke, Role]] = []
    for stroke in joined(strokes, remarks):
        role: Role = role_of(stroke.layer, stroke.words, numbered=numbered)
        if _may_be_piece(stroke, role):
            outlines.append((stroke, "mark"))
        elif role in ("mark", "hidden"):
            left_out[_called(stroke, role, numbered=numbered)] += 1
        elif _may_close(stroke, role) and is_scribble(stroke.points):
            left_out[SCRIBBLES] += 1
        elif _may_close(stroke, role):
            outlines.append((stroke, role))
        else:
            others.append((stroke, role))
    outlines = _around(outlines, left_out)
    outermost = contours(outlines, remarks, left_out, sizes)
    drafts = _paired([_Draft(contour) for contour in graded_apart(outermost, remarks)])
    others = _cut_on_fold(drafts, others, remarks)
    for draft in drafts:
        draft.take(left_out)
    _assign(drafts, others, left_out)
    names = _named(drafts)
    pieces = tuple(draft.piece(name) for draft, name in zip(drafts, names, strict=True))
    return Sheet(pieces, dict(left_out), tuple(remarks))


def _of_layer(strokes: list[Stroke], layer: str, sizes: dict[str, str], *, numbered: bool) -> list[Stroke]:
    """Lines of a layer, and of others those that say what they are to a piece of its size."""
    own = {stroke.layer for stroke in strokes if stroke.layer.lower() == layer}
    if not own:
        return strokes  # a material, or told as unknown
    size = {sizes.get(name, "") for name in own}
    return [
        stroke
        for stroke in strokes
        if stroke.layer in own
        or (not stroke.layer and not stroke.closed)
        or (
            role_of(stroke.layer, stroke.words, numbered=numbered)
            and sizes.get(stroke.layer, "") in {"", *size}
        )
    ]


def _numbered(strokes: list[Stroke], *, apparel: bool) -> bool:
    """Whether layers are numbers of AAMA or ASTM: a boundary or a sew line on its own layer, and, unless texts say so,
    no outline on those for points. (Sizes of one piece may lie on layers 1, 2, 3.)"""
    if not {stroke.layer.strip() for stroke in strokes} & {"1", "14"}:
        return False
    return apparel or not any(
        stroke.closed and stroke.layer.strip() in NEVER_CLOSED and _wide(stroke) for stroke in strokes
    )


def _wide(stroke: Stroke) -> bool:
    return bool(np.ptp(stroke.points, axis=0).min() > LEAST_WIDE)


def _may_be_piece(stroke: Stroke, role: Role) -> bool:
    """Whether a mark may be a piece, its layer named after both, such as "BUTTON PLACKET"."""
    words = spoken(stroke.layer)
    plain = role in ("mark", "notch", "grain", "fold") and stroke.words == words and not furnishes(words)
    return (
        plain
        and len(stroke.points) > 2
        and stroke.closed
        and not stroke.filled
        and _wide(stroke)
        and names_piece(stroke.layer)
    )


def _called(stroke: Stroke, role: Role, *, numbered: bool) -> str:
    if role == "hidden":
        return "hidden (visibility)"
    return layer_name(stroke.layer, numbered=numbered) or stroke.name or "text drawn as outlines"


def _may_close(stroke: Stroke, role: Role) -> bool:
    """Whether a line may be an outline: closed, or a cutting line that goes around most of a piece."""
    if role not in ("", "cut", "sew", "hole", "inner") or len(stroke.points) < 3 or stroke.filled:
        return False
    if stroke.closed:
        return True
    steps = np.hypot(*np.diff(stroke.points, axis=0).T)
    gap = float(np.hypot(*(stroke.points[0] - stroke.points[-1])))
    width, height = np.ptp(stroke.points, axis=0)
    area = shapely.Polygon(stroke.points).area
    if role in ("sew", "") and area > 0.2 * width * height and gap < 0.005 * steps.sum():
        return True  # one that misses its start by a rounding
    return role == "cut" and gap < 0.8 * steps.sum() and area > 0.2 * width * height > 0


def _around(outlines: list[tuple[Stroke, Role]], left_out: Counter[str]) -> list[tuple[Stroke, Role]]:
    """Outlines without open cutting lines that, closed straight, hold no seam of their group whole."""
    seams: dict[tuple[str, ...], list] = {}
    for stroke, role in outlines:
        if stroke.closed and role == "sew":
            shape = shapely.make_valid(shapely.Polygon(stroke.points))
            if shape.area > 0:
                seams.setdefault(owner_of(stroke), []).append(shape)
    trees = {owner: shapely.STRtree(some) for owner, some in seams.items()}
    kept = []
    for stroke, role in outlines:
        if not stroke.closed and role == "cut" and (tree := trees.get(owner_of(stroke))) is not None:
            shape = shapely.make_valid(shapely.Polygon(stroke.points))
            met = tree.geometries[tree.query(shape, predicate="intersects")]
            shares = shapely.area(shapely.intersection(shape, met)) / shapely.area(met)
            if not (shares > 0.97).any() or ((shares > 0.1) & (shares < 0.97)).any():
                left_out["cut lines along a part of a piece"] += 1
                continue
        kept.append((stroke, role))
    return kept


class _Draft:
    """A piece in the making."""

    def __init__(self, contour: Contour) -> None:
        self.contour = contour
        self.seam = seam_inside(contour)
        self.holes: list[np.ndarray] = []
        self.lines: list[np.ndarray] = []
        self.notches: dict[tuple[int, int], np.ndarray] = {}
        self.edge = shapely.boundary(contour.shape)
        self.diagonal = float(np.hypot(*np.ptp(contour.stroke.points, axis=0)))
        shapely.prepare(self.edge)
        self.grain: np.ndarray | None = None
        self.fold: np.ndarray | None = None

    def take(self, left_out: Counter[str]) -> None:
        """Sort what lies inside the outline."""
        for inner in [*self.contour.inside, *(self.seam.inside if self.seam else [])]:
            if inner is self.seam:
                continue
            points = inner.stroke.points
            if inner.role == "hole" or (inner.role == "" and not inner.stroke.dashed):
                self.holes.append(points)
            else:
                self.lines.append(np.vstack([points, points[:1]]))
            left_out["closed lines within holes"] += len(inner.inside)
        left_out += Counter()

    def may_lie_within(self, area: float) -> bool:
        """Whether the outline may be the sewing line of a piece of that area [m2]."""
        return self.seam is None and self.contour.role in ("", "sew") and self.contour.area > LEAST * area

    def take_around(self, outer: Contour) -> None:
        """Lie within a cutting line that was found around it."""
        self.seam, self.contour = self.contour, outer
        self.edge = shapely.boundary(outer.shape)
        shapely.prepare(self.edge)

    def put(self, stroke: Stroke, role: Role, length: float, left_out: Counter[str]) -> None:
        """Take an open line or a mark as what it is. length: [m] of the line."""
        points = stroke.points
        if len(points) > 1 and self.fold is None and (role == "fold" or "cutonfold" in stroke.words):
            self.fold = points[[0, -1]]
        if role == "fold":
            return
        ends = shapely.distance(self.edge, shapely.points(points[[0, -1]]))
        short = len(points) > 1 and length < min(SHORT[0], SHORT[1] * self.diagonal) and ends.min() < TOUCHES
        if role == "notch" or (role == "" and (len(points) == 1 or short)):
            place = (points.min(axis=0) + points.max(axis=0)) / 2
            if not stroke.closed and len(points) > 1:
                place = points[0 if ends[0] <= ends[1] else -1]
            cell = (round(place[0] / APART), round(place[1] / APART))
            self.notches.setdefault(cell, place)
        elif (role == "grain" and len(points) > 1) or (role == "" and stroke.filled and self._arrow(points)):
            if self.grain is None:
                longest = int(np.argmax(np.hypot(*np.diff(points, axis=0).T)))  # not the heads of its arrow
                self.grain = points[longest : longest + 2]
        elif role == "cut":
            left_out["cut lines along a part of a piece"] += 1
        elif len(points) > 1 and not stroke.filled:
            self.lines.append(np.vstack([points, points[:1]]) if stroke.closed else points)

    def _arrow(self, points: np.ndarray) -> bool:
        """Whether a filled area is a grain line with its heads: long as no letter is, and slender."""
        return float(np.hypot(*np.ptp(points, axis=0))) > ARROW * self.diagonal and _slender(points)

    def piece(self, name: str) -> Piece:
        stroke, seam = self.contour.stroke, self.seam
        only_sewn = self.contour.role == "sew"
        return Piece(
            name,
            self.contour.material or stroke.layer,
            None if only_sewn else stroke.points,
            stroke.points if only_sewn else seam.stroke.points if seam else None,
            tuple(self.holes),
            tuple(self.lines),
            np.array(list(self.notches.values())).reshape(-1, 2),
            self.grain,
            self.fold,
        )


def _paired(drafts: list[_Draft]) -> list[_Draft]:
    """A seam that leaves its cutting line a little is still its seam: outlines of one group that cover each other."""
    cuts: dict[tuple[str, ...], list[_Draft]] = {}
    for draft in drafts:
        if draft.contour.role == "cut" and draft.seam is None:
            cuts.setdefault(draft.contour.owner, []).append(draft)
    trees = {owner: shapely.STRtree([cut.contour.shape for cut in some]) for owner, some in cuts.items()}
    gone = set()
    for draft in drafts:
        contour = draft.contour
        if contour.role not in ("sew", "") or contour.owner not in cuts:
            continue
        for k in sorted(trees[contour.owner].query(contour.shape, predicate="intersects").tolist()):
            cut = cuts[contour.owner][k]
            if contour.size != cut.contour.size:
                continue
            if cut.seam is None and contour.material in ("", cut.contour.material):
                shared = shapely.intersection(cut.contour.shape, contour.shape).area
                if shared > 0.8 * contour.area and shared > 0.4 * cut.contour.area:
                    cut.seam = contour
                    gone.add(id(draft))
                    break
    return [draft for draft in drafts if id(draft) not in gone]


def _cut_on_fold(
    drafts: list[_Draft], lines: list[tuple[Stroke, Role]], remarks: list[str]
) -> list[tuple[Stroke, Role]]:
    """Lines that say nothing, but those that run around a piece at the distance of an allowance and end at its fold:
    closed straight, they are its cutting line, and the outline that lay there is its sewing line."""
    tree = shapely.STRtree([draft.contour.shape for draft in drafts])
    kept = []
    for stroke, role in lines:
        around = _goes_around(stroke) if role == "" and not stroke.filled and len(stroke.points) > 3 else None
        inside = [drafts[k] for k in tree.query(around, predicate="covers").tolist()] if around else []
        area = float(around.area) if around else 0.0
        mine = [draft for draft in inside if draft.may_lie_within(area)]
        outer = Contour(replace(stroke, closed=True), "cut", area, around, "", owner_of(stroke))
        outer.inside += [draft.contour for draft in mine]
        if len(mine) == 1 and seam_inside(outer) is mine[0].contour:
            mine[0].take_around(outer)
            name = piece_name(outer.owner) or "a piece"
            remarks.append(f"{name}: an open line around it is taken for its cut line")
        else:
            kept.append((stroke, role))
    return kept


def _goes_around(stroke: Stroke) -> Any:
    """The area of an open line closed straight, grown by a hair, or None where it is none."""
    steps = np.hypot(*np.diff(stroke.points, axis=0).T)
    gap = float(np.hypot(*(stroke.points[0] - stroke.points[-1])))
    shape = shapely.Polygon(stroke.points)
    if (
        gap > 0.8 * steps.sum()
        or not shape.is_valid
        or shape.area < 0.2 * np.ptp(stroke.points, axis=0).prod()
    ):
        return None
    return shapely.buffer(shape, HAIR, join_style="mitre")


def _assign(drafts: list[_Draft], lines: list[tuple[Stroke, Role]], left_out: Counter[str]) -> None:
    """Give open lines and marks to the pieces they lie on: of their own group first, then the smallest one."""
    shapes = np.array([draft.contour.shape for draft in drafts], object)
    areas = np.array([draft.contour.area for draft in drafts])
    numbers: dict[tuple[str, ...], int] = {}  # of owners
    owner = np.array([numbers.setdefault(draft.contour.owner, len(numbers)) for draft in drafts], int)
    deep = np.array([len(name) for name in numbers], int)
    size = np.array([draft.contour.size for draft in drafts])
    sizes = {draft.contour.stroke.layer: draft.contour.size for draft in drafts}
    tree = shapely.STRtree(shapes)
    for stroke, role in lines:
        line = (
            shapely.LineString(stroke.points) if len(stroke.points) > 1 else shapely.Point(stroke.points[0])
        )
        near = tree.query(line.centroid, predicate="dwithin", distance=NEAR)
        if not near.size:
            left_out[f"{stroke.layer or 'lines'} outside every piece"] += 1
            continue
        mine = owner_of(stroke)
        own = [numbers[mine[:k]] for k in range(len(mine) + 1) if mine[:k] in numbers]
        other = (
            size[near] != sizes.get(stroke.layer, "")
            if sizes.get(stroke.layer)
            else np.zeros(len(near), bool)
        )
        foreign = ~np.isin(owner[near], own) + 2 * (other & (size[near] != ""))
        far = shapely.distance(shapes[near], line.centroid)
        best = np.lexsort((near, areas[near], far, -deep[owner[near]], foreign))[0]
        drafts[near[best]].put(stroke, role, line.length, left_out)


def _slender(points: np.ndarray) -> bool:
    box = shapely.minimum_rotated_rectangle(shapely.MultiPoint(points))
    if not isinstance(box, shapely.Polygon):
        return True
    corners = np.array(box.exterior.coords)
    sides = np.hypot(*np.diff(corners[:3], axis=0).T)
    return bool(sides.max() > SLENDER * sides.min())


def _named(drafts: list[_Draft]) -> list[str]:
    """A name for each piece, no two alike: its group's or block's, else its own, else its layer's where layers tell
    pieces apart, with its material; else piece-1, …"""
    layers = {draft.contour.stroke.layer for draft in drafts}
    names: list[str] = []
    for draft in drafts:
        contour = draft.contour
        own = contour.stroke.name if not speaks(contour.stroke.name) else ""
        layer = contour.stroke.layer if len(layers) > 1 or len(drafts) == 1 else ""
        layer = "" if speaks(layer) or STYLE.fullmatch(layer) or layer.lower() in GENERIC else layer
        size = size_of(contour.owner[-1]) if contour.owner else ""
        name = piece_name(contour.owner[: -1 if size else None]) or own
        if name and (size := size or contour.size):
            name += f"-{size}"
        name = name or piece_name(contour.owner) or layer or "piece"
        if contour.material not in ("", "fabric") and contour.material not in name.lower():
            name += f"-{contour.material}"
        names.append(" ".join(name.split()))
    counted = Counter(names)
    seen: Counter[str] = Counter()
    taken = set(names)
    for k, name in enumerate(names):
        if counted[name] == 1 and name != "piece":
            continue
        while True:
            seen[name] += 1
            made = name if seen[name] == 1 and name != "piece" else f"{name}-{seen[name]}"
            if made == name or made not in taken:
                break
        names[k] = made
        taken.add(made)
    return names
