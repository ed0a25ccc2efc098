"""The room as geometry: it follows the plan, faces outwards, unrolls without stretching, and stands in its solids."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from room_font import BLANK

from hall_app.content import load
from hall_app.content.floor import solids_of
from hall_app.content.schema import PlanFile
from hall_app.room import raise_room
from hall_app.room.lighting import charts_of
from hall_app.room.parts import boards_of, signs_of
from hall_app.room.structure import Regions, beams_of
from hall_app.room.surface import MATERIALS, Sheet

ASSETS = Path(__file__).parents[2] / "assets"
HEAD = 2.0  # [m] nobody walks into what hangs above
PROUD = 0.065  # [m] rails and feet may stand out of their solid: a visitor keeps 0.3 m from it

PLAIN = {
    "outline": [[-5, -4], [5, -4], [5, 4], [-5, 4]],
    "height": 4.0,
    "bay": [
        {"id": "all", "name": {"zh": "厅", "en": "Hall"}, "polygon": [[-5, -4], [5, -4], [5, 4], [-5, 4]]}
    ],
}
OLD_PLANS = {
    "nothing but a floor": {},
    "an L with a round column": {
        "outline": [[-5, -4], [5, -4], [5, 0], [0, 0], [0, 4], [-5, 4]],
        "solid": [{"id": "c", "kind": "column", "height": 4, "round": {"x": -2, "z": -2, "radius": 0.3}}],
    },
    "odd footprints": {
        "solid": [
            {"id": "a", "kind": "booth", "height": 0.2, "polygon": [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]},
            {"id": "b", "kind": "stand", "height": 1.0, "size": [0.5, 0.5], "at": [-2, 0], "facing": 30},
            {"id": "c", "kind": "bench", "height": 0.5, "round": {"x": -3, "z": 2, "radius": 0.4}},
            {"id": "d", "kind": "column", "height": 4, "polygon": [[3, 2], [3.5, 2], [3.5, 2.5], [3, 2.5]]},
            {"id": "e", "kind": "rope", "height": 0.9, "size": [0.3, 1.4], "at": [-3.5, -1]},
        ]
    },
    "low and inner walls": {
        "wall": [
            {"from": [-2, 0], "to": [2, 0], "height": 1.0},
            {"from": [0, -4], "to": [0, -1], "height": 2.5},
            {"from": [2, 1], "to": [2, 4], "kind": "lattice", "height": 3.0},
        ],
        "opening": [{"kind": "window", "from": [0, -3.4], "to": [0, -2.2], "sill": 1.0, "height": 1.2}],
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def content():
    return load(ASSETS)


@pytest.fixture(scope="module")
def shipped(content):
    return raise_room(content.plan, content.hall.title, content.exhibits, blank=BLANK)


def plan_of(**changes) -> PlanFile:
    return PlanFile.model_validate({**PLAIN, **changes})


@pytest.fixture(scope="module", params=["shipped", *OLD_PLANS])
def room(request, shipped, content):
    if request.param == "shipped":
        return shipped
    return raise_room(plan_of(**OLD_PLANS[request.param]), content.hall.title, (), blank=BLANK)


def corners_of(patch) -> np.ndarray:
    return patch.vertices[patch.faces]


def areas(corners: np.ndarray) -> np.ndarray:
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    cross = np.cross(a, b) if corners.shape[-1] == 3 else (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])[:, None]
    return np.linalg.norm(cross, axis=1) / 2


def test_no_triangle_without_area(room):
    assert min(areas(corners_of(patch)).min() for patch in room.patches) > 1e-8


def test_every_patch_unrolls_without_stretching(room):
    for patch in room.patches:
        for a, b in ((0, 1), (1, 2), (2, 0)):
            solid = np.linalg.norm(
                patch.vertices[patch.faces[:, a]] - patch.vertices[patch.faces[:, b]], axis=1
            )
            flat = np.linalg.norm(patch.flat[patch.faces[:, a]] - patch.flat[patch.faces[:, b]], axis=1)
            assert np.allclose(solid, flat, atol=2e-6), patch.material


def test_charts_begin_at_zero_and_do_not_fold(room):
    charts = charts_of(room.patches)
    low = np.full((len(charts.density), 2), np.inf)
    for number, flat, patch in zip(charts.chart, charts.flat, room.patches, strict=True):
        low[number] = np.minimum(low[number], flat.min(0))
        turned = flat[patch.faces]
        a, b = turned[:, 1] - turned[:, 0], turned[:, 2] - turned[:, 0]
        signs = np.sign(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        assert abs(signs.sum()) == len(signs), patch.material
    assert np.allclose(low, 0.0)
    assert (charts.density > 0).all()


def test_patches_of_one_chart_lie_in_one_plane(room):
    charts = charts_of(room.patches)
    planes: dict[int, tuple[np.ndarray, float]] = {}
    for number, patch in zip(charts.chart, room.patches, strict=True):
        if patch.chart is None:
            continue
        corners = corners_of(patch)[0]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal /= np.linalg.norm(normal)
        known, offset = planes.setdefault(int(number), (normal, float(normal @ corners[0])))
        assert np.allclose(normal, known)
        assert np.abs(patch.vertices @ known - offset).max() < 1e-6


def test_no_wall_has_two_charts_of_plaster_in_one_plane(shipped):
    """A seam would show where one wall's chart ends and the next begins."""
    seen: list[tuple[np.ndarray, float, object]] = []
    for patch in shipped.patches:
        if patch.material != "plaster" or np.ptp(patch.flat, axis=0).max() < 3.0:
            continue
        corners = corners_of(patch)[0]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal /= np.linalg.norm(normal)
        across = [axis for axis in (0, 2) if abs(normal[axis]) < 0.5][0]
        reach = shapely.box(
            patch.vertices[:, across].min(), patch.vertices[:, 1].min(),
            patch.vertices[:, across].max(), patch.vertices[:, 1].max(),
        )  # fmt: skip
        for other, offset, span in seen:
            if np.allclose(normal, other) and abs(float(normal @ corners[0]) - offset) < 1e-3:
                assert shapely.intersection(reach, span).area < 1e-6
                assert shapely.distance(reach, span) > 1e-3
        seen.append((normal, float(normal @ corners[0]), reach))
    assert len(seen) >= 4


def test_what_can_be_walked_into_is_a_solid_of_the_plan(shipped, content):
    solids = shapely.union_all(
        [solid.shape() for solid in solids_of(content.plan, content.exhibits)]
        + [shapely.Polygon(content.plan.outline).exterior]
    ).buffer(PROUD)
    for patch in shipped.patches:
        low = patch.vertices[(patch.vertices[:, 1] > 0.02) & (patch.vertices[:, 1] < HEAD)]
        floor = shapely.Polygon(content.plan.outline)
        spots = shapely.points(low[:, [0, 2]])
        lost = low[~shapely.intersects(solids, spots) & shapely.contains(floor, spots)]
        assert not len(lost), f"{patch.material} at {np.round(lost[:3], 2).tolist()}"


def test_every_solid_of_the_plan_is_drawn(shipped, content):
    points = np.concatenate([patch.vertices for patch in shipped.patches if patch.material != "floor"])
    spots = shapely.points(points[:, [0, 2]])
    for solid in solids_of(content.plan, ()):
        inside = shapely.intersects(solid.shape().buffer(0.02), spots)
        assert points[inside, 1].max() > 0.75 * min(solid.height, HEAD), solid.id


def test_boxes_and_turned_bodies_face_outwards():
    from hall_app.room import Frame, box, disc, prism, tube

    frame = Frame(np.array([2.0, 1.0, -3.0]), 35.0)
    bodies = [
        box(frame, (-1, 0, -0.5), (1, 2, 0.5), "wood"),
        prism(frame.moved(y=1), [(-1, -1), (1, -1), (1.2, 0), (0, 1)], 0.4, "wood"),
        tube(frame, [(0.5, 0), (0.8, 1), (0.4, 2)], "wood")
        + disc(frame.moved(y=2), 0.4, "wood")
        + disc(frame, 0.5, "wood", up=False),
    ]
    for body in bodies:
        points = np.concatenate([corners_of(patch) for patch in body])
        middle = np.concatenate([patch.vertices for patch in body]).mean(0)
        normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        outward = np.einsum("fi,fi->f", normals, points.mean(1) - middle)
        assert (outward > 0).all()


def test_surfaces_look_into_the_hall(shipped, content):
    """Floor up, ceilings and laylights down; plaster towards the floor it belongs to."""
    floor = shapely.Polygon(content.plan.outline)
    for patch in shipped.patches:
        corners = corners_of(patch)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        if patch.material == "floor":
            assert np.allclose(normal[:, 1], 1)
        elif patch.material in ("ceiling", "laylight"):
            assert np.allclose(normal[:, 1], -1)
        elif patch.material == "plaster" and np.ptp(patch.flat, axis=0).max() > 3:  # no window's reveal
            before = corners.mean(1) + 0.3 * normal
            assert shapely.contains(floor, shapely.points(before[:, [0, 2]])).all()


def test_nave_is_higher_and_closed_above_the_rooms(shipped, content):
    ceilings = {round(float(p.vertices[:, 1].max()), 3) for p in shipped.patches if p.material == "ceiling"}
    assert ceilings == {content.plan.height, content.plan.nave_height}
    plaster = np.concatenate([p.vertices for p in shipped.patches if p.material == "plaster"])
    assert plaster[:, 1].max() == pytest.approx(content.plan.nave_height)


def test_beams_follow_the_columns(content):
    beams = beams_of(content.plan, Regions(content.plan))
    spots = {solid.at for solid in content.plan.solid if solid.kind == "column"}
    assert all(beam.start in spots for beam in beams)
    assert sum(beam.arcade for beam in beams) == 8
    moved = content.plan.model_copy(
        update={"solid": tuple(s for s in content.plan.solid if s.id != "column-3")}
    )
    assert len(beams_of(moved, Regions(moved))) < len(beams)


def test_a_changed_plan_gives_a_changed_room(content):
    title = content.hall.title
    few = raise_room(plan_of(), title, (), blank=BLANK)
    lantern = raise_room(plan_of(lantern=[{"at": [0, 0]}]), title, (), blank=BLANK)
    light = raise_room(plan_of(laylight=[{"at": [0, 0], "size": [2, 2]}]), title, (), blank=BLANK)
    high = raise_room(plan_of(height=6.0), title, (), blank=BLANK)
    assert {p.material for p in lantern.patches} - {p.material for p in few.patches} >= {"lantern"}
    assert {p.material for p in light.patches} - {p.material for p in few.patches} >= {"laylight"}
    tops = [max(float(p.vertices[:, 1].max()) for p in room.patches) for room in (few, high)]
    assert tops == pytest.approx([4.0, 6.0])


def test_windows_are_holes_before_glowing_paper(shipped, content):
    """Behind each window's bars lies its paper, and no plaster in between."""
    windows = [opening for opening in content.plan.opening if opening.kind == "window"]
    paper = [p for p in shipped.patches if p.material == "paper"]
    assert len(paper) == len(windows) + sum(o.kind == "door" for o in content.plan.opening)
    low = [window for window in windows if window.sill < content.plan.height]
    for patch in paper:
        if patch.vertices[:, 1].min() < content.plan.height:
            behind = np.abs(patch.vertices[:, 2]).min() - 8.0
            assert 0.04 < behind < 0.2
    for opening in low:
        x, z = np.mean([opening.start, opening.end], axis=0)
        y = opening.sill + opening.height / 2
        for patch in shipped.patches:
            if (
                patch.material == "plaster"
                and np.ptp(patch.vertices[:, 2]) < 1e-6
                and abs(patch.vertices[0, 2] - z) < 0.3
            ):
                for triangle in corners_of(patch)[:, :, :2]:
                    assert not shapely.contains(shapely.Polygon(triangle), shapely.Point(x, y))


def test_materials_are_few_and_lamps_glow(shipped):
    used = {patch.material for patch in shipped.patches}
    assert used <= set(MATERIALS)
    assert len(used) <= 18  # as many draw calls
    assert {name for name in used if MATERIALS[name].glow} == {"laylight", "paper", "lantern"}


def test_every_label_is_seen_and_hides_no_exhibit(content):
    """None stands at another's place, nor between its exhibit and who looks at it from the front."""
    boards = boards_of(content.plan, Regions(content.plan), content.hall.title, content.exhibits)
    labels = [board for board in boards if board.writing.kind == "label"]
    at = np.array([board.frame.at for board in labels])
    apart = np.linalg.norm(at[:, None] - at, axis=2) + 9 * np.eye(len(at))
    assert apart.min() > 0.6
    for exhibit, board in zip(content.exhibits, labels, strict=True):
        place = exhibit.file.place
        if not board.post:
            continue
        turn = np.radians(place.facing)
        x, z = board.frame.at[0] - place.x, board.frame.at[2] - place.z
        aside, before = x * np.cos(turn) - z * np.sin(turn), x * np.sin(turn) + z * np.cos(turn)
        assert aside > 0.4 or before < 0.0, exhibit.id
        assert np.hypot(aside, before) < 2.5, exhibit.id


def test_a_label_hides_the_end_of_its_post(content):
    """The post reaches into the plate it carries, and not through it."""
    regions = Regions(content.plan)
    boards = boards_of(content.plan, regions, content.hall.title, content.exhibits)
    posts = [board for board in boards if board.post]
    assert posts
    for board in posts:
        (patches,) = [signs_of([board], Sheet(np.zeros((8, 8, 3), np.uint8), ((0.0, 0.0, 1.0, 1.0),)))]
        plate = patches[0].vertices
        front = np.cross(plate[1] - plate[0], plate[3] - plate[0])
        front /= np.linalg.norm(front)
        post = max((p for p in patches if p.material == "gold"), key=lambda p: np.ptp(p.vertices[:, 1]))
        depth = (post.vertices - plate[0]) @ front  # [m] before the plate's face
        assert np.ptp(post.vertices[:, 1]) > 0.8
        assert depth.max() < -0.002
        assert depth.max() > -0.012
        top = np.sort(depth)[-8:]
        assert np.ptp(top) < 1e-6  # cut at the plate's slant: no gap on one side
