"""Words and pictures in the hall: labels before exhibits, boards over the rooms' doors, plaque, banners, scrolls."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hall_app.content.files import file_problem
from hall_app.room.patch import Frame, Patch, box, quad, strip, tube
from hall_app.room.structure.frame import beams_of, columns_of
from hall_app.room.structure.regions import Regions
from hall_app.room.surface.lettering import SCROLLS, Sheet, Writing

if TYPE_CHECKING:
    from hall_app.content.folder import Exhibit
    from hall_app.content.schema import Bay, Bilingual, PlanFile, Sign

__all__ = ["OUT", "PIXELS", "Board", "boards_of", "signs_of"]

Floats = NDArray[np.float64]
_LABEL, _SMALL = (0.52, 0.17), (0.36, 0.13)  # [m]
_POST = 0.92  # [m] height of a label's middle above the floor or the booth it stands on
_POST_RADIUS = 0.011  # [m]
_ASKEW = 20.0  # [deg] from its booth's front, beyond which an exhibit faces across it
OUT = {"plaque": 0.10, "banner": 0.04, "picture": 0.04}  # [m] a sign hangs before its wall
PIXELS = {"label": 1000, "plaque": 330, "banner": 330, "board": 340, "picture": 310}  # per metre


@dataclass(frozen=True, slots=True)
class Board:
    """A writing in its place. frame: its middle, z out of its front; size [m]; tilt [deg]: how far its head leans
    back (not 0 above a post); post: height [m] of the post below it, 0: none."""

    writing: Writing
    frame: Frame
    size: tuple[float, float]
    tilt: float
    post: float = 0.0


def boards_of(
    plan: PlanFile, regions: Regions, title: Bilingual, exhibits: Iterable[Exhibit], folder: Path = Path()
) -> list[Board]:
    """Everything that is written in the hall, and the pictures that hang in it, whose files lie in `folder`."""
    boards = [_hung(sign, title, folder) for sign in plan.sign]
    boards += [board for bay in plan.bay if (board := _over_the_door(bay, plan, regions))]
    shown = tuple(exhibits)
    crowd = Counter(exhibit.file.place.on for exhibit in shown)
    return boards + [_label(exhibit, plan, alone=crowd[exhibit.file.place.on] == 1) for exhibit in shown]


def _writing(kind, zh: str, en: str, size: Sequence[float], picture: Path | None = None) -> Writing:
    scale = PIXELS[kind]
    wide, high = (max(1, round(side * scale)) for side in size)
    return Writing(kind, zh, en, (wide, high), picture)


def _hung(sign: Sign, title: Bilingual, folder: Path) -> Board:
    zh, en = (sign.text, "") if sign.text else (title.zh, title.en)
    picture = _file(folder, sign.picture) if sign.picture else None
    frame = Frame.on_floor(sign.at, sign.facing, sign.height).moved(z=OUT[sign.kind])
    tilt = -8.0 if sign.kind == "plaque" else 0.0
    return Board(_writing(sign.kind, zh, en, sign.size, picture), frame, sign.size, tilt)


def _file(folder: Path, path: str) -> Path | None:
    """Where a picture lies; None where there is none of the folder's own, and its scroll stays empty."""
    lost = file_problem("plan.toml", "picture", folder, path, root=folder)
    return None if lost else folder / path


def _label(exhibit: Exhibit, plan: PlanFile, *, alone: bool) -> Board:
    """alone: whether nothing else stands on the exhibit's booth."""
    place, title = exhibit.file.place, exhibit.file.title
    solid = next((solid for solid in plan.solid if solid.id == place.on), None)
    if solid is not None and solid.round is not None:
        radius = solid.round.radius
        frame = Frame.on_floor((solid.round.x, solid.round.z), place.facing)
        frame = frame.moved(y=max(solid.height - 0.22, 0.3), z=0.80 * radius + 0.035)
        return Board(_writing("label", title.zh, title.en, _SMALL), frame, _SMALL, 20.0)
    if solid is not None and solid.size is not None and solid.at is not None:
        frame = _on_booth(exhibit, Frame.on_floor(solid.at, solid.facing), solid.size, alone=alone)
        frame = frame.moved(y=solid.height + _POST)
    else:
        foot = place.y if place.y is not None else (solid.height if solid else 0.0)
        frame = Frame.on_floor((place.x, place.z), place.facing, foot + _POST)
        body = exhibit.file.body
        if body.size is not None:
            frame = frame.moved(x=body.size[0] / 2 - 0.05, z=body.size[1] / 2 - 0.04)
        else:
            reach = (body.radius or 0.3) - 0.04
            frame = frame.moved(x=0.57 * reach, z=0.82 * reach)
    return Board(_writing("label", title.zh, title.en, _LABEL), frame, _LABEL, 42.0, _POST)


def _on_booth(exhibit: Exhibit, booth: Frame, size: tuple[float, float], *, alone: bool) -> Frame:
    """Where a label's post stands on a booth, its floor at y = 0: at the right end of its front; of several exhibits
    to the right of each; and where one faces across the booth, at the corner to its right, where it hides nothing."""
    (wide, deep), place, body = size, exhibit.file.place, exhibit.file.body
    across = (place.facing - booth.facing + 180.0) % 360.0 - 180.0
    if abs(across) > _ASKEW:
        corners = booth([(x * (wide / 2 - 0.2), 0.0, z * (deep / 2 - 0.2)) for x in (-1, 1) for z in (-1, 1)])
        right = Frame.on_floor((place.x, place.z), place.facing).axes[0]
        return Frame(corners[np.argmax(corners @ right)], place.facing)
    end = wide / 2 - 0.36
    if not alone:
        stands = float((np.array([place.x, 0.0, place.z]) - booth.at) @ booth.axes[0])
        reach = body.size[0] / 2 if body.size is not None else body.radius or 0.3
        end = min(end, stands + reach + 0.2)
    return booth.moved(x=end, z=deep / 2 - 0.14)


def _over_the_door(bay: Bay, plan: PlanFile, regions: Regions) -> Board | None:
    """A name board over the widest opening between a bay and the greater one beside it, facing that one."""
    import shapely

    here = shapely.Polygon(bay.polygon)
    rank = (plan.height_over(bay), here.area)
    best, side = None, None
    for other in plan.bay:
        shape = shapely.Polygon(other.polygon)
        if other.id == bay.id or (plan.height_over(other), shape.area) <= rank:
            continue
        for gap in _gaps(here, shape, plan):
            if gap.length > 1.2 and (best is None or gap.length > best.length):
                best, side = gap, shape
    if best is None or side is None:
        return None
    a, b = np.asarray(best.coords)[[0, -1]]
    along = (b - a) / np.linalg.norm(b - a)
    out = np.array([-along[1], along[0]])
    middle = (a + b) / 2
    if not side.contains(shapely.Point(middle + 0.05 * out)):
        out = -out
    facing = float(np.degrees(np.arctan2(out[0], out[1])))
    depth, height = _lintel(middle, plan, regions)
    size = (1.3, 0.40)
    frame = Frame.on_floor(middle + (depth + 0.05) * out, facing, height)
    return Board(_writing("board", bay.name.zh, bay.name.en, size), frame, size, -7.0)


def _gaps(here, other, plan: PlanFile) -> list:
    """Open stretches of the border between two bays."""
    import shapely

    shared = shapely.line_merge(here.boundary.intersection(other.boundary))
    shut = [shapely.LineString([w.start, w.end]).buffer(w.thickness / 2 + 0.02) for w in plan.wall]
    shut += [shapely.Point(column.at).buffer(column.half) for column in columns_of(plan)]
    open_parts = shared.difference(shapely.union_all(shut))
    return [piece for piece in shapely.get_parts(open_parts) if piece.geom_type == "LineString"]


def _lintel(middle: Floats, plan: PlanFile, regions: Regions) -> tuple[float, float]:
    """How far before the border a board hangs, and its height [m]: on the beam over the opening, if there is one."""
    import shapely

    spot = shapely.Point(middle)
    for beam in beams_of(plan, regions):
        if shapely.LineString([beam.start, beam.end]).distance(spot) < 0.1:
            return beam.width / 2, (beam.low + beam.high) / 2
    return 0.0, (regions.height_at(float(middle[0]), float(middle[1])) or plan.height) - 0.6


def signs_of(boards: Sequence[Board], sheet: Sheet) -> list[Patch]:
    """Plates, frames, rods and posts of all boards, with their pictures from the sheet."""
    patches: list[Patch] = []
    for board, place in zip(boards, sheet.places, strict=True):
        patches += _plate(board, place)
        if board.writing.kind in SCROLLS:
            patches += _rods(board)
        if board.post:
            patches += _post(board)
    return patches


def _thickness(board: Board) -> float:
    """Of its plate [m]."""
    return 0.004 if board.writing.kind in SCROLLS else {"label": 0.012}.get(board.writing.kind, 0.05)


def _post(board: Board) -> list[Patch]:
    """A round foot and a rod, cut at the slant of the plate it carries: it ends within the plate's thickness."""
    foot = board.frame.moved(y=-board.post)
    angle = 2 * np.pi * np.arange(9) / 8
    low = np.column_stack([np.sin(angle), np.zeros(9), np.cos(angle)]) * _POST_RADIUS
    low[:, 1] = 0.02 - board.post
    high, tilt = low.copy(), np.radians(board.tilt)
    high[:, 1] = -(_thickness(board) / 2 + low[:, 2] * np.cos(tilt)) / np.sin(tilt)
    rod = strip(board.frame(low), board.frame(high), "gold", grain=1)
    return [*tube(foot, [(0.10, 0.0), (0.10, 0.012), (0.01, 0.024)], "gold", sides=16), rod]


def _plate(board: Board, place: tuple[float, float, float, float]) -> list[Patch]:
    """The tilted board: its picture in front, lacquer or brass round it."""
    wide, high = board.size
    thick = _thickness(board)
    material = "gold" if board.writing.kind == "label" else "lacquer"
    tilt = np.radians(board.tilt)
    lean = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    level = Frame(np.zeros(3))
    patches = []
    for patch in box(level, (-wide / 2, -high / 2, -thick), (wide / 2, high / 2, 0), material):
        patches.append(replace(patch, vertices=board.frame(patch.vertices @ lean)))
    x0, y0, x1, y1 = place
    uv = np.array([[x0, y1], [x1, y1], [x1, y0], [x0, y0]])
    face = quad(patches[0].vertices, "signs", uv=uv)
    return [face] if board.writing.kind in SCROLLS else [face, *patches[1:]]  # paper has no edge to see


def _rods(board: Board) -> list[Patch]:
    wide, high = board.size
    patches = []
    for y in (-high / 2 - 0.015, high / 2 - 0.015):
        patches += box(
            board.frame,
            (-wide / 2 - 0.05, y, -0.02),
            (wide / 2 + 0.05, y + 0.03, 0.014),
            "lacquer",
            skip="back",
        )
    return patches
