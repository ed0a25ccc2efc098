"""Analytic anchors: catenary, heavy elastica, string and strip frequencies, energy over long times, capstan, drape."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from sim_core.cloth import Air, Contact, Cylinder, Material, Phase, Sheet, drape
from sim_core.cloth.run import Live
from sim_core.cloth.scenes import drape_coefficient, equilateral_sheet, scene
from sim_core.cloth.sheet import edge_tensions, energies, vertex_forces
from sim_core.cloth.step import Engine, first_mode

G = 9.81


def strip(length: float, width: float, edge: float, material: Material) -> Sheet:
    """A strip along x; its ends are straight."""
    rest, faces = equilateral_sheet(width, length, edge)
    return Sheet.of(rest[:, ::-1].copy(), faces, material)


def middle_line(sheet: Sheet, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rest coordinates along the strip (N,) and mean positions (N, 3) of its cross rows."""
    along = np.round(sheet.rest[:, 0], 9)
    rows = np.unique(along)
    return rows, np.stack([x[along == r].mean(0) for r in rows])


@pytest.mark.parametrize("edges", [35, 50])
def test_hanging_chain_is_the_catenary(edges: int) -> None:
    """y = a cosh(x / a) between two pinned ends 0.8 of its length apart; within 0.5 % of the length at h = L/50."""
    length, span, width = 1.0, 0.8, 0.06
    stiff = Material(0.2, 2e4, 0.0, 1e-9, mass_damping=0.0, stiffness_damping=2e-6)
    sheet = strip(length, width, length / edges, stiff)
    a = brentq(lambda c: 2 * c * math.sinh(span / (2 * c)) - length, 0.05, 5)
    s = sheet.rest[:, 0] - length / 2
    x = a * np.arcsinh(s / a)
    exact = np.column_stack([x, a * np.cosh(x / a) - a * math.cosh(span / (2 * a)), sheet.rest[:, 1]])
    # From an arc of the chain's length: a start stretched here and crushed there may end with a vertex flipped over.
    arc = brentq(lambda r: 2 * r * math.sin(length / (2 * r)) - span, 0.4, 5)
    turn = s / arc
    start = np.column_stack(
        [arc * np.sin(turn), arc * (math.cos(length / (2 * arc)) - np.cos(turn)), sheet.rest[:, 1]]
    )
    ends = np.flatnonzero(np.abs(np.abs(s) - length / 2) < 1e-9)
    start[ends] = exact[ends]
    end = drape(sheet, start, [Phase(2.4, damping=8.0)], pins=ends.tolist())
    off = np.linalg.norm(end.positions - exact, axis=1)[:, None]
    assert end.rest_max < 2e-4
    assert off.max() < (0.005 if edges >= 50 else 0.02) * length


def elastica(b: float, rho: float, length: float) -> np.ndarray:
    """Heavy elastica B th'' + rho g (L - s) cos th = 0, th(0) = 0, th'(L) = 0: points (401, 2), th downwards."""
    s = np.linspace(0, length, 401)
    found = solve_bvp(
        lambda s, y: np.stack([y[1], -rho * G * (length - s) / b * np.cos(y[0])]),
        lambda p, q: np.array([p[0], q[1]]),
        s,
        np.stack([np.pi / 2 * s / length, np.full_like(s, np.pi / 2 / length)]),
        tol=1e-6,
        max_nodes=20_000,
    )
    th = found.sol(s)[0]
    step = s[1] - s[0]
    x = np.r_[0, np.cumsum(0.5 * step * (np.cos(th[1:]) + np.cos(th[:-1])))]
    y = np.r_[0, np.cumsum(0.5 * step * (np.sin(th[1:]) + np.sin(th[:-1])))]
    return np.column_stack([x, -y])


@pytest.mark.slow
@pytest.mark.parametrize("load", [1.0, 8.0])
def test_cantilever_bends_as_the_heavy_elastica(load: float) -> None:
    """rho g L^3 / B = load: the whole curve within 0.3 % of the length of one that begins between the two rows held.

    Pins hold places and no slopes, so where between them the clamp sits is not said.
    """
    length, rho = 0.1, 0.15
    b = rho * G * length**3 / load
    cloth = Material(rho, 3e3, 0.0, b, mass_damping=0.0, stiffness_damping=1e-5)
    sheet = strip(length, 0.04, length / 20, cloth)
    curve = elastica(b, rho, length)
    s = np.linspace(0, length, 401)
    at = np.column_stack([np.interp(sheet.rest[:, 0], s, curve[:, k]) for k in (0, 1)])
    start = np.column_stack([at, sheet.rest[:, 1]])
    first = np.sort(np.unique(np.round(sheet.rest[:, 0], 9)))[:2]
    held = np.flatnonzero(sheet.rest[:, 0] <= first[1] + 1e-9)
    start[held] = np.column_stack([sheet.rest[held, 0], np.zeros(len(held)), sheet.rest[held, 1]])
    end = drape(sheet, start, [Phase(1.4, damping=25.0)], pins=held.tolist())
    rows, line = middle_line(sheet, end.positions)

    def error(clamp: float) -> float:
        free = elastica(b, rho, length - clamp)
        s = np.linspace(0, length - clamp, 401)
        expected = np.column_stack([np.interp(rows[1:] - clamp, s, free[:, k]) for k in (0, 1)])
        return float(np.linalg.norm(line[1:, :2] - expected - [clamp, 0], axis=1).max())

    assert end.rest_max < 1e-5
    assert min(map(error, np.linspace(0.0, first[1], 11))) < 0.003 * length


def swing(times: np.ndarray, height: np.ndarray) -> float:
    """Frequency [Hz] of an oscillation about its mean from its zero crossings."""
    z = height - height.mean()
    up = np.flatnonzero((z[:-1] < 0) & (z[1:] >= 0))
    at = times[up] - z[up] * (times[1] - times[0]) / (z[up + 1] - z[up])
    return float((len(at) - 1) / (at[-1] - at[0]))


def test_a_taut_string_sounds_its_note() -> None:
    """f = sqrt(T / rho) / (2 L), T the tension per width of the stretched strip; within 1 %."""
    length, width, k, rho, pull = 0.5, 0.02, 200.0, 0.05, 1.02
    cloth = Material(rho, k, 0.0, 1e-12, mass_damping=0.0, stiffness_damping=0.0)
    sheet = strip(length, width, 0.01, cloth)
    start = np.column_stack([pull * sheet.rest[:, 0], np.zeros(len(sheet.rest)), sheet.rest[:, 1]])
    ends = np.flatnonzero((sheet.rest[:, 0] < 1e-9) | (sheet.rest[:, 0] > length - 1e-9)).tolist()
    start[:, 1] += 1e-3 * np.sin(np.pi * sheet.rest[:, 0] / length)
    start[ends, 1] = 0.0
    heights: list[float] = []
    inner = np.argmin(np.abs(sheet.rest[:, 0] - length / 2))
    drape(
        sheet,
        start,
        [Phase(4.0, (0.0, 0.0))],
        pins=ends,
        on_frame=lambda i, x: heights.append(float(x[inner, 1])),
    )
    force = k * (pull**2 - 1) / 2 * pull  # first Piola: per rest width
    # In rest coordinates the mass is rho a length, the tension along the string force / pull of its slope.
    expected = math.sqrt(force / pull / rho) / (2 * length)
    assert swing(0.04 * np.arange(len(heights)), np.array(heights)) % 12.5 == pytest.approx(
        expected, rel=0.01
    )


@pytest.mark.slow
def test_a_strip_sounds_its_note() -> None:
    """Held at both ends, f = pi / (2 L^2) sqrt(B / rho); within 1 %, 40 edges along and 48 across.

    A free border lets the bending of the last faces go: narrow strips are too soft (4 % in f at 8 edges across).
    """
    length, rho, b = 0.1, 0.15, 2e-5
    sheet = strip(
        length, 0.12, length / 40, Material(rho, 50.0, 0.0, b, mass_damping=0.0, stiffness_damping=0.0)
    )
    s = sheet.rest[:, 0]
    # A swing of 0.01 mm: at 1 mm the strip would sound by the tension of its own stretch.
    start = np.column_stack([s, 1e-5 * np.sin(np.pi * s / length), sheet.rest[:, 1]])
    ends = np.flatnonzero((s < 1e-9) | (s > length - 1e-9)).tolist()
    inner, heights = int(np.argmin(np.abs(s - length / 2))), []
    drape(
        sheet,
        start,
        [Phase(4.0, (0.0, 0.0))],
        pins=ends,
        on_frame=lambda i, x: heights.append(float(x[inner, 1])),
    )
    expected = math.pi / (2 * length**2) * math.sqrt(b / rho)
    assert swing(0.04 * np.arange(len(heights)), np.array(heights)) == pytest.approx(expected, rel=0.01)


def test_energy_stays_over_ten_thousand_periods() -> None:
    """36 vertices, no damping, no gravity: what leapfrog conserves changes by less than 1e-3."""
    cloth = Material(0.05, 50.0, 0.3, 5e-5, mass_damping=0.0, stiffness_damping=0.0)
    rest, faces = equilateral_sheet(0.25, 0.22, 0.05)
    sheet = Sheet.of(rest, faces, cloth)
    assert len(rest) <= 50
    start = np.column_stack([rest[:, 0] * 1.004, np.zeros(len(rest)), rest[:, 1]])
    v = np.random.default_rng(3).normal(0, 0.01, start.shape)
    v -= (sheet.mass @ v) / sheet.mass.sum()
    engine = Engine(sheet)
    limit = engine.step((), engine.inward(start), first_mode(len(rest)), first=True)
    long = 10_000 * np.pi * limit  # the fastest mode's period is pi times the stable step
    substeps = 2 * round(0.02 / (0.35 * limit))

    def energy(x: np.ndarray, v: np.ndarray, step: float) -> float:
        """What leapfrog conserves: the product of the velocities before and after stands for their square."""
        strain, tension, force = np.zeros(len(sheet.edges)), np.zeros(len(sheet.edges)), np.zeros_like(start)
        edge_tensions(sheet.stencil, x, v, 0.0, strain, tension)
        vertex_forces(sheet.stencil, x, tension, force)
        bend = np.zeros_like(start)
        vertex_forces(sheet.stencil, x, 0 * tension, bend)  # of two steps at once
        after = v + step * (force + bend) / sheet.mass[:, None]
        stored = energies(sheet.stencil, x, v)
        return stored[0] + stored[1] + 0.5 * float((sheet.mass[:, None] * v * after).sum())

    seen = []
    for part in (0.01, 0.3, 0.6, 1.0):
        end = drape(sheet, start, [Phase(part * long, (0.0, 0.0))], velocities=v, substeps=substeps)
        seen.append(energy(end.positions, end.velocities, 0.04 / substeps))
    assert max(seen) / min(seen) - 1 < 1e-3


@pytest.mark.slow
def test_capstan_holds_exp_mu_theta() -> None:
    """A strip over a fixed cylinder slips when T2 / T1 exceeds exp(mu theta), theta = pi; within 3 %."""
    radius, mu, width = 0.05, 0.2, 0.02
    arc = np.pi * (radius + 0.003)
    cloth = Material(0.1, 1000.0, 0.0, 1e-9, mu, 0.0, 2e-5)
    left = 0.08

    def slipped(ratio: float) -> float:
        sheet = strip(2 * left + arc, width, 0.008, cloth)
        s = sheet.rest[:, 0]
        angle = (s - left) / (radius + 0.003)
        x = np.where(s < left, -(radius + 0.003), np.where(s > left + arc, radius + 0.003, 0.0))
        y = np.where(s < left, s - left, np.where(s > left + arc, left + arc - s, 0.0))
        on = (s >= left) & (s <= left + arc)
        x[on], y[on] = -(radius + 0.003) * np.cos(angle[on]), (radius + 0.003) * np.sin(angle[on])
        start = np.column_stack([x, y, sheet.rest[:, 1]])
        live = Live(
            sheet,
            start,
            collider=Cylinder((0, 0, -0.1), (0, 0, 0.2), radius),
            contact=Contact(clearance=0.003, sample_clearance=0.0),
            gravity=(0.0, 0.0, 0.0),
            damping=20.0,
        )
        low = np.flatnonzero(s < 1e-9)
        high = np.flatnonzero(s > s.max() - 1e-9)
        force, before = 0.1, 0.0
        for frame in range(50):
            grown = min(1.0, (frame + 1) / 10)
            more = 1 + (ratio - 1) * max(0.0, min(1.0, (frame - 10) / 20))
            pull = np.zeros((len(low) + len(high), 3))
            pull[: len(low), 1] = -grown * force / len(low)
            pull[len(low) :, 1] = -grown * more * force / len(high)
            x = live.step(pulls=(np.r_[low, high], pull))
            if frame == 10:
                before = x[low, 1].mean()
            if frame > 10 and x[low, 1].mean() - before > 0.003:
                break
        return float(x[low, 1].mean() - before)

    limit = math.exp(mu * np.pi)
    assert slipped(0.97 * limit) < 0.001  # no more than it stretches
    assert slipped(1.03 * limit) > 0.003


@pytest.mark.nightly
@pytest.mark.slow
def test_drape_coefficient_grows_with_the_bending_length() -> None:
    found = []
    for case in (2, 1, 3):
        made = scene("drape", case, vertices=800, frames=60)
        end = drape(made.sheet, made.positions, made.phases, collider=made.collider, contact=made.contact)
        found.append(drape_coefficient(end.positions, made.sheet.faces, 0.3))
    assert found[0] < found[1] < found[2]
    assert 0.2 < found[0]
    assert found[2] < 1.0


def test_a_sheet_in_the_wind_hangs_at_the_angle_of_balance() -> None:
    """A stiff sheet hinged along its top in a level wind: rho g sin th = 1/2 rho_air Cd U^2 cos^2 th."""
    u, rho, air = 2.0, 0.2, 1.2
    angle = brentq(lambda t: rho * G * math.sin(t) - 0.5 * air * u**2 * math.cos(t) ** 2, 0, 1.5)
    rest, faces = equilateral_sheet(0.1, 0.1, 0.025)
    sheet = Sheet.of(rest, faces, Material(rho, 5e3, 0.0, 0.2, mass_damping=3.0))
    turned = 0.9 * angle
    start = np.column_stack([rest[:, 0], -rest[:, 1] * math.cos(turned), rest[:, 1] * math.sin(turned)])
    pins = np.flatnonzero(rest[:, 1] < 1e-9).tolist()
    end = drape(sheet, start, [Phase(2.0)], pins=pins, air=Air((0.0, 0.0, u), air, 1.0))
    low = end.positions[rest[:, 1] > 0.0999].mean(0)
    assert math.atan2(low[2], -low[1]) == pytest.approx(angle, rel=0.01)
