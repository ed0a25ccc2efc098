"""A garment on a wearer who stands, and on one given by vertices frame by frame."""

from dataclasses import replace

import numpy as np
import pytest

from sim_core import metrics
from sim_core.body import Beneath, Surface
from sim_core.cloth import (
    Capsule,
    Contact,
    HalfSpace,
    Holds,
    Live,
    Material,
    Phase,
    Sheet,
    drape,
    moving_mesh,
)
from sim_core.cloth.contact import solid_mesh
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.errors import SimCoreError
from sim_core.garment import Garment, Settled, follow, garment_sheet
from sim_core.garment.dressing import capped

CLOTH = Material(0.05, 50.0, 0.3, 2e-5, 0.5, 1.0)
CONTACT = Contact(0.004, 0.001, speed_limit=4.0)
RADIUS = 0.1


@pytest.fixture(scope="module")
def ball() -> tuple[np.ndarray, np.ndarray]:
    return solid_mesh(Capsule((0.0, 0.0, 0.0), (0.0, 0.02, 0.0), RADIUS), 24)


@pytest.fixture(scope="module")
def veil(ball) -> Garment:
    """A cloth laid on the ball as a garment with two panels."""
    rest, faces = equilateral_sheet(0.3, 0.3, 0.03)
    start = np.column_stack([rest[:, 0] - 0.15, np.full(len(rest), RADIUS + 0.03), rest[:, 1] - 0.15])
    body = moving_mesh(ball[0][None], ball[1], cell=0.01)
    phases = [Phase(0.4, (0.0, 9.81), 6.0), Phase(0.6, damping=8.0)]
    worn = drape(Sheet.of(rest, faces, CLOTH), start, phases, collider=body, contact=CONTACT)
    material = {"density": 0.05, "stretch": 50.0, "bend": 2e-5, "friction": 0.5, "choices": {}}
    return Garment(
        name="veil",
        pattern=rest,
        pattern_faces=faces.astype(np.int32),
        weld=np.arange(len(rest), dtype=np.int32),
        panel=(rest[faces].mean(1)[:, 0] > 0.15).astype(np.int32),
        positions=worn.positions,
        panels=("left", "right"),
        dyes=(None, None),
        cut={"panels": [{"name": "left"}, {"name": "right"}]},
        material={
            "kinds": {"thin": material, "thick": {**material, "density": 0.1}},
            "panels": {"left": "thin", "right": "thick"},
        },
    )


def inside(positions: np.ndarray, garment: Garment, body: np.ndarray, faces: np.ndarray) -> int:
    found = metrics.penetration(positions, garment.faces, body, faces)
    return found.vertices + found.midpoints + found.centroids


def test_panels_keep_their_materials(veil: Garment) -> None:
    sheet = garment_sheet(veil)
    a, b = (veil.rest_corners()[:, k] - veil.rest_corners()[:, 0] for k in (1, 2))
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert sheet.mass.sum() == pytest.approx(area @ np.array([0.05, 0.10])[veil.panel])


def test_on_a_wearer_who_stands_it_stays(veil: Garment, ball) -> None:
    end = follow(veil, ball[0][None], ball[1], seconds=0.4, contact=CONTACT)
    assert inside(end.positions, veil, *ball) == 0
    assert np.linalg.norm(end.positions - veil.positions, axis=1).max() < 0.03
    assert end.frames == 10


def test_it_goes_with_a_wearer_given_frame_by_frame(veil: Garment, ball) -> None:
    """Up by 12 cm and turned, then still: the veil is carried, and is never inside."""
    t = np.linspace(0, 1, 21)
    rise = 0.12 * t * t * (3 - 2 * t)
    body = ball[0][None] + rise[:, None, None] * np.array([0.0, 1.0, 0.0])
    seen: list[int] = []

    def heard(index: int, x: np.ndarray) -> None:
        seen.append(inside(x.astype(float), veil, body[min(index + 1, 20)], ball[1]))

    end = follow(veil, body, ball[1], seconds=0.2, contact=CONTACT, on_frame=heard)
    assert seen == [0] * 25
    top = body[-1][:, 1].max()
    assert top - 0.015 < end.positions[:, 1].max() < top + 0.015  # carried: its edges are 3 cm, the ball 10
    again = follow(veil, body, ball[1], seconds=0.2, contact=CONTACT)
    assert again.positions.tobytes() == end.positions.tobytes()


@pytest.fixture(scope="module")
def shawl(veil: Garment, ball) -> Garment:
    """The veil's cloth once more, laid over the veil on the ball, and told of both."""
    under = Surface(*capped(veil.positions, veil.faces), thicker=0.004)
    lain = Beneath((Surface(*ball), under), cell=0.01)
    start = veil.worn() + [0.0, 0.02, 0.0]
    phases = [Phase(0.3, (0.0, 9.81), 6.0), Phase(0.5, damping=8.0)]
    worn = drape(garment_sheet(veil), start, phases, collider=lain.solid(), contact=CONTACT)
    settled = Settled(CONTACT, phases[-1], Holds.of(len(start)), lain, even=False)
    return replace(veil, name="shawl", positions=worn.positions, settled=settled)


def test_a_cloth_over_a_cloth_goes_with_both(veil: Garment, shawl: Garment, ball) -> None:
    """Up by 10 cm: the shawl lies on the veil as that goes with the ball, and is never inside of it."""
    t = np.linspace(0, 1, 16)
    body = ball[0][None] + (0.1 * t * t * (3 - 2 * t))[:, None, None] * np.array([0.0, 1.0, 0.0])
    frames = [veil.positions]
    follow(veil, body, ball[1], contact=CONTACT, on_frame=lambda index, x: frames.append(x.astype(float)))
    inner, seen = np.stack(frames), []

    def heard(index: int, x: np.ndarray) -> None:
        seen.append(inside(x.astype(float), shawl, *capped(inner[index + 1], veil.faces)))

    assert inside(shawl.positions, shawl, *capped(veil.positions, veil.faces)) == 0
    end = follow(shawl, body, ball[1], beneath=[inner], on_frame=heard)
    assert seen == [0] * 15
    assert end.positions[:, 1].max() > inner[-1][:, 1].max() + 0.003

    def told(**more) -> str:
        with pytest.raises(SimCoreError) as caught:
            follow(shawl, body, ball[1], **more)
        return str(caught.value)

    assert "was settled over 1 other(s) – give beneath=" in told()
    assert "beneath holds 2 garment(s)" in told(beneath=[inner, inner])
    assert "expected (16, V, 3)" in told(beneath=[inner[:3]])
    assert "100.0 mm from where" in told(beneath=[inner + [0.0, 0.1, 0.0]])
    still = follow(
        shawl, ball[0][None], ball[1], seconds=0.12
    )  # who stands still keeps what he wears where it is
    assert inside(still.positions, shawl, *capped(veil.positions, veil.faces)) == 0


def test_a_floor_stands_beside_the_wearer(veil: Garment, ball) -> None:
    floor = HalfSpace((0.0, float(veil.positions[:, 1].min()) - 0.01, 0.0))
    body = ball[0][None] - np.linspace(0, 0.08, 11)[:, None, None] * np.array([0.0, 1.0, 0.0])
    free, stopped = (follow(veil, body, ball[1], contact=CONTACT, beside=solid) for solid in (None, floor))
    assert free.positions[:, 1].min() < floor.point[1] - 0.03
    assert stopped.positions[:, 1].min() > floor.point[1]


def test_hands_stay_hulls_where_a_figure_moves(veil: Garment, ball) -> None:
    """Two balls are one hand: nothing comes between them, as where the garment was settled."""
    second = ball[0] + [0.0, 0.0, 0.3]
    vertices, faces = np.concatenate([ball[0], second]), np.concatenate([ball[1], ball[1] + len(second)])
    hand = Surface(vertices, faces, (np.arange(len(vertices), dtype=np.int32),))
    settled = Settled(
        CONTACT, Phase(0.2), Holds.of(len(veil.positions)), Beneath((hand,), cell=0.01), even=False
    )
    between = replace(veil, positions=veil.positions + [0.0, 0.12, 0.15], settled=settled)
    body = np.stack([vertices, vertices])
    low = [
        follow(it, body, faces, seconds=0.4, contact=CONTACT).positions[:, 1].min()
        for it in (between, replace(between, settled=None))
    ]
    assert low[0] > low[1] + 0.05
    with pytest.raises(SimCoreError, match="whose hands are known by number"):
        follow(between, body[:, :-1], faces)


def test_live_mode_follows_a_body_too(veil: Garment, ball) -> None:
    body = ball[0][None] + np.linspace(0, 0.03, 4)[:, None, None] * np.array([0.0, 1.0, 0.0])
    live = Live(
        garment_sheet(veil), veil.positions, collider=moving_mesh(body, ball[1], cell=0.01), contact=CONTACT
    )
    for key in (1.0, 2.0, 3.0):
        x = live.step(body=key)
        assert inside(x, veil, body[int(key)], ball[1]) == 0


def test_what_cannot_be_followed_is_told_before_anything_runs(veil: Garment, ball) -> None:
    vertices, faces = ball
    heard: list[int] = []

    def told(body: np.ndarray, faces: np.ndarray, **more) -> str:
        with pytest.raises(SimCoreError) as caught:
            follow(veil, body, faces, on_frame=lambda index, x: heard.append(index), **more)
        return str(caught.value)

    body = np.stack([vertices, vertices])
    words = told(body, faces[1:])
    assert "open or ill-wound at 3 edges" in words
    assert "between vertices" in words
    assert "\n" not in words
    assert "frame 1 has vertices that are not finite" in told(np.stack([vertices, vertices * np.nan]), faces)
    assert "expected (T, V, 3)" in told(vertices, faces)
    assert "for how many seconds" in told(vertices[None], faces, contact=CONTACT)
    assert "does not say how it touches" in told(body, faces)
    assert "beside without a wearer" in told(None, None, beside=HalfSpace())  # type: ignore[arg-type]
    assert "faces without a wearer" in told(None, faces)  # type: ignore[arg-type]
    bare = Garment(**{**veil.__dict__, "material": {}})
    with pytest.raises(SimCoreError, match="material is not told"):
        garment_sheet(bare)
    assert not heard
