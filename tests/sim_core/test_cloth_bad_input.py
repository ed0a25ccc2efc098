"""Bad input ends in one clear error before anything runs, by the public functions and by the command."""

import math

import numpy as np
import pytest

from sim_core import cli
from sim_core.cloth import Box, Contact, HalfSpace, Live, Material, Phase, Sheet, Union, drape, moving_mesh
from sim_core.cloth import running as cloth_running
from sim_core.cloth.field import field_of
from sim_core.cloth.mending import mended
from sim_core.cloth.scenes import GF_CM, equilateral_sheet
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
    "density: light": lambda: Material("light", 50.0),  # type: ignore[arg-type]
    "bend_warp: -1": lambda: Material(0.05, 50.0, bend_warp=-1.0),
    "faces: rows of different length": lambda: Sheet.of(REST, [[0, 1, 2], [1, 2]], GF_CM),  # type: ignore[arg-type]
    "rest: no array of numbers": lambda: Sheet.of([["a", "b"]], FACES, GF_CM),  # type: ignore[arg-type]
    "rest: vertex 1 lies beyond": lambda: Sheet.of(1e200 * REST, FACES, GF_CM),
    "smaller than 1e-07 m": lambda: Sheet.of(1e-9 * REST, FACES, GF_CM),
    "material: a str": lambda: Sheet.of(REST, FACES, "silk"),  # type: ignore[arg-type]
    "kind: 3 to 3": lambda: Sheet.of_corners(REST[FACES], FACES, [GF_CM], np.full(len(FACES), 3)),
    "faces: 99 to": lambda: mended(REST, FACES + 99),
    "open or ill-wound": lambda: moving_mesh(PYRAMID[None], SIDES[:3]),
    "open or ill-wound at": lambda: field_of(PYRAMID, SIDES[:3]),
    "inside out": lambda: field_of(PYRAMID, SIDES[:, ::-1].copy()),
    "field: faces name vertices beyond": lambda: moving_mesh(PYRAMID[None], SIDES + 9),
    "moving mesh: faces: .* expected": lambda: moving_mesh(PYRAMID[None], SIDES + 0.5),
    "moving mesh: frame 1 has vertices": lambda: moving_mesh(np.stack([PYRAMID, math.nan * PYRAMID]), SIDES),
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
    "lasts 0.0 s": {"phases": [Phase(0.0)]},
    "lasts nan s": {"phases": [Phase(math.nan)]},
    "there is none": {"phases": []},
    "0 has gravity": {"phases": [Phase(1.0, (9.81, math.inf))]},
    "0: damping: -1": {"phases": [Phase(1.0, damping=-1.0)]},
    "0: friction": {"phases": [Phase(1.0, friction=math.nan)]},
    "substeps: 0": {"substeps": 0},
    "substeps: -4": {"substeps": -4},
    "pins: index 99": {"pins": [99]},
    "gravity: .*three finite": {"down": (0.0, math.nan, 0.0)},
    "contact.clearance: -1": {"contact": Contact(clearance=-1.0)},
    "contact.thickness: nan": {"contact": Contact(thickness=math.nan)},
    "contact.every: 0": {"contact": Contact(every=0)},
    "contact.skin": {"contact": Contact(thickness=0.002, skin=0.0)},
    "integrator": {"integrator": "magic"},
    "normal": {"collider": HalfSpace(normal=(0.0, 0.0, 0.0))},
    "collider: a tuple": {"collider": (PYRAMID, SIDES)},
    "union: a int": {"collider": Union((3,))},  # type: ignore[arg-type]
    "box: size": {"collider": Box((0, 0, 0), (1, 1, 1), 0.0, math.nan)},
    "contact: a str": {"contact": "all of it"},
    "contact.every: nan": {"contact": Contact(every=math.nan)},  # type: ignore[arg-type]
    "contact.untangle: -1": {"contact": Contact(untangle=-1)},
    "substeps: 3.5": {"substeps": 3.5},
    "pins: 0.5": {"pins": [0.5]},
    "positions: no array": {"positions": [["a"] * 3] * len(FLAT)},
    "velocities: vertex 0 lies beyond": {"velocities": 0 * FLAT + 1e200},
    "phases: 0 is a int": {"phases": [3]},
    "lasts long s": {"phases": [Phase("long")]},  # type: ignore[arg-type]
    "0: sewing: nan": {"phases": [Phase(1.0, sewing=(math.nan, 0.0))]},
    "0: body: nan": {"phases": [Phase(1.0, body=(math.nan, 0.0))]},
    "0 has gravity .1e": {"phases": [Phase(1.0, (1e300, 1e300))]},
    "no stable step": {"sheet": Sheet.of(REST, FACES, Material(1e-300, 50.0))},
    "certify: ": {"certify": "yes"},
}


@pytest.mark.parametrize("word", RUNS)
def test_runs_without_meaning_are_named_before_anything_runs(
    word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ran(*_: object) -> None:
        raise AssertionError("a frame was simulated")

    monkeypatch.setattr(cloth_running.Run, "frame_under", ran)
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
        ({"damping": "much"}, "damping: much"),
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
        ({"targets": np.full((0, 2), 0.0)}, "targets: shape"),
        ({"pulls": ([0], [[math.nan, 0.0, 0.0]])}, "pulls"),
        ({"pulls": ([-1], [[1.0, 0.0, 0.0]])}, "pulls: vertex"),
        ({"body": math.nan}, "body: nan"),
    ],
)
def test_a_step_of_a_live_cloth_names_them_and_changes_nothing(more: dict, word: str) -> None:
    live = Live(SHEET, FLAT)
    with pytest.raises(SimCoreError, match=word):
        live.step(**more)
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
        ["--wind", "inf,0,0"],
        ["--gusts", "nan"],
        ["--error", "0"],
        ["--case", "99"],
        ["--pins", "nails"],
        ["--seed", "-1"],
        ["--integrator", "magic"],
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
