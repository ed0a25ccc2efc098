"""Rows of the table: what each makes of a coarse sheet, and that nobody is tested on what they learned from."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from sim_core.cli import main
from sim_core.errors import SimCoreError
from sim_core.learn.data import (
    DESIGNS,
    GATE,
    POOLINGS,
    Pair,
    Recipe,
    Take,
    film,
    generate,
    pooled_by_kind,
    pooled_takes,
    recipes,
    split,
)
from sim_core.learn.rows import (
    Biharmonic,
    Linear,
    LocalFrames,
    counting,
    led_physics,
    measured,
    reference,
)


def small(case: int, frames: int = 8) -> Recipe:
    """A sequence of few vertices."""
    return Recipe("hanging", case, 7, frames, 0, coarse=90, fine=340)


@cache
def hanging(case: int) -> Take:
    return Take.of(small(case), film(small(case)))


def test_the_base_is_smooth_has_the_means_of_the_coarse_surface_and_keeps_affine_maps() -> None:
    pair = Pair.of(small(1))
    bent = np.column_stack([pair.coarse.rest, 0.05 * np.sin(7 * pair.coarse.rest[:, 0])])
    surface, base = pair.spread @ bent, pair.base @ bent
    assert np.abs(pair.mean @ (surface - base)).max() < 0.1 * np.abs(surface - base).max()
    straight = np.array([[1.0, 0.2, -0.4], [0.1, 0.9, 0.3]])
    assert np.abs(pair.base @ (pair.coarse.rest @ straight) - pair.fine.rest @ straight).max() < 1e-9
    assert Pair.of(small(2)).base is pair.base  # sheets of one shape share their matrices


@pytest.mark.parametrize("scene", list(DESIGNS))
def test_three_of_ten_sequences_are_held_back_and_every_size_is_among_them(scene: str) -> None:
    every = recipes(scene)
    parts = split(every)
    assert set(parts.train) | set(parts.test) == set(every)
    assert not set(parts.train) & set(parts.test)
    assert not {one.seed for one in parts.train} & {one.seed for one in parts.test}
    assert 0.25 < len(parts.test) / len(every) < 0.35
    assert parts.validation in parts.train
    sizes = [
        {tuple(np.ptp(one.on(60).sheet.rest, axis=0).round(3)) for one in part}
        for part in (every, parts.test)
    ]
    assert sizes[0] == sizes[1]
    with pytest.raises(SimCoreError, match="make 3 or more"):
        split(every[:2])


def test_what_learned_is_nearer_than_what_did_not() -> None:
    """On frames that were learned from: whether it helps on others is what the table is for."""
    seen = [hanging(1), hanging(2)]
    plain = measured(Linear(), seen)
    smooth = measured(Biharmonic(), seen)
    fitted = measured(LocalFrames.fitted(seen), seen)
    assert fitted.errors.mean.vertex < 0.7 * min(row.errors.mean.vertex for row in (plain, smooth))
    assert set(fitted.frames) == {"hanging-01", "hanging-02"}
    assert plain.errors.frames == 2
    assert plain.milliseconds > 0.0


def test_sheets_of_one_kind_share_what_was_learned_and_others_get_the_base() -> None:
    made = LocalFrames.fitted([hanging(1)])
    other, wide = hanging(7), Take.of(small(13), film(small(13, 2)))
    assert len(made.models) == 1
    place = other.film.coarse[-1].astype(float)
    assert np.abs(made.follow(other.pair)(place) - other.pair.base @ place).max() > 1e-6
    place = wide.film.coarse[-1].astype(float)
    assert np.array_equal(made.follow(wide.pair)(place), wide.pair.base @ place)


def test_the_command_compares_rows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    generate(tmp_path, [small(case, 5) for case in (1, 2, 3)])
    words = [
        "learn",
        "evaluate",
        "hanging",
        "--data",
        str(tmp_path),
        "--rows",
        "linear,biharmonic,local_frames",
    ]
    assert main([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["tested"] == ["hanging-03"]
    assert list(told["rows"]) == ["linear", "biharmonic", "local_frames"]
    for row in told["rows"].values():
        assert {"mean_mm", "hausdorff_mm", "p95_mm", "normal_deg", "strain", "net_ms", "total_ms"} <= set(row)
        assert row["total_ms"] > row["net_ms"] > 0.0
    assert main(words) == 0
    assert "local_frames" in capsys.readouterr().out
    words[-1] = "coarse,linear"
    assert main([*words, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert rows["coarse"]["hausdorff_mm"] > 0.95 * rows["linear"]["hausdorff_mm"]  # its corners reach farther
    assert rows["coarse"]["total_ms"] < rows["linear"]["total_ms"]
    words[-1] = "reference,physics_50"
    assert main([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert list(told["rows"]) == ["reference", "physics_50"]
    assert "gate" not in told  # nothing is claimed
    assert main(["learn", "evaluate", "flag", "--data", str(tmp_path)]) == 1
    assert "holds hanging – give the folder of flag" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["learn", "evaluate", "flag", "--data", str(tmp_path), "--rows", "mine"])
    assert "'mine' – there are reference, coarse, linear" in capsys.readouterr().err


@pytest.mark.parametrize("pooling", POOLINGS)
def test_what_was_pooled_stays_where_it_is_and_is_not_in_the_mean(pooling: str) -> None:
    seen = [hanging(1), hanging(2)]
    pooled = pooled_by_kind(seen, pooling, 0.4)
    (first, second) = pooled_takes(seen, pooled)
    assert len(first.film.coarse[0]) == len(first.pair.kept) < 0.4 * len(first.film.fine[0])
    assert first.pair.base is second.pair.base
    place = first.film.coarse[4].astype(float)
    made = first.pair.base @ place
    assert np.abs(made[list(first.pair.kept)] - place).max() < 1e-9
    found = measured(Biharmonic(), [first])
    off = np.linalg.norm(made - first.film.fine[4], axis=1)
    out = np.setdiff1d(np.arange(len(made)), first.pair.kept)
    assert found.errors.mean.vertex == pytest.approx(off[out].mean(), rel=1e-6)
    fitted = measured(LocalFrames.fitted([first, second]), [first, second])
    smooth = measured(Biharmonic(), [first, second])
    assert fitted.errors.mean.vertex < smooth.errors.mean.vertex
    with pytest.raises(SimCoreError, match="no sheet of its kind"):
        pooled_takes([Take.of(small(13, 2), film(small(13, 2)))], pooled)


def test_frames_count_whose_floor_is_a_third_of_every_error() -> None:
    takes = [hanging(1)]
    (floor, _), plain, smooth = reference(takes, 8), measured(Linear(), takes), measured(Biharmonic(), takes)
    name = takes[0].name
    assert [len(one.frames[name]) for one in (floor, plain)] == [1, 1]  # every fifth of eight
    base = floor.frames[name][0]
    assert 0 < base.vertex < GATE * smooth.frames[name][0].vertex
    assert counting(floor, [plain, smooth]) == {name: (1, 1)}
    claimed = replace(smooth, frames={name: (replace(base, vertex=2.9 * base.vertex),)})
    assert counting(floor, [plain, claimed]) == {name: (0, 1)}


def test_a_wind_of_ones_own_is_simulated_and_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(DESIGNS, "flag", replace(DESIGNS["flag"], coarse=90, fine=340, run_in=2))
    generate(tmp_path / "flag", recipes("flag", sequences=3, frames=5))
    words = ["learn", "evaluate", "flag", "--data", str(tmp_path / "flag"), "--rows", "reference,biharmonic"]
    assert main([*words, "--wind", "12,0,1", "--frames", "5", "--floor", "5", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["tested"], told["wind"]) == (["flag-01-wind"], [12.0, 0.0, 1.0])
    assert set(told["gate"]["sequences"]) == {"flag-01-wind"}
    assert told["rows"]["biharmonic"]["mean_mm"] > 0.0
    with pytest.raises(SystemExit):
        main([*words, "--wind", "strong"])
    assert "'strong' – three speeds in m/s, such as 12,0,1" in capsys.readouterr().err
    generate(tmp_path / "hanging", [small(case, 5) for case in (1, 2, 3)])
    words[2], words[4] = "hanging", str(tmp_path / "hanging")
    assert main([*words, "--wind", "12,0,1"]) == 2
    assert "no wind blows in the scene hanging" in capsys.readouterr().err


def test_quicker_physics_on_the_same_mesh_is_near_the_reference_and_on_fewer_vertices_less_so() -> None:
    takes = [hanging(1)]
    whole, half = led_physics(takes, 1.0, 5), led_physics(takes, 0.5, 5)
    (near,), (far,) = whole.frames["hanging-01"], half.frames["hanging-01"]
    assert 0.0 < near.vertex < 0.2 * far.vertex
    assert whole.milliseconds > 0.0
    moved = replace(takes[0], film=replace(takes[0].film, coarse=takes[0].film.coarse + np.float32(1e-3)))
    with pytest.raises(SimCoreError, match="hanging-01: its coarse film comes out otherwise on this machine"):
        led_physics([moved], 1.0, 5)


def test_the_command_reconstructs_and_says_whether_the_gate_is_passed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    generate(tmp_path, [small(case, 5) for case in (1, 2, 3)])
    words = ["learn", "evaluate", "hanging", "--data", str(tmp_path)]
    assert main([*words, "--share", ".5", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert list(told["rows"]) == [
        "reference", "linear", "biharmonic", "local_frames", "curvature_linear", "curvature_biharmonic",
    ]  # fmt: skip
    assert all(row["mean_mm"] > 0 for row in told["rows"].values())
    assert told["gate"]["sequences"]["hanging-03"]["whole"] == 1
    assert told["gate"]["passed"] in (True, False)
    assert main([*words, "--share", ".5", "--rows", "reference,linear"]) == 0
    assert "from 0.5 of the vertices" in (said := capsys.readouterr().out)
    assert "gate " in said
    assert main([*words, "--share", ".5", "--rows", "coarse"]) == 1
    assert "no coarse sheet is simulated" in capsys.readouterr().err
    assert main([*words, "--rows", "curvature_linear"]) == 1
    assert "give --share" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main([*words, "--share", "1.5"])
    assert "'1.5' – above 0, to 1" in capsys.readouterr().err
