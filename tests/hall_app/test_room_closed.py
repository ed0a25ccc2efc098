"""The shipped room is closed: nowhere can a visitor look into a body, through a side that was left out."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from room_font import BLANK

from hall_app.content import load
from hall_app.content.floor import solids_of
from hall_app.light.rays import build_tree, cast
from hall_app.room import Frame, box, raise_room
from hall_app.room.parts import boards_of, furniture_of, signs_of
from hall_app.room.structure import Regions

ASSETS = Path(__file__).parents[2] / "assets"
BODY = 0.3  # [m] a visitor keeps from everything
EYES = (1.2, 1.6, 1.9)  # [m] above what a visitor stands on; the eye can be raised and lowered
NEAR, FAR = 24, 8  # eyes each face is looked at from: the nearest ones, and some of all
POINTS = 12  # on every face
DEEP = 0.05  # [m] a ring's open end before the shaft it lies on is nothing to look into
OFF = 1e-3  # [m] looked from a little behind the face, so that what touches it hides it


@pytest.fixture(scope="module")
def content():
    return load(ASSETS)


def eyes_of(content) -> np.ndarray:
    """(E, 3) [m] wherever on a grid of 0.4 m a visitor can stand."""
    floor = shapely.Polygon(content.plan.outline)
    taken = shapely.union_all([solid.shape() for solid in solids_of(content.plan, content.exhibits)])
    x0, z0, x1, z1 = floor.bounds
    x, z = (a.reshape(-1) for a in np.meshgrid(np.arange(x0, x1, 0.4), np.arange(z0, z1, 0.4)))
    free = shapely.contains(floor.buffer(-BODY).difference(taken.buffer(BODY)), shapely.points(x, z))
    rng = np.random.default_rng(2)
    return np.column_stack([x[free], rng.choice(EYES, free.sum()), z[free]])


def backs_seen(patches, eyes, count=None) -> list[tuple[str, tuple[float, ...]]]:
    """Material and place of faces whose backs some of the eyes see: they are not drawn, one looks through them.

    patches: everything that hides, of which the first `count` are looked at (None: all).
    """
    both = {patch.material for patch in patches if patch.two_sided}
    corners = np.concatenate([patch.vertices[patch.faces] for patch in patches])
    names = np.repeat([patch.material for patch in patches], [len(patch.faces) for patch in patches])
    tree = build_tree(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3).astype(np.int32))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rng = np.random.default_rng(1)
    faces = sum(len(patch.faces) for patch in patches[:count])
    middle = corners[:faces].mean(1)
    nearest = np.argsort(((middle[:, None, [0, 2]] - eyes[None, :, [0, 2]]) ** 2).sum(2), axis=1)[:, :NEAR]
    chosen = np.hstack([nearest, rng.integers(0, len(eyes), (faces, FAR))])
    face = np.repeat(np.arange(faces), chosen.shape[1])
    eye = eyes[chosen.reshape(-1)]
    behind = np.einsum("ij,ij->i", eye - middle[face], normals[face]) < 0
    single = ~np.isin(names, list(both))[face]
    face, eye = face[behind & single], eye[behind & single]
    face, eye = np.repeat(face, POINTS), np.repeat(eye, POINTS, axis=0)
    weights = 0.02 / 3 + 0.98 * rng.dirichlet([0.7, 0.7, 0.7], len(face))  # none on an edge
    point = np.einsum("ij,ijk->ik", weights, corners[face]) - OFF * normals[face]
    way = eye - point
    long = np.linalg.norm(way, axis=1)
    way /= long[:, None]
    _, distance, *_ = cast(tree, point, way)
    open_to = distance > long
    face, point, way = face[open_to], point[open_to], way[open_to]
    seen = np.unique(face[_room_behind(tree, normals, point, -way) > DEEP])
    return [(str(names[k]), tuple(np.round(middle[k], 2).tolist())) for k in seen]


def _room_behind(tree, normals, point, way) -> np.ndarray:
    """(N,) [m] from each point along its way to what is really drawn: the nearest face that looks back."""
    gone = np.zeros(len(point))
    under_way = np.arange(len(point))
    for _ in range(12):
        start = point[under_way] + (gone[under_way, None] + OFF) * way[under_way]
        hit, distance, *_ = cast(tree, start, way[under_way])
        gone[under_way] += np.minimum(distance, 100.0) + OFF
        through = (hit >= 0) & (np.einsum("ij,ij->i", normals[hit], way[under_way]) > 0)
        under_way = under_way[through]
    return gone


def test_nobody_looks_into_what_stands_on_the_floor(content):
    room = raise_room(content.plan, content.hall.title, content.exhibits, blank=BLANK)
    boards = boards_of(content.plan, Regions(content.plan), content.hall.title, content.exhibits)
    near = [*furniture_of(content.plan), *signs_of(boards, room.sheet)]
    assert backs_seen([*near, *room.patches], eyes_of(content), len(near)) == []


def test_an_open_box_is_found():
    frame, eyes = Frame(np.array([0.0, 2.4, 0.0])), np.array([[0.0, 1.6, 1.5]])
    whole = box(frame, (-0.5, 0, -0.05), (0.5, 0.05, 0.05), "lacquer")
    assert backs_seen(whole, eyes) == []
    opened = box(frame, (-0.5, 0, -0.05), (0.5, 0.05, 0.05), "lacquer", skip="bottom")
    assert backs_seen(opened, eyes) != []
