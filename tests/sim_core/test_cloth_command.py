"""`simcore cloth` and the scenes it runs: sizes as published, files, resuming, the summary."""

import json
from pathlib import Path

import numpy as np
import pytest
from full_matrix import by_day

from sim_core import cli
from sim_core.cloth.contact import Capsule, MovingGrid, field_of
from sim_core.cloth.scenes import (
    NAMES,
    PINS,
    cases,
    disc,
    equilateral_sheet,
    limb_mesh,
    scene,
    sheet_of,
    teapot_mesh,
    teapot_solid,
)
from sim_core.errors import WrongArgument
from sim_core.metrics import surface_distance, winding

KEYS = {"scene", "vertices", "frames", "seconds", "compile_seconds", "ms_per_frame", "substeps", "integrator"}
KEYS |= {"fallbacks", "worst_stretch", "penetrations", "intersections", "seed"}


@pytest.mark.parametrize(
    ("name", "vertices", "frames", "count"),
    by_day(
        [("flag", 6182, 600, 10)],
        [("flag", 6182, 600, 10), ("teapot", 3020, 400, 16), ("hanging", 6570, 1200, 18)],
    ),
)
def test_scenes_are_of_the_published_sizes(name: str, vertices: int, frames: int, count: int) -> None:
    assert cases(name) == count
    for case in range(1, count + 1):
        made = scene(name, case)
        assert len(made.positions) == pytest.approx(vertices, rel=0.01)
        assert round(made.phases[0].seconds * 25) == frames
        assert made.sheet.stencil.length2.max() < 4 * made.sheet.stencil.length2.min()


def test_the_flag_stands_in_the_x_y_plane_and_is_held_on_one_side() -> None:
    flag = scene("flag")
    assert flag.air is not None
    assert flag.air.wind == (4.0, 0.0, 1.0)
    assert np.abs(flag.positions[:, 2]).max() == 0.0
    assert np.abs(flag.positions[list(flag.pins), 0]).max() == 0.0
    assert len(flag.pins) == len(np.unique(flag.positions[list(flag.pins), 1]))
    assert np.ptp(flag.positions, axis=0) == pytest.approx([1.5, 1.0, 0.0])


@pytest.mark.parametrize("kind", PINS)
def test_pins_are_where_their_name_says(kind: str) -> None:
    made = scene("hanging", pins=kind, vertices=300)
    at = made.sheet.rest[list(made.pins)]
    assert len(at) == {"corners": 2, "corner": 1, "middle": 1, "four": 4, "thirds": 4}.get(kind, len(at))
    if kind in ("edge", "thirds", "corners", "corner"):
        assert np.abs(at[:, 1]).max() < 1e-9
    if kind == "middle":
        assert at[0] == pytest.approx([0.5, 0.5], abs=0.06)


def test_rows_have_straight_sides_and_no_slim_triangles() -> None:
    rest, faces = equilateral_sheet(1.0, 0.7, 0.03)
    p = rest[faces]
    sides = np.linalg.norm(p - np.roll(p, 1, axis=1), axis=2)
    assert sides.max() < 1.6 * 0.03
    assert sides.min() > 0.8 * 0.03
    a, b = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    area = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert (area < 0).all()  # positive in (x, -y)
    assert -area.sum() == pytest.approx(0.7)
    points, triangles = disc(0.3, 0.01)
    p = points[triangles]
    a, b = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    assert 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() == pytest.approx(
        np.pi * 0.15**2, rel=0.01
    )
    for wanted in (100, 3020, 50_000):
        rest, _ = sheet_of(1.2, 1.0, wanted)
        assert len(rest) == pytest.approx(wanted, rel=0.08 if wanted < 1000 else 0.01)


def test_the_teapot_is_closed_and_its_distance_is_that_of_its_surface() -> None:
    vertices, faces = teapot_mesh(filled=True)
    edges, count = np.unique(
        np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0, return_counts=True
    )
    assert (count == 2).all()
    assert len(vertices) - len(edges) + len(faces) == 8  # four closed parts
    low, high = vertices.min(0), vertices.max(0)
    assert low == pytest.approx([-0.3, 0.0, -0.2], abs=0.005)
    assert high == pytest.approx([0.345, 0.315, 0.2], abs=0.005)
    solid = teapot_solid()
    points = np.random.default_rng(2).uniform(low - 0.02, high + 0.02, (1500, 3))
    signed = solid.distance(points)
    away = surface_distance(points, vertices, faces)
    clear = away > 0.006
    assert np.array_equal(signed[clear] < 0, winding(points[clear], vertices, faces) > 0.5)
    outer = (signed > 0.0) & (away < 0.025)
    assert outer.sum() > 50
    assert np.percentile(np.abs(signed[outer] - away[outer]), 95) < 0.0015
    spout, handle = np.array([[0.30, 0.22, 0.0]]), np.array([[-0.285, 0.18, 0.0]])
    assert solid.distance(spout)[0] < 0 < solid.distance(np.array([[-0.23, 0.15, 0.0]]))[0]
    assert solid.distance(handle)[0] < 0


def summary(capsys, words: list[str]) -> dict:
    assert cli.main(["cloth", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize("name", NAMES)
def test_every_scene_runs_and_says_what_it_cost(name: str, capsys, tmp_path: Path) -> None:
    out = tmp_path / "frames.npz"
    told = summary(capsys, [name, "--frames", "3", "--vertices", "150", "--out", str(out)])
    assert KEYS <= set(told)
    assert (told["scene"], told["frames"], told["penetrations"]) == (name, 3, 0)
    with np.load(out) as data:
        assert set(data.files) == {"positions", "faces", "uv", "pins", "dt", "settings"}
        assert data["positions"].shape == (3, told["vertices"], 3)
        assert data["positions"].dtype == np.float32
        assert data["faces"].max() == told["vertices"] - 1
        assert data["uv"].shape == (told["vertices"], 2)
        assert float(data["dt"]) == 1 / 25
        assert json.loads(str(data["settings"]))["scene"] == name


def test_an_interrupted_run_keeps_its_frames_and_goes_on_to_the_same_bits(
    capsys, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sim_core.cloth import cli as command

    words = ["flag", "--frames", "8", "--vertices", "200", "--gusts", "0.3", "--seed", "5"]
    summary(capsys, [*words, "--out", str(tmp_path / "whole.npz")])
    heard = command._Heard.frame

    def stopped(self, index: int, positions: np.ndarray) -> None:
        heard(self, index, positions)
        if index == 4:
            raise KeyboardInterrupt

    resumed = [*words, "--resume", str(tmp_path / "state"), "--out", str(tmp_path / "part.npz")]
    monkeypatch.setattr(command._Heard, "frame", stopped)
    assert cli.main(["cloth", *resumed, "--json"]) == 1
    assert "interrupted" in capsys.readouterr().err
    with np.load(tmp_path / "part.npz") as data:
        assert len(data["positions"]) == 5
    monkeypatch.undo()
    summary(capsys, resumed)
    with np.load(tmp_path / "part.npz") as part, np.load(tmp_path / "whole.npz") as whole:
        assert part["positions"].tobytes() == whole["positions"].tobytes()


def test_a_state_of_another_run_is_refused_and_left_as_it_is(capsys, tmp_path: Path) -> None:
    kept = tmp_path / "state"
    words = ["--frames", "2", "--vertices", "120", "--resume", str(kept)]
    summary(capsys, ["hanging", *words])
    before = kept.read_bytes()
    assert cli.main(["cloth", "flag", *words]) == 1
    told = capsys.readouterr().err
    assert "no state of this run" in told
    assert "Traceback" not in told
    assert kept.read_bytes() == before


def test_a_finished_run_resumed_says_that_no_frame_was_left(capsys, tmp_path: Path) -> None:
    words = ["hanging", "--frames", "2", "--vertices", "120", "--resume", str(tmp_path / "state")]
    assert summary(capsys, words)["ms_per_frame"] > 0
    assert summary(capsys, words)["ms_per_frame"] is None  # NaN is no JSON
    assert cli.main(["cloth", *words]) == 0
    assert "all of them kept" in capsys.readouterr().out


@pytest.mark.parametrize("other", [("--vertices", "200"), ("--integrator", "implicit")])
def test_an_error_is_not_promised_for_a_mesh_or_scheme_set_by_hand(other: tuple[str, str], capsys) -> None:
    assert cli.main(["cloth", "hanging", "--frames", "1", "--error", "20", *other]) == 2
    assert "--error chooses the setting" in capsys.readouterr().err


def test_a_folder_is_refused_as_a_file_before_anything_runs(capsys, tmp_path: Path) -> None:
    (tmp_path / "a.npz").mkdir()
    assert cli.main(["cloth", "hanging", "--frames", "100000", "--out", str(tmp_path / "a.npz")]) == 2
    assert "folder" in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["a.npz"]


@pytest.mark.parametrize("name", NAMES)
def test_code_is_compiled_with_a_scene_of_the_same_loop(name: str) -> None:
    from sim_core.cloth.cli import WARM
    from sim_core.cloth.step import Engine

    small, whole = (Engine(scene(name, vertices=count).sheet).laned for count in (WARM, None))
    assert (small is None) == (whole is None)


def test_seeds_gusts_and_winds_change_the_flag() -> None:
    from sim_core.cloth import drape

    def end(gusts: float = 0.0, seed: int = 0, **more) -> np.ndarray:
        made = scene("flag", vertices=100, frames=6, **more).gusty(gusts, seed)
        return drape(made.sheet, made.positions, made.phases, pins=made.pins, air=made.air).positions

    still, gusty = end(), end(gusts=0.5, seed=1)
    assert np.array_equal(gusty, end(gusts=0.5, seed=1))
    assert np.abs(gusty - end(gusts=0.5, seed=2)).max() > 1e-4
    assert np.abs(gusty - still).max() > 1e-4
    assert np.abs(end(wind=(0.0, 0.0, 4.0)) - still).max() > 1e-3


def test_a_film_shows_every_frame(capsys, tmp_path: Path) -> None:
    av = pytest.importorskip("av")
    film = tmp_path / "drape.mp4"
    summary(capsys, ["hanging", "--frames", "3", "--vertices", "60", "--video", str(film)])
    with av.open(str(film)) as opened:
        frames = [f.to_ndarray(format="rgb24") for f in opened.decode(video=0)]
    assert len(frames) == 3
    assert np.abs(frames[0].astype(int) - frames[-1]).max() > 20


def test_a_limb_is_closed_and_of_its_size() -> None:
    vertices, faces = limb_mesh(0.5, 0.06)
    solid = field_of(vertices, faces, cell=0.01).solid()
    exact = Capsule((0, 0, 0), (0.5, 0, 0), 0.06)
    points = np.random.default_rng(3).uniform([-0.1, -0.09, -0.09], [0.6, 0.09, 0.09], (500, 3))
    off = np.abs(solid.distance(points) - exact.distance(points))
    assert off[exact.distance(points) > 0].max() < 0.003


LIMB_WAYS = [(1, 51, (-0.0165, 0.0506, 0.0)), (2, 44, (0.0, 0.1, 0.0)), (3, 44, (0.0, 0.0, 0.05))]


@pytest.mark.parametrize(("case", "frames", "way"), by_day(LIMB_WAYS[1:2], LIMB_WAYS))
def test_a_cloth_goes_with_the_limb_it_lies_on(case: int, frames: int, way: tuple[float, ...]) -> None:
    """Still from 0.8 to 1 s, furthest at the end; edges short beside the arm, so friction holds it as a stiff one."""
    made, film = scene("limb", case, vertices=1200, frames=frames), []
    body, limit = made.collider, 0.003
    assert isinstance(body, MovingGrid)
    made.drape(on_frame=lambda _, x: film.append(x.astype(float)))
    away = [body.solid(key).distance(x) for key, x in enumerate(film, 1)]
    assert min(a.min() for a in away) > 0.9 * limit
    assert max(a.min() for a in away[20:]) < 1.1 * limit
    assert made.shown is not None
    assert (
        np.abs(body.solid(frames).distance(made.shown[0][-1])).max() < 0.003
    )  # what a film shows is what carries
    carried = away[24] < 1.5 * limit
    assert carried.sum() > 50
    assert (film[-1] - film[24])[carried].mean(0) == pytest.approx(way, abs=0.004)


def test_what_a_scene_does_not_have_is_named() -> None:
    for name, more, word in (
        ("hanging", {"wind": (1, 0, 0)}, "wind"),
        ("flag", {"pins": "edge"}, "pins"),
        ("flag", {"case": 11}, "case 11"),
        ("curtain", {}, "curtain"),
        ("hanging", {"pins": "nails"}, "nails"),
        ("drape", {"size": (0.3, 0.4)}, "as wide as high"),
    ):
        with pytest.raises(WrongArgument, match=word):
            scene(name, **more)
    with pytest.raises(WrongArgument, match="gusts"):
        scene("limb", vertices=100, frames=1).gusty(0.2)


@pytest.mark.parametrize(("scene", "frames"), [("hanging", 2), ("hanging", 8), ("teapot", 12)])
def test_a_fixed_step_that_blows_the_cloth_up_is_one_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, scene: str, frames: int
) -> None:
    out = tmp_path / "film.npz"
    line = ["cloth", scene, "--vertices", "300", "--frames", str(frames), "--substeps", "3"]
    found = cli.main([*line, "--out", str(out)])
    assert found == 1
    told = capsys.readouterr().err
    assert "--substeps 3: too few" in told
    assert told.count("\n") == 1
    assert not out.exists()
