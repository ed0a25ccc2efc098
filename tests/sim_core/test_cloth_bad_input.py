"""Bad input ends in one clear error before anything runs, by the public functions and by the command."""

import math

import numpy as np
import pytest

from sim_core import cli
from sim_core.cloth import Contact, HalfSpace, Live, Material, Phase, Sheet, drape
from sim_core.cloth import running as cloth_running
from sim_core.cloth.scenes import GF_CM, equilateral_sheet
from sim_core.errors import SimCoreError

REST, FACES = equilateral_sheet(0.2, 0.2, 0.1)
SHEET = Sheet.of(REST, FACES, GF_CM)
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
}


@pytest.mark.parametrize("word", RUNS)
def test_runs_without_meaning_are_named_before_anything_runs(
    word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ran(*_: object) -> None:
        raise AssertionError("a frame was simulated")

    monkeypatch.setattr(cloth_running.Run, "frame_under", ran)
    given = {"positions": FLAT, "phases": [Phase(1.0)]} | RUNS[word]
    with pytest.raises(SimCoreError, match=word) as caught:
        drape(SHEET, given.pop("positions"), given.pop("phases"), **given)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("more", "word"),
    [
        ({"gravity": (0.0, math.nan, 0.0)}, "gravity"),
        ({"gravity": (0.0, 1.0)}, "gravity"),
        ({"damping": -1.0}, "damping: -1"),
        ({"pins": [-1]}, "pins: index -1"),
        ({"substeps": 0}, "substeps: 0"),
    ],
)
def test_a_live_cloth_names_them_too(more: dict, word: str) -> None:
    with pytest.raises(SimCoreError, match=word):
        Live(SHEET, FLAT, **more)


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
