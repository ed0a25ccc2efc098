"""Data to learn from: the fine film follows the coarse one, converges, is kept whole, and is resumed or refused."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from sim_core.cli import main
from sim_core.cloth import Live, Pace
from sim_core.errors import SimCoreError, WrongArgument
from sim_core.learn.data import (
    DESIGNS,
    GATE,
    MANIFEST,
    Film,
    Lead,
    Manifest,
    Recipe,
    coarse_film,
    film,
    floor,
    generate,
    read_films,
    read_sequence,
    recipes,
)
from sim_core.learn.upsampling import linear


def small(name: str = "hanging", case: int = 1, frames: int = 6, run_in: int = 0) -> Recipe:
    """A sequence of few vertices."""
    return Recipe(name, case, 7, frames, run_in, coarse=90, fine=340)


@cache
def hanging() -> Film:
    return film(small(frames=12))


def test_published_sequences() -> None:
    counts = {name: (design.sequences, design.frames) for name, design in DESIGNS.items()}
    assert counts == {"flag": (10, 600), "teapot": (16, 400), "hanging": (18, 1200)}
    assert sum(n * frames for n, frames in counts.values()) == 34_000
    for name, design in DESIGNS.items():
        every = recipes(name)
        assert (
            len({recipe.name for recipe in every})
            == len({recipe.seed for recipe in every})
            == design.sequences
        )
        first = every[0]
        fine, coarse = (len(first.on(count).sheet.rest) for count in (first.fine, first.coarse))
        assert coarse <= 0.2525 * fine  # a quarter, to the nearest mesh
    assert {one.seed for one in recipes("flag", seed=1)}.isdisjoint(one.seed for one in recipes("flag"))


def test_the_fine_cloth_shows_what_the_coarse_one_does() -> None:
    """Left to itself it would be centimetres elsewhere; its means about coarse vertices are led, not its vertices."""
    made, recipe = hanging(), small(frames=12)
    fine, coarse = recipe.on(recipe.fine).sheet, recipe.on(recipe.coarse).sheet
    spread = linear(coarse.rest, coarse.faces, fine.rest)
    lead = Lead.of(spread, fine.mass)
    away = [np.linalg.norm(lead.away(made.fine[k], made.coarse[k]), axis=1).mean() for k in range(12)]
    own = np.linalg.norm(made.fine[-1] - spread @ made.coarse[-1], axis=1).mean()
    fallen = 0.5 * 9.81 * (12 / 25) ** 2
    assert max(away) < 0.005 * fallen
    assert own > 1.2 * away[-1]


def test_forces_of_the_lead_draw_back_and_do_not_turn() -> None:
    recipe = small()
    fine, coarse = recipe.on(recipe.fine).sheet, recipe.on(recipe.coarse).sheet
    lead = Lead.of(linear(coarse.rest, coarse.faces, fine.rest), fine.mass)
    there = np.column_stack([coarse.rest, np.zeros(len(coarse.rest))])
    own = np.column_stack([fine.rest, np.zeros(len(fine.rest))])
    assert np.abs(lead.forces(own, there, there)).max() < 1e-12  # an affine surface is shown exactly
    off = lead.forces(own + [0.0, 0.0, 0.01], there, there)
    assert (off[:, 2] < 0).all()
    assert np.allclose(off[:, 2] / fine.mass, off[0, 2] / fine.mass[0])


def test_half_the_step_moves_little_against_what_is_to_be_learned() -> None:
    worth = floor(small(frames=10), 10)
    assert worth.halved.mean.vertex < 0.1 * GATE * worth.linear.mean.vertex
    assert worth.halved.mean.hausdorff < 0.1 * GATE * worth.linear.mean.hausdorff
    assert 0.0 < worth.slack < worth.linear.mean.vertex


def test_slow_motion_is_the_same_motion() -> None:
    recipe, frames, slow = small(), 5, 16
    usual, slowed = recipe.on(recipe.fine), recipe.on(recipe.fine, slow)
    pace = Pace("double", 0.1)
    one = Live(usual.sheet, usual.positions, pins=usual.pins, pace=pace)
    other = Live(
        slowed.sheet, slowed.positions, pins=slowed.pins, pace=pace, gravity=(0.0, -9.81 / slow**2, 0.0)
    )
    for _ in range(frames):
        one.step()
        for _ in range(slow):
            other.step()
    assert np.linalg.norm(one.positions - other.positions, axis=1).max() < 1e-3
    assert np.linalg.norm(one.positions - usual.positions, axis=1).max() > 0.1


def test_a_flag_is_kept_after_its_run_in_in_gusts_of_its_own() -> None:
    recipe = small("flag", frames=2, run_in=2)
    both, other = film(recipe), film(replace(recipe, seed=8))
    assert len(both.fine) == len(both.coarse) == 2
    assert np.abs(both.coarse - coarse_film(recipe)[0][3:]).max() < 1e-6
    assert np.abs(both.coarse - other.coarse).max() > 1e-4


def test_what_is_kept_is_what_was_made(tmp_path: Path) -> None:
    generate(tmp_path, [small()])
    (recipe, kept) = read_films(tmp_path)["hanging-01"]
    made = film(recipe)
    assert recipe == small()
    span = float(np.ptp(np.concatenate([made.coarse, made.fine], axis=1), axis=(0, 1)).max())
    for one, other in ((kept.coarse, made.coarse), (kept.fine, made.fine)):
        assert np.abs(one.astype(float) - other).max() <= 0.51 * span / 65_535 + 1e-7
    told = json.loads((tmp_path / MANIFEST).read_text("utf-8"))["done"]["hanging-01"]
    assert told["frames"] == 6
    assert not list(tmp_path.glob(".*"))


class Failing(ThreadPoolExecutor):
    """Workers that end, or have another engine."""

    def __init__(self, act) -> None:
        super().__init__(1)
        self.act = act

    def submit(self, fn, /, *args, **kwargs):
        return super().submit(self.act, fn, *args)


def test_workers_that_fail_or_are_of_another_engine_are_named(tmp_path: Path) -> None:
    def dies(make, recipe):
        raise RuntimeError("killed\nand more")

    def other(make, recipe):
        data, facts = make(recipe)
        return data, facts | {"made": facts["made"] | {"engine": 1}}

    for act, words in ((dies, r"its worker failed \(RuntimeError: killed\)"), (other, "another engine")):
        with Failing(act) as executor, pytest.raises(SimCoreError, match=f"hanging-01: .*{words}"):
            generate(tmp_path / words[:3], [small(frames=2)], executor=executor)


def test_a_cluster_makes_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of two processes, by the command; an address where nobody answers is told."""
    distributed = pytest.importorskip("distributed")
    from sim_core.learn.commands import generation

    words = ["learn", "data", "hanging", "--sequences", "2", "--frames", "2", "--floor", "0", "--json"]
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    )
    with cluster:
        there = [*words, "--out", str(tmp_path / "there"), "--cluster", cluster.scheduler_address]
        assert main(there) == 0
    assert json.loads(capsys.readouterr().out)["sequences"] == 2
    assert main([*words, "--out", str(tmp_path / "here")]) == 0
    for name in ("hanging-01", "hanging-02"):
        one, other = (read_sequence(tmp_path / where / f"{name}.seq")[1] for where in ("here", "there"))
        assert np.array_equal(one.fine, other.fine)
        assert np.array_equal(one.coarse, other.coarse)
    monkeypatch.setattr(generation, "PATIENCE", 0.5)
    capsys.readouterr()
    assert main([*words, "--out", str(tmp_path / "none"), "--cluster", "tcp://127.0.0.1:9"]) == 1
    assert "--cluster tcp://127.0.0.1:9: no scheduler answers" in capsys.readouterr().err
    assert main([*words, "--out", str(tmp_path / "none"), "--cluster", "nowhere"]) == 1
    assert "no scheduler answers" in capsys.readouterr().err
    with socket.create_server(("127.0.0.1", 0)) as mute:
        address = f"tcp://127.0.0.1:{mute.getsockname()[1]}"
        assert main([*words, "--out", str(tmp_path / "none"), "--cluster", address]) == 1
    assert "no scheduler answers (no answer within 1 s)" in capsys.readouterr().err
    with distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None) as empty:
        there = [*words, "--out", str(tmp_path / "none"), "--cluster", empty.scheduler_address]
        assert main(there) == 1
    assert "the scheduler has no workers" in capsys.readouterr().err


def test_any_executor_makes_the_same_bytes(tmp_path: Path) -> None:
    wanted = [small(case=case, frames=2) for case in (1, 2, 3)]
    heard: list[float] = []
    here = generate(tmp_path / "here", wanted, progress=lambda share, _: heard.append(share))
    with ThreadPoolExecutor(2) as executor:
        there = generate(tmp_path / "there", wanted, executor=executor)
    assert {n: k["frames"] for n, k in here.done.items()} == {n: k["frames"] for n, k in there.done.items()}
    for name in here.done:
        one, other = (read_sequence(tmp_path / where / f"{name}.seq")[1] for where in ("here", "there"))
        assert np.array_equal(one.fine, other.fine)
        assert np.array_equal(one.coarse, other.coarse)
    assert heard == sorted(heard)
    assert heard[-1] == 1.0


def test_a_killed_run_goes_on_where_it_was(tmp_path: Path) -> None:
    words = [
        "learn",
        "data",
        "hanging",
        "--sequences",
        "3",
        "--frames",
        "8",
        "--floor",
        "0",
        "--out",
        str(tmp_path),
    ]
    run = subprocess.Popen(
        [sys.executable, "-c", "import sys; from sim_core.cli import main; sys.exit(main())", *words],
        stdout=subprocess.DEVNULL,
    )
    for _ in range(600):
        if list(tmp_path.glob("*.seq")) or run.poll() is not None:
            break
        time.sleep(0.1)
    os.kill(run.pid, signal.SIGKILL)
    run.wait()
    (tmp_path / ".hanging-02.seq.part").write_bytes(b"half")
    kept = {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("*.seq")}
    assert kept
    assert main(words) == 0
    assert len(read_films(tmp_path)) == 3
    for name, when in kept.items():
        assert (tmp_path / name).stat().st_mtime_ns == when


def test_a_damaged_sequence_is_refused_and_made_again(tmp_path: Path) -> None:
    wanted = [small(frames=2)]
    generate(tmp_path, wanted)
    path = tmp_path / "hanging-01.seq"
    whole = path.read_bytes()
    path.write_bytes(whole[:-9])
    with pytest.raises(SimCoreError, match=r"hanging-01.seq: not what was made – run the same"):
        read_films(tmp_path)
    with pytest.raises(SimCoreError, match="make it again"):
        read_sequence(path)
    assert Manifest.of(tmp_path, wanted).left == tuple(wanted)
    generate(tmp_path, wanted)
    assert len(read_films(tmp_path)) == 1


@pytest.mark.parametrize(
    ("text", "words"), [("{", "damaged"), ("[]", "damaged"), ('{"recipes": [{"scene": "flag"}]}', "damaged")]
)
def test_a_damaged_manifest_is_told(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / MANIFEST).write_text(text, "utf-8")
    with pytest.raises(SimCoreError, match=rf"{MANIFEST}: {words} .* – delete it"):
        Manifest.of(tmp_path, [small()])


def test_an_unfinished_folder_and_none_are_told(tmp_path: Path) -> None:
    with pytest.raises(SimCoreError, match="no data – make them with `simcore learn data"):
        read_films(tmp_path)
    Manifest((small(), small(case=2)), {}).save(tmp_path)
    with pytest.raises(SimCoreError, match="2 of 2 sequences are missing – run the same"):
        read_films(tmp_path)


def test_a_folder_of_other_settings_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Manifest((small(),), {}).save(tmp_path)
    with pytest.raises(SimCoreError, match="holds 1 × 6 frames of hanging, seed 0 – other settings"):
        Manifest.of(tmp_path, [small(frames=7)])
    Manifest((small(),), {}, {"engine": 1}).save(tmp_path)
    with pytest.raises(SimCoreError, match="was made by another engine"):
        Manifest.of(tmp_path, [small()])
    assert main(["learn", "data", "hanging", "--frames", "9", "--out", str(tmp_path)]) == 1
    assert "other settings" in capsys.readouterr().err


def test_numbers_without_meaning_are_refused() -> None:
    with pytest.raises(WrongArgument, match="data are made of flag, teapot, hanging"):
        recipes("limb")
    with pytest.raises(SimCoreError, match="sequences"):
        recipes("flag", sequences=11)
    with pytest.raises(SimCoreError, match="frames"):
        recipes("flag", frames=0)


def test_the_command_tells_what_the_data_are_worth(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["learn", "data", "hanging", "--sequences", "1", "--frames", "5", "--floor", "5", "--json"]
    assert main([*words, "--out", str(tmp_path)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["sequences"] == 1
    assert told["frames"] == 5
    assert told["floor"]["hausdorff_mm"] < GATE * told["floor"]["linear_hausdorff_mm"]
