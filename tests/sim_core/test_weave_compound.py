"""Compound weaves at rest: hidden yarns lie beneath those that show, and all of them in the least energy there is."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize

from sim_core.weave import Weave, Yarn, solve
from sim_core.weave.draft import warp_compound, weft_compound
from sim_core.weave.yarns import beam_stiffness, strands

WEAVES = Path(__file__).parents[2] / "assets" / "weaves"
WARP = Yarn(80e-6, 3.6e-6, 3.0)
WEFT = Yarn(60e-6, 2.4e-6, 2.0)


def warp_woven(motif: np.ndarray, series: int) -> Weave:
    return Weave("jin", warp_compound(motif, series), WARP, WEFT, 4500.0 * series, 5000.0)


def stacked(weave: Weave) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of a warp-faced one: heights (series, units, picks) of the ends, which show, and which lie above their pick."""
    channels, heights = weave.draft.channels, solve(weave).warp_height
    series = 1 + int(channels.end_series.max())

    def by_unit(values: np.ndarray) -> np.ndarray:
        return values.T.reshape(-1, series, values.shape[0]).swapaxes(0, 1)

    return by_unit(heights), by_unit(channels.layer) == 0, by_unit(weave.draft.lift)


@pytest.mark.parametrize("series", [2, 3])
def test_what_shows_lies_over_what_is_hidden_and_touches_it_somewhere(series: int) -> None:
    weave = warp_woven(np.array([[0, 0, 1, 1], [0, 0, 1, 1], [1, 0, 0, 1], [1, 1, 0, 0]]), series)
    geometry = solve(weave)
    assert geometry.penetration < 1e-7 * WARP.height
    assert geometry.residual < 1e-6
    assert geometry.complementarity < 1e-6
    heights, shows, above = stacked(weave)
    nearest = np.inf
    for a, b in combinations(range(series), 2):
        one = above[a] == above[b]
        rise = np.where(shows[a], heights[a] - heights[b], heights[b] - heights[a])
        held = one & (shows[a] != shows[b])
        nearest = min(nearest, float(rise[held].min()))
    assert nearest == pytest.approx(WARP.height, rel=1e-6)
    sign = np.where(weave.draft.lift, 1.0, -1.0)
    # Picks are told at the ends' own places; at the middle of a unit they touch: of three, at the second.
    if series == 3:
        gap = (sign * (geometry.warp_height - geometry.weft_height))[:, 1::3]
        assert gap.min() == pytest.approx((WARP.height + WEFT.height) / 2, rel=1e-6)


@pytest.mark.parametrize("series", [4, 6, 8])
def test_many_series_settle_as_well_as_few(series: int) -> None:
    """Beyond a thousand steps the mode in which all yarns rise together is taken out: its rounding held at 1e-5."""
    motif = np.random.default_rng(series).integers(0, series, (8, 8))
    geometry = solve(warp_woven(motif, series))
    assert geometry.residual < 1e-6
    assert geometry.complementarity < 1e-6
    assert geometry.penetration < 1e-7 * WARP.height
    assert geometry.iterations < 3000


def test_it_is_the_least_energy_that_a_dense_search_finds() -> None:
    """The same beams with dense matrices and every inequality written out, by sequential quadratic programming."""
    weave = warp_woven(np.array([[0, 1], [1, 1], [0, 0], [1, 0]]), 2)
    heights, shows, above = stacked(weave)
    series, units, picks = heights.shape
    scale = (WARP.height + WEFT.height) / 2

    def circulant(stiffness: np.ndarray) -> np.ndarray:
        first = np.fft.ifft(stiffness).real
        return np.array([np.roll(first, k) for k in range(first.size)])

    along = circulant(beam_stiffness(picks, weave.pick_spacing, WARP.stiffness, WARP.tension))
    across = circulant(beam_stiffness(units, series * weave.end_spacing, WEFT.stiffness, WEFT.tension))
    largest = max(along.max(), across.max())
    many = series * units * picks
    whole = np.zeros((many + units * picks, many + units * picks))
    for line in range(series * units):
        own = slice(line * picks, (line + 1) * picks)
        whole[own, own] = along / largest
    for pick in range(picks):
        own = many + np.arange(units) * picks + pick
        whole[np.ix_(own, own)] = across / largest

    def stacked_at(s: int, u: int, i: int) -> int:
        return (s * units + u) * picks + i

    rows, least = [], []
    for u, i in np.ndindex(units, picks):
        for s in range(series):
            row = np.zeros(len(whole))
            row[stacked_at(s, u, i)], row[many + u * picks + i] = 1.0, -1.0
            rows.append(row if above[s, u, i] else -row)
            least.append(1.0)
        if above[0, u, i] == above[1, u, i]:
            row = np.zeros(len(whole))
            row[[stacked_at(0, u, i), stacked_at(1, u, i)]] = 1.0, -1.0
            rows.append(row if shows[0, u, i] else -row)
            least.append(WARP.height / scale)
    limits, room = np.array(rows), np.array(least)
    begin = np.linalg.lstsq(limits, 2.0 * room, rcond=None)[0]
    found = minimize(
        lambda x: 0.5 * x @ whole @ x,
        begin,
        jac=lambda x: whole @ x,
        constraints={"type": "ineq", "fun": lambda x: limits @ x - room, "jac": lambda x: limits},
        method="SLSQP",
        options={"maxiter": 2000, "ftol": 1e-13},
    )
    assert (limits @ found.x - room).min() > -1e-9
    dense = found.x[:many].reshape(series, units, picks) * scale
    dense += heights.mean() - dense.mean()  # bending leaves the whole cloth free to rise
    assert np.abs(heights - dense).max() < 1e-4 * WARP.height


def test_a_weft_faced_one_is_a_warp_faced_one_turned() -> None:
    motif = np.array([[0, 1], [1, 1], [0, 0], [1, 0]])
    ends = solve(warp_woven(motif, 2))
    turned = Weave("weijin", weft_compound(motif.T, 2), WEFT, WARP, 5000.0, 9000.0)
    picks = solve(turned)
    assert picks.weft_height - picks.weft_height.mean() == pytest.approx(
        (ends.warp_height - ends.warp_height.mean()).T, abs=1e-6 * WARP.height
    )
    assert picks.force == pytest.approx(ends.force.T, rel=1e-4, abs=1e-6 * ends.force.max())
    assert picks.weft_crimp == pytest.approx(ends.warp_crimp, rel=1e-5)


@pytest.mark.parametrize("name", ["jin", "weijin", "cloud-jin"])
def test_shipped_ones_show_their_face_and_keep_the_rest_within(name: str) -> None:
    weave = Weave.load(WEAVES / f"{name}.toml").cells[0]
    geometry = solve(weave)
    assert geometry.penetration < 1e-6 * weave.warp.height
    by_warp = weave.draft.channels.end_series is not None
    lines = strands(weave, geometry)[0 if by_warp else 1]
    height = geometry.warp_height if by_warp else geometry.weft_height
    hidden = weave.draft.channels.layer == 1
    top = height[~hidden].max()
    assert height[hidden].max() < top - 0.9 * lines.yarn.height
