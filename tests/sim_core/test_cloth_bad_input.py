"""Bad input ends in one clear error before anything runs, by the public functions and by the command."""

import math
from pathlib import Path

import numpy as np
import pytest

from sim_core import cli
from sim_core.cloth import (
    Air,
    Box,
    Contact,
    HalfSpace,
    Holds,
    Live,
    Material,
    Pace,
    Phase,
    Sheet,
    Solid,
    Union,
    choose,
    drape,
    moving_mesh,
)
from sim_core.cloth.contact import field_of
from sim_core.cloth.run import adaptive_run
from sim_core.cloth.scenes import GF_CM, equilateral_sheet
from sim_core.cloth.sheet import mended
from sim_core.errors import SimCoreError

REST, FACES = equilateral_sheet(0.2, 0.2, 0.1)
SHEET = Sheet.of(REST, FACES, GF_CM)
PYRAMID = 0.1 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
SIDES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
FLAT = np.column_stack([REST[:, 0], np.zeros(len(REST)), REST[:, 1]])


def with_nan(x: np.ndarray) -> np.ndarray:
    return np.where(np.arange(len(x))[:, None] == 2, math.nan, x)


MESHES = {
    "rest: vertex 2 is not finite": lambda: Sheet.of(with_nan(REST), FACES, GF_CM),
    "faces: index 99": lambda: Sheet.of(REST, np.vstack([FACES, [0, 1, 99]]), GF_CM),
    "faces: index .*-1": lambda: Sheet.of(REST, np.vstack([FACES, [0, 1, -1]]), GF_CM),
    "more than two faces": lambda: Sheet.of(
        np.array([[0, 0], [1, 0], [0.5, 1], [0.5, -1], [0.4, 0.8]], float),
        np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]]),
        GF_CM,
    ),
    "the same three vertices": lambda: Sheet.of(REST, np.vstack([FACES, FACES[:1, [1, 0, 2]]]), GF_CM),
    "needle or has no area": lambda: Sheet.of(REST, np.vstack([FACES, [0, 0, 1]]), GF_CM),
    "density: -0.1": lambda: Material(-0.1, 50.0),
    "density: 0": lambda: Material(0.0, 50.0),
    "density: 'light'": lambda: Material("light", 50.0),  # type: ignore[arg-type]
    "bend_warp: -1": lambda: Material(0.05, 50.0, bend_warp=-1.0),
    "faces: rows of different length": lambda: Sheet.of(REST, [[0, 1, 2], [1, 2]], GF_CM),  # type: ignore[arg-type]
    "rest: .* no array of numbers": lambda: Sheet.of([["a", "b"]], FACES, GF_CM),  # type: ignore[arg-type]
    "rest: vertex 1 lies beyond": lambda: Sheet.of(1e200 * REST, FACES, GF_CM),
    "smaller than 1e-07 m": lambda: Sheet.of(1e-9 * REST, FACES, GF_CM),
    "material: a str": lambda: Sheet.of(REST, FACES, "silk"),  # type: ignore[arg-type]
    "kind: 3 to 3": lambda: Sheet.of_corners(REST[FACES], FACES, [GF_CM], np.full(len(FACES), 3)),
    "faces: 99 to": lambda: mended(REST, FACES + 99),
    "open or ill-wound": lambda: moving_mesh(PYRAMID[None], SIDES[:3]),
    "open or ill-wound at": lambda: field_of(PYRAMID, SIDES[:3]),
    "inside out": lambda: field_of(PYRAMID, SIDES[:, ::-1].copy()),
    "moving mesh: faces: index 12": lambda: moving_mesh(PYRAMID[None], SIDES + 9),
    "moving mesh: faces: .* expected": lambda: moving_mesh(PYRAMID[None], SIDES + 0.5),
    "moving mesh: frame 1 has vertices": lambda: moving_mesh(np.stack([PYRAMID, math.nan * PYRAMID]), SIDES),
    "moving mesh: frame 2 is turned inside out": lambda: moving_mesh(
        np.stack([PYRAMID, PYRAMID, PYRAMID * [1, 1, -1]]), SIDES
    ),
    "moving mesh: cell": lambda: moving_mesh(PYRAMID[None], SIDES, cell="a"),  # type: ignore[arg-type]
    "phase.seconds: 0.0": lambda: Phase(0.0),
    "phase.seconds: nan": lambda: Phase(math.nan),
    "phase.seconds: 1e.300 .* at most 40000": lambda: Phase(1e300),
    "phase.seconds: 'long'": lambda: Phase("long"),  # type: ignore[arg-type]
    "phase.gravity: 9.81 – two finite numbers": lambda: Phase(0.08, 9.81),  # type: ignore[arg-type]
    "phase.gravity: .9.81, inf": lambda: Phase(1.0, (9.81, math.inf)),
    "phase.gravity: .1e": lambda: Phase(1.0, (1e300, 1e300)),
    "phase.damping: -1": lambda: Phase(1.0, damping=-1.0),
    "phase.friction: nan": lambda: Phase(1.0, friction=math.nan),
    "phase.sewing: .nan": lambda: Phase(1.0, sewing=(math.nan, 0.0)),
    "phase.body: .nan": lambda: Phase(1.0, body=(math.nan, 0.0)),
    "phase.pins: 3 – give a sequence": lambda: Phase(1.0, pins=3),  # type: ignore[arg-type]
    "contact.clearance .m.: -1": lambda: Contact(clearance=-1.0),
    "contact.thickness .m.: nan": lambda: Contact(thickness=math.nan),
    "contact.every: 0": lambda: Contact(every=0),
    "contact.every: nan": lambda: Contact(every=math.nan),  # type: ignore[arg-type]
    "contact.untangle: nan": lambda: Contact(untangle=math.nan),  # type: ignore[arg-type]
    "contact.skin": lambda: Contact(thickness=0.002, skin=0.0),
    "contact.untangle: -1": lambda: Contact(untangle=-1),
    "union: a int": lambda: Union((3,)),  # type: ignore[arg-type]
    "box.yaw: nan": lambda: Box((0, 0, 0), (1, 1, 1), 0.0, math.nan),
    "halfspace.normal": lambda: HalfSpace(normal=(0.0, 0.0, 0.0)),
    "solid: it has no shape": lambda: Solid().packed(),
    "air.seed: -1": lambda: Air(seed=-1),
    "air.wind: 'x'": lambda: Air("x"),  # type: ignore[arg-type]
    "pace.courant.*'a'": lambda: Pace("double", "a"),  # type: ignore[arg-type]
    "holds.low: .*not NaN": lambda: Holds.of(len(REST), low=np.full(len(REST), math.nan)),
    "holds.pairs: .*float64": lambda: Holds.of(len(REST), pairs=[[0.5, 1.0]], positions=FLAT),  # type: ignore[arg-type]
    "error_mm.*'a'": lambda: choose("flag", error_mm="a"),  # type: ignore[arg-type]
    "size: .1, 1, 1. – width": lambda: choose("flag", error_mm=10, size=(1, 1, 1)),
}


@pytest.mark.parametrize("word", MESHES)
def test_meshes_and_materials_without_meaning_are_named(word: str) -> None:
    with pytest.raises(SimCoreError, match=word) as caught:
        MESHES[word]()
    assert "\n" not in str(caught.value)


RUNS = {
    "positions: vertex 2 is not finite": {"positions": with_nan(FLAT)},
    "positions: shape": {"positions": FLAT[:-1]},
    "velocities: vertex 2": {"velocities": with_nan(FLAT)},
    "there is none": {"phases": []},
    "phases: 3 – give a sequence": {"phases": 3},
    "phases: 1500000 frames": {"phases": [Phase(30_000.0)] * 2},
    "phase.pins: index 99": {"phases": [Phase(1.0, pins=(99,))]},
    "substeps: 0": {"substeps": 0},
    "substeps: -4": {"substeps": -4},
    "substeps: 3.5": {"substeps": 3.5},
    "substeps: 1000000000 ": {"substeps": 10**9},
    "pins: index 99": {"pins": [99]},
    "pins: 0.5": {"pins": [0.5]},
    "pins: 3 – give a sequence": {"pins": 3},
    "pins: None – give a sequence": {"pins": None},
    "down: .*three finite": {"down": (0.0, math.nan, 0.0)},
    "down: 'abc'": {"down": "abc"},
    "down: .0, 0, 0. has no direction": {"down": (0, 0, 0)},
    "integrator: 'magic'": {"integrator": "magic"},
    "collider: a tuple": {"collider": (PYRAMID, SIDES)},
    "body: keys 0.00 to 4.00": {
        "collider": moving_mesh(PYRAMID[None], SIDES),
        "phases": [Phase(0.04, body=(0.0, 4.0))],
    },
    "contact: a str": {"contact": "all of it"},
    "air: a str": {"air": "x"},
    "pace: a str": {"pace": "single"},
    "holds: a list": {"holds": []},
    "holds: of 3 vertices": {"holds": Holds.of(3)},
    "sheet: a str": {"sheet": "silk"},
    "positions: .*no array": {"positions": [["a"] * 3] * len(FLAT)},
    "velocities: vertex 0 lies beyond": {"velocities": 0 * FLAT + 1e200},
    "phases: 0: a int": {"phases": [3]},
    "no stable step": {"sheet": Sheet.of(REST, FACES, Material(1e-300, 50.0))},
    "certify: 'yes'": {"certify": "yes"},
    "on_frame: a int": {"on_frame": 3},
    "checkpoint: 3 – give the path": {"checkpoint": 3},
    "this is no state of a run": {"checkpoint": __file__},
    "this is a folder": {"checkpoint": str(Path(__file__).parent)},
    "for the checkpoint": {"checkpoint": Path(__file__) / "below a file"},
}


@pytest.mark.parametrize("word", RUNS)
def test_runs_without_meaning_are_named_before_anything_runs(
    word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ran(*_: object) -> None:
        raise AssertionError("a frame was simulated")

    monkeypatch.setattr(adaptive_run.Run, "frame_under", ran)
    if word == "no stable step":  # is seen where the first step is looked for
        monkeypatch.undo()
    given = {"sheet": SHEET, "positions": FLAT, "phases": [Phase(1.0)]} | RUNS[word]
    with pytest.raises(SimCoreError, match=word) as caught:
        drape(given.pop("sheet"), given.pop("positions"), given.pop("phases"), **given)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("more", "word"),
    [
        ({"gravity": (0.0, math.nan, 0.0)}, "gravity"),
        ({"gravity": (0.0, 1.0)}, "gravity"),
        ({"damping": -1.0}, "damping: -1"),
        ({"pins": [-1]}, "pins: index -1"),
        ({"substeps": 0}, "substeps: 0"),
        ({"damping": "much"}, "damping: 'much'"),
        ({"pins": [0.5]}, "pins: 0.5"),
    ],
)
def test_a_live_cloth_names_them_too(more: dict, word: str) -> None:
    with pytest.raises(SimCoreError, match=word):
        Live(SHEET, FLAT, **more)


@pytest.mark.parametrize(
    ("more", "word"),
    [
        ({"wind": (math.nan, 0.0, 0.0)}, "air.wind"),
        ({"wind": (1.0,)}, "air.wind"),
        ({"pins": [99]}, "pins: index 99"),
        ({"pins": [0.5]}, "pins: 0.5"),
        ({"wind": "abc"}, "air.wind: 'abc'"),
        ({"pulls": ([3.7], [[0.0, 0.0, 1.0]])}, "pulls: vertices: 3.7"),
        ({"pulls": 3}, "pulls: 3"),
        ({"targets": np.full((0, 2), 0.0)}, "targets: shape"),
        ({"pulls": ([0], [[math.nan, 0.0, 0.0]])}, "pulls"),
        ({"pulls": ([-1], [[1.0, 0.0, 0.0]])}, "pulls: vertices: index -1"),
        ({"body": math.nan}, "body: nan"),
    ],
)
def test_a_step_of_a_live_cloth_names_them_and_changes_nothing(more: dict, word: str) -> None:
    live = Live(SHEET, FLAT)
    with pytest.raises(SimCoreError, match=word):
        live.step(**{"wind": (9.0, 0.0, 0.0), "pins": [1]} | more)
    assert (live.pins, live.air, live.body) == ((), None, 0.0)
    assert live.frame == 0
    assert np.array_equal(live.positions, FLAT)
    live.damping = math.nan
    with pytest.raises(SimCoreError, match="damping: nan"):
        live.step()


@pytest.mark.parametrize(
    "words",
    [
        ["--frames", "0"],
        ["--substeps", "0"],
        ["--vertices", "-5"],
        ["--size", "nan,1"],
        ["--size=-1,1"],
        ["--size", "0.001,1"],
        ["--wind", "inf,0,0"],
        ["--gusts", "nan"],
        ["--error", "0"],
        ["--case", "99"],
        ["--pins", "nails"],
        ["--seed", "-1"],
        ["--integrator", "magic"],
        ["--error", "20", "--layers", "3"],
        ["--error", "20", "--gusts", "0.3"],
        ["--error", "20", "--precision", "single"],
        ["--error", "20", "--courant", "0.5"],
        ["--error", "20", "--vertices", "900"],
        ["--error", "20", "--integrator", "implicit"],
    ],
)
def test_the_command_says_it_in_one_line(words: list[str], capsys) -> None:
    try:
        status = cli.main(["cloth", "flag", *words])
    except SystemExit as left:
        status = left.code
    said = capsys.readouterr()
    assert status == 2
    assert said.out == ""
    assert "Traceback" not in said.err
    told = [line for line in said.err.splitlines() if not line.startswith((" ", "usage"))]
    assert len(told) == 1


def test_a_file_that_holds_something_else_is_not_written_over(tmp_path, capsys) -> None:
    notes = tmp_path / "notes.txt"
    notes.write_text("keep me", "utf-8")
    assert cli.main(["cloth", "flag", "--vertices", "60", "--frames", "1", "--resume", str(notes)]) == 2
    assert "no state of a run" in capsys.readouterr().err
    assert notes.read_text("utf-8") == "keep me"
