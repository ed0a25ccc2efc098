"""Patches about coarse vertices: exact on cubics, nearly a fit's inverse, turned with the cloth; what balance lacks."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from sim_core.cloth.sheet import energies
from sim_core.errors import SimCoreError
from sim_core.learn.convolution import depthwise, depthwise_gradients, spirals
from sim_core.learn.data import STIFFNESS, Pair, Recipe
from sim_core.learn.patches import CUBIC, SEEN, Imbalance, Patches, Surroundings
from sim_core.learn.upsampling import tangent_frames


@cache
def pair() -> Pair:
    return Pair.of(Recipe("hanging", 1, 7, 2, 0, coarse=90, fine=340))


@cache
def patches() -> Patches:
    return Patches.of(pair().coarse.rest, pair().coarse.faces, pair().fine.rest)


def level() -> np.ndarray:
    """Frames of a sheet that lies in its rest plane."""
    return np.broadcast_to(np.eye(3), (patches().count, 3, 3))


def test_one_cubic_in_all_patches_is_that_cubic() -> None:
    made, rng = patches(), np.random.default_rng(0)
    flat, fine = pair().coarse.rest / made.length, pair().fine.rest / made.length
    cubic = (
        rng.normal(0, 1, (4, 4, 3)) * np.array([[i + j <= 3 for j in range(4)] for i in range(4)])[..., None]
    )
    about = np.zeros((made.count, CUBIC, 3))
    for place, (i, j) in enumerate(
        [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)]
    ):
        slope = cubic
        for axis, times in ((0, i), (1, j)):
            for _ in range(times):
                slope = np.polynomial.polynomial.polyder(slope, axis=axis)
        factor = np.prod(np.arange(1, i + 1)) * np.prod(np.arange(1, j + 1))
        about[:, place] = np.polynomial.polynomial.polyval2d(*flat.T, slope).T / factor
    wanted = np.polynomial.polynomial.polyval2d(*fine.T, cubic).T
    assert np.abs(made.displaced(about, level()) - wanted).max() < 1e-5 * np.abs(wanted).max()


def test_patches_that_were_fitted_give_back_what_is_smooth() -> None:
    made, (x, y) = patches(), pair().fine.rest.T / patches().length
    smooth = np.column_stack([np.sin(0.5 * x), np.cos(0.4 * y + x), np.sin(0.6 * (x - y))])
    back = made.displaced(made.fitted(smooth, level()), level())
    assert np.abs(back - smooth).mean() < 0.03


def test_patches_turn_with_the_cloth() -> None:
    made, rng = patches(), np.random.default_rng(1)
    bent = np.column_stack([pair().coarse.rest, 0.05 * np.sin(7 * pair().coarse.rest[:, 0])])
    turn = tangent_frames(pair().coarse.rest, pair().coarse.faces).of(bent)
    about, fine = rng.normal(0, 1, (made.count, CUBIC, 3)), rng.normal(0, 1, (len(pair().fine.rest), 3))
    whole = Rotation.from_rotvec([0.4, -2.0, 0.9]).as_matrix()
    turned = whole @ turn
    assert made.displaced(about, turned) == pytest.approx(made.displaced(about, turn) @ whole.T, abs=1e-4)
    assert made.fitted(fine @ whole.T, turned) == pytest.approx(made.fitted(fine, turn), rel=1e-3, abs=0.02)
    assert made.carried(fine, turn, turned) == pytest.approx(fine @ whole.T, abs=1e-5)
    with pytest.raises(SimCoreError, match="rest_fine: shape"):
        Patches.of(pair().coarse.rest, pair().coarse.faces, fine)


def test_depthwise_weighs_every_channel_by_itself() -> None:
    rng, faces = np.random.default_rng(2), pair().coarse.faces
    order = spirals(faces, 7, pair().coarse.rest)
    features, weights = rng.normal(0, 1, (len(order), 5)), rng.normal(0, 1, (7, 5))
    assert depthwise(features, order, weights) == pytest.approx(
        np.einsum("vkc,kc->vc", features[order], weights)
    )
    upon = rng.normal(0, 1, features.shape)
    of_features, of_weights = depthwise_gradients(features, order, weights, upon)
    for place, gradient in enumerate((of_features, of_weights)):
        given = [features, weights]
        step = rng.normal(0, 1, given[place].shape)
        given[place] = step  # it is linear in either
        assert (depthwise(given[0], order, given[1]) * upon).sum() == pytest.approx((step * gradient).sum())


def test_nothing_is_missing_where_the_led_sheet_is_at_rest() -> None:
    """Against a minimiser of the energy that the accelerations are of."""
    sheets = pair()
    coarse = np.column_stack([sheets.coarse.rest, 0.08 * np.sin(5 * sheets.coarse.rest[:, 0])])
    made = Imbalance.of(replace(sheets, pins=((), ())))
    shared, start = made.shared(coarse), sheets.base @ coarse
    mass, led = sheets.fine.mass[:, None], (sheets.spread.T @ sheets.fine.mass)[:, None]

    def energy(flat: np.ndarray) -> tuple[float, np.ndarray]:
        fine = flat.reshape(-1, 3)
        off = sheets.mean @ (fine - sheets.spread @ coarse)
        stretch, bend, _ = energies(sheets.fine.stencil, fine, np.zeros_like(fine))
        held = 0.5 * STIFFNESS * (led * off * off).sum()
        wanted, _ = made.ways(fine, coarse, shared)
        total = stretch + bend + held + (mass * shared * fine).sum()
        return 1e6 * total, -1e6 * (mass * wanted / made.ease).ravel()

    found = minimize(
        energy,
        start.ravel(),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": 3000, "ftol": 0.0, "gtol": 1e-3},
    )
    ways, means = made.ways(found.x.reshape(-1, 3), coarse, shared)
    before, means_before = made.ways(start, coarse, shared)
    assert np.abs(ways).max() < 0.02 * np.abs(before).max()
    assert np.abs(means).max() < 0.05 * np.abs(means_before).max()


def test_pins_want_to_go_nowhere() -> None:
    sheets = pair()
    coarse = np.column_stack([sheets.coarse.rest, 0.08 * np.sin(5 * sheets.coarse.rest[:, 0])])
    made = Imbalance.of(replace(sheets, pins=((0, 5), (0, 9))))
    ways, _ = made.ways(sheets.base @ coarse, coarse, made.shared(coarse))
    assert (ways[[0, 9]] == 0).all()
    assert (np.abs(ways).max(1) > 0).sum() == len(ways) - 2


def test_what_a_vertex_sees_stays_when_the_sheet_is_moved_and_turned() -> None:
    sheet, rng = pair().coarse, np.random.default_rng(4)
    made = Surroundings.of(sheet.rest, sheet.faces, (0, 3))
    flat = np.column_stack([sheet.rest, np.zeros(len(sheet.rest))])
    turn, seen = made.seen(flat, flat, flat)
    assert np.abs(seen[:, :-3]).max() < 1e-6  # a sheet at rest sees nothing but flags
    assert turn == pytest.approx(np.broadcast_to(np.eye(3), turn.shape), abs=1e-6)
    assert seen[:, -3].sum() == 2
    bent = np.column_stack([sheet.rest, 0.05 * np.sin(7 * sheet.rest[:, 0])])
    films = [bent + rng.normal(0, 0.002, bent.shape) for _ in range(3)]
    whole = Rotation.from_rotvec([0.4, -2.0, 0.9]).as_matrix()
    turn, seen = made.seen(*films)
    turned, again = made.seen(*(film @ whole.T + [3.0, -1.0, 7.0] for film in films))
    assert again == pytest.approx(seen, abs=2e-6)
    assert turned == pytest.approx(whole @ turn, abs=2e-6)
    assert np.abs(seen[:, -9:-3]).max() > 0.01
    assert seen.shape == (len(bent), SEEN)
    with pytest.raises(SimCoreError, match="before"):
        made.seen(bent, bent[:-1], bent)
    with pytest.raises(SimCoreError, match="coarse"):
        made.seen(np.full_like(bent, np.nan), bent, bent)
