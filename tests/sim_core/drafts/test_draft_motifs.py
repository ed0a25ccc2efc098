"""Motifs: every program draws, what is cut closes over its borders and covers what it covers, files are told apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim_core.errors import FileProblem, WeaveError
from sim_core.weave.draft.motifs import PROGRAMS, Motif, cut, motif_of_program, read_motif

MOTIFS = Path(__file__).parents[3] / "assets" / "motifs"


def box(x: float, y: float, width: float, height: float):
    from shapely import box

    return box(x, y, x + width, y + height)


def test_what_leaves_the_repeat_comes_in_at_the_other_side() -> None:
    for x in (-0.03, 0.07, 0.17):
        motif = Motif("box", (0.1, 0.1), ((1, box(x, 0.08, 0.06, 0.05)),))
        made = cut(motif, 100, 100)
        rows, columns = np.flatnonzero(made.any(1)), np.flatnonzero(made.any(0))
        assert rows.tolist() == [0, 1, 2, 8, 9]
        assert columns.tolist() == [0, 1, 2, 7, 8, 9]
        assert made.sum() == 30


def test_areas_upon_one_another_and_holes_and_wide_ones() -> None:
    whole = box(0, 0, 0.1, 0.1)
    holed = box(0.02, 0.02, 0.06, 0.06).difference(box(0.04, 0.04, 0.02, 0.02))
    made = cut(
        Motif("holes", (0.1, 0.1), ((2, whole), (1, holed), (0, box(0.02, 0.02, 0.01, 0.01)))), 100, 100
    )
    assert [(made == k).sum() for k in range(3)] == [1, 31, 68]
    wide = cut(Motif("wide", (0.1, 0.1), ((1, box(-0.02, 0.03, 0.17, 0.02)),)), 100, 100)
    assert (wide.any(1) == wide.all(1)).all()  # it laps over itself and is covered all the same
    assert wide.sum() == 20


@pytest.mark.parametrize("program", list(PROGRAMS))
def test_a_program_covers_as_much_as_its_areas_and_repeats_without_a_seam(program: str) -> None:
    from shapely import unary_union
    from shapely.affinity import translate

    motif = motif_of_program(program, program)
    made = cut(motif, 3000, 3000)
    assert made.shape == tuple(round(3000 * side) for side in motif.size[::-1])
    assert 0.1 < (made > 0).mean() < 0.7
    assert made.max() == motif.colours - 1
    moved = Motif(
        program, motif.size, tuple((n, translate(a, motif.size[0], -motif.size[1])) for n, a in motif.areas)
    )
    assert (
        cut(moved, 3000, 3000) != made
    ).mean() < 5e-3  # edges that lie on a middle may fall to either side
    number, area = motif.areas[0]
    if unary_union([area]).area < 0.5 * motif.size[0] * motif.size[1]:
        alone = cut(Motif(program, motif.size, ((number, area),)), 3000, 3000)
        assert (alone > 0).mean() == pytest.approx(area.area / motif.size[0] / motif.size[1], rel=0.05)


def test_counts_give_way_to_the_weaves_that_are_bound_in() -> None:
    motif = motif_of_program("lozenges", "lozenges")
    assert cut(motif, 9000, 5200, multiple=(10, 8)).shape == (330, 360)
    with pytest.raises(WeaveError, match="at most 16,384"):
        cut(motif_of_program("v", "vines"), 100_000, 4000)


def test_files_hold_all_programs_and_mistakes_are_named(tmp_path: Path) -> None:
    found = {path.stem: read_motif(path) for path in sorted(MOTIFS.glob("*.toml"))}
    assert set(found) == {*PROGRAMS, "skirt-bands", "edge-vine", "cranes"}
    assert read_motif(MOTIFS / "roundels.toml").colours == 4
    assert read_motif(MOTIFS / "frets.toml", {"unit": 3}).size == (0.012, 0.012)
    path = tmp_path / "mine.toml"
    for text, words in (
        ('name = "x"\nprogram = "dragons"\n', "program: 'dragons' – there are lozenges"),
        (
            'name = "x"\nprogram = "frets"\nparameters = { width = 3 }\n',
            "parameters.width: unknown – frets has unit, line",
        ),
        ('name = "x"\nprogram = "frets"\nparameters = { unit = -3 }\n', "parameters.unit: -3"),
        (
            'name = "x"\nprogram = "vines"\nparameters = { petals = 2.5 }\n',
            "parameters.petals: 2.5 – a whole number",
        ),
        ('name = "x"\nprogram = "frets"\ncolour = 3\n', "colour"),
    ):
        path.write_text(text, "utf-8")
        with pytest.raises(WeaveError, match="mine.toml: ") as told:
            read_motif(path)
        assert words in str(told.value)
    with pytest.raises(FileProblem):
        read_motif(tmp_path / "none.toml")
