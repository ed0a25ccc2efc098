"""The choice of mesh for a budget: what the shipped table promises, and what the choice must not do."""

import numpy as np
import pytest

from sim_core.cloth.scenes import (
    GF_CM,
    GRID,
    TRIAL_EDGES,
    Alternative,
    Asked,
    apart,
    bounds,
    choose,
    gap,
    grid_film,
    scene,
    table,
    trial_film,
)
from sim_core.cloth.step import FRAME
from sim_core.errors import SimCoreError, WrongArgument

KINDS = ("flag", "hanging", "teapot")


def of_row(kind: str, row: dict) -> Asked:
    case = row["case"]
    wind = tuple(case["wind"]) if case["wind"] else None
    return Asked(kind, tuple(case["size"]), GF_CM, case["pins"] or "", wind, case["place"])


@pytest.mark.parametrize("kind", KINDS)
def test_bounds_cover_what_was_measured_and_rise_with_the_edge(kind: str) -> None:
    covered, ratios = [], []
    for row in table()[kind]["scenes"]:
        offered = bounds(of_row(kind, row), row["trial_gap_mm"])
        assert np.all(np.diff([b[1] for b in offered]) >= 0)
        assert np.all(np.diff([b[2] for b in offered]) < 0)
        told = np.array([b[1] for b in offered[1::2]])  # the first is what the others were measured against
        covered += (row["gap_mm"] <= told).tolist()
        ratios += (told / row["gap_mm"]).tolist()
    assert np.mean(covered) > 0.95
    assert np.median(ratios) < 4  # a bound that is never near the truth is no bound of use


@pytest.mark.parametrize("kind", KINDS)
def test_the_implicit_scheme_is_never_the_cheaper_way(kind: str) -> None:
    tried = table()[kind]["implicit"]
    assert tried
    assert all(row["ms"] > row["explicit_ms"] for row in tried)


@pytest.mark.nightly
def test_a_larger_budget_never_costs_more_and_budgets_lead_to_different_meshes() -> None:
    budgets = (3.0, 4.0, 8.0, 40.0)
    found = [choose("hanging", error_mm=b, size=(0.8, 0.8), pins="edge") for b in budgets]
    assert all(a.ms >= b.ms and a.edge <= b.edge for a, b in zip(found[:-1], found[1:], strict=True))
    assert len({f.edge for f in found}) >= 3
    assert all(f.error_mm <= budget for f, budget in zip(found, budgets, strict=True))
    assert f"{found[0].error_mm:.2g} mm" in found[0].why


@pytest.mark.parametrize(
    ("kind", "budget", "more"),
    [
        ("hanging", 6.0, {"size": (0.65, 0.7), "pins": "edge"}),
        ("hanging", 15.0, {"size": (0.7, 0.65), "pins": "corners"}),
        ("flag", 8.0, {"size": (0.7, 0.8), "wind": (3.0, 0.0, 1.1)}),
    ],
)
def test_an_unseen_sheet_stays_within_its_budget(kind: str, budget: float, more: dict) -> None:
    choice = choose(kind, error_mm=budget, **more)
    frames = round(table()[kind]["seconds"] / FRAME)
    fine = round(np.prod(more["size"]) * 2 / np.sqrt(3) / 0.0113**2)
    assert choice.vertices < fine
    films = [
        trial_film(scene(kind, vertices=count, **more), more["size"], frames)
        for count in (choice.vertices, fine)
    ]
    assert 0.05 * budget < apart(*films) <= budget


def test_a_flag_is_never_coarser_than_its_statistics_allow() -> None:
    asked = {"size": (0.8, 0.8), "wind": (3.0, 0.0, 1.2)}
    choice = choose("flag", error_mm=40, **asked)
    assert 1e3 * choice.edge == pytest.approx(table()["flag"]["calm_mm"])
    assert "statistics" in choice.why
    assert choose("flag", error_mm=2, **asked).edge < choice.edge


def test_size_pins_and_wind_enter_the_choice() -> None:
    held = {p: choose("hanging", error_mm=8, size=(0.8, 0.8), pins=p).edge for p in ("edge", "thirds")}
    assert held["edge"] > held["thirds"]
    blown = {w: choose("flag", error_mm=20, size=(0.8, 0.8), wind=(w, 0.0, 1.2)).error_mm for w in (2.0, 4.0)}
    assert blown[2.0] < blown[4.0]


def test_an_alternative_is_taken_where_it_is_cheaper_within_the_budget() -> None:
    asked = {"size": (0.8, 0.8), "pins": "edge"}
    mesh = choose("hanging", error_mm=8, **asked)
    cheap, rough = (Alternative("coarse + learned", 6400, e, 0.5 * mesh.ms) for e in (7.9, 8.1))
    dear = Alternative("coarse + learned", 6400, 1.0, 2.0 * mesh.ms)
    for others in ((), (rough,), (dear,), (rough, dear)):
        assert choose("hanging", error_mm=8, **asked, alternatives=others) == mesh
    found = choose("hanging", error_mm=8, **asked, alternatives=(dear, rough, cheap))
    assert (found.integrator, found.vertices) == (cheap.name, cheap.vertices)
    assert (found.error_mm, found.ms) == (cheap.error_mm, cheap.ms)
    assert found.edge == pytest.approx(0.0107, abs=1e-4)
    assert "7.9 mm off" in found.why
    assert f"of {1e3 * mesh.edge:.3g} mm, costs" in found.why
    only = choose("hanging", error_mm=0.001, **asked, alternatives=(Alternative("exact", 99, 0.0, 1e6),))
    assert "no mesh that was measured keeps it" in only.why
    for wrong in (("", 1.5, 1, 1), (2, 5, 1, 1), ("a", 5, -1, 1), ("a", 5, 1, float("nan"))):
        with pytest.raises(SimCoreError, match="alternative"):
            Alternative(*wrong)  # type: ignore[arg-type]


def test_what_cannot_be_kept_or_was_not_measured_is_refused_in_one_line() -> None:
    with pytest.raises(WrongArgument, match="the finest mesh measured, of 8 mm, keeps") as refused:
        choose("hanging", error_mm=0.001, size=(0.7, 0.7))
    least = float(str(refused.value).split("keeps ")[1].split(" mm")[0])
    assert choose("hanging", error_mm=least, size=(0.7, 0.7)).error_mm <= least
    for words, asked in {
        "scene 'curtain': no table": ("curtain", {}),
        "case 99": ("flag", {"case": 99}),
        "rounding decides where it buckles": ("flag", {"wind": (4.0, 0.0, 0.0)}),
        r"width \[m\] 5": ("hanging", {"size": (5.0, 1.0)}),
        "pins 'nails'": ("hanging", {"pins": "nails"}),
        "only the hanging cloth takes them": ("flag", {"pins": "edge"}),
        "only the flag stands in the wind": ("teapot", {"wind": (1.0, 0.0, 1.0)}),
    }.items():
        with pytest.raises(WrongArgument, match=words):
            choose(asked[0], error_mm=10, **asked[1])
    with pytest.raises(SimCoreError, match="above 0"):
        choose("flag", error_mm=float("nan"))


def test_films_are_read_off_linearly_at_the_same_material_points() -> None:
    size = (0.8, 0.6)
    films = []
    for edge in TRIAL_EDGES[:2]:
        made = scene("hanging", size=size, vertices=round(0.48 * 2 / np.sqrt(3) / edge**2))
        rest = made.sheet.rest
        film = np.stack(
            [np.column_stack([rest @ [1.0, 2.0], rest @ [t, -1.0], rest[:, 0]]) for t in range(3)]
        )
        films.append(grid_film(made.sheet, size, film))
    assert films[0].shape == (3, GRID**2, 3)
    assert films[0] == pytest.approx(films[1], abs=1e-6)
    assert apart(films[0], films[1] + [0.0, 3e-3, 4e-3]) == pytest.approx(5.0, rel=1e-4)
    assert gap([films[0], films[0] + [0.0, 0.0, 0.003], films[0] + [0.0, 0.0, 0.004]]) == pytest.approx(
        2, rel=1e-3
    )
