"""Layouts: motifs within one repeat as long as what is cut from it, each in its rectangle, closing at its borders."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim_core.errors import WeaveError
from sim_core.weave import Weave
from sim_core.weave.draft.motifs import cut, read_motif

MOTIFS = Path(__file__).parents[3] / "assets" / "motifs"
BANDS = MOTIFS / "skirt-bands.toml"
LAYOUT = 'name = "x"\nrepeat = [100, 200]\n'
LINE = "[[part]]\nfill = 1\nwithin = [0, 20, 100, 30]\n"
FRETS = f'[[part]]\nmotif = "{MOTIFS / "frets.toml"}"\n'


def laid(folder: Path, text: str) -> np.ndarray:
    path = folder / "it.toml"
    path.write_text(LAYOUT + text, "utf-8")
    return cut(read_motif(path), 1000, 1000)


def test_a_number_fills_its_rectangle_and_later_parts_lie_over_earlier_ones(tmp_path: Path) -> None:
    made = laid(tmp_path, LINE + "[[part]]\nfill = 3\nwithin = [40, 10, 50, 25]\n")
    assert made.shape == (200, 100)
    assert [(made == k).sum() for k in (1, 3)] == [10 * 100 - 5 * 10, 15 * 10]
    assert (made[10:25, 40:50] == 3).all()


def test_a_motif_stays_within_its_rectangle_and_closes_where_it_reaches_the_borders(tmp_path: Path) -> None:
    made = laid(tmp_path, FRETS + "parameters = { unit = 6.4, line = 2 }\nwithin = [0, 50, 100, 101]\n")
    assert not made[:50].any()
    assert not made[101:].any()
    band = made[50:101]
    # Frets of 25.6 mm are stretched or shrunk to four in the width: 25 mm.
    assert np.array_equal(band, np.roll(band, 25, axis=1))
    free = laid(tmp_path, FRETS + "parameters = { unit = 6.4, line = 2 }\nwithin = [10, 50, 90, 101]\n")[
        50:101, 10:90
    ]
    assert not np.array_equal(free[:, 25:], free[:, :-25])
    assert (free[:, 26:] == free[:, :-26]).mean() > 0.9  # 25.6 mm apart


def test_numbers_become_others_and_the_ground_is_seen_or_not(tmp_path: Path) -> None:
    line = "[[part]]\nfill = 2\nwithin = [0, 0, 100, 200]\n"
    seen = laid(tmp_path, line + FRETS + "within = [20, 20, 60, 60]\n")
    hidden = laid(tmp_path, line + FRETS + "within = [20, 20, 60, 60]\nnumbers = [0, 4]\n")
    assert set(np.unique(seen[20:60, 20:60])) == {1, 2}
    assert set(np.unique(hidden[20:60, 20:60])) == {0, 4}
    assert np.array_equal(seen[20:60, 20:60] == 1, hidden[20:60, 20:60] == 4)


def test_a_strip_turned_runs_along_the_weft(tmp_path: Path) -> None:
    vine = f'[[part]]\nmotif = "{MOTIFS / "vine-strips.toml"}"\nparameters = {{ width = 40, height = 50 }}\n'
    upright = laid(tmp_path, vine + "within = [0, 0, 40, 100]\n")[:100, :40]
    along = laid(tmp_path, vine + "within = [0, 0, 100, 40]\nturned = true\nat = [100, 0]\n")[:40, :100]
    assert (along != np.rot90(upright, -1)).mean() < 0.02  # rows count upwards


def test_a_place_puts_a_motif_where_it_is_wanted(tmp_path: Path) -> None:
    flower = (
        f'[[part]]\nmotif = "{MOTIFS / "rank-flowers.toml"}"\nparameters = {{ diameter = 30, spacing = 4 }}\n'
    )
    made = laid(tmp_path, flower + "within = [30, 80, 70, 120]\nat = [50, 100]\n")
    there = np.argwhere(made > 0)
    assert there.mean(0) == pytest.approx([99.5, 49.5], abs=0.3)
    assert np.ptp(there, axis=0) == pytest.approx([28, 28], abs=4)  # six petals are not as high as wide


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "program: give a program, or svg, or [[part]] tables"),
        ("[[part]]\nfill = 1\nwithin = [0, 20, 101, 30]\n", "part.1.within: [0.0, 20.0, 101.0, 30.0] – left"),
        (LINE + "[[part]]\n", "part.2: give it a motif file or fill"),
        ("[[part]]\nfill = 1\nat = [2, 3]\n", "part.1: parameters, at, turned and numbers are a motif's"),
        (LINE + FRETS + "numbers = [1]\n", "part.2.numbers: 1 for a motif of 2"),
        (FRETS + "parameters = { width = 3 }\n", "part.1.motif: "),
        (FRETS + "parameters = { unit = 0.1, line = 0.04 }\n", "repeats of it – make it larger"),
        (f'[[part]]\nmotif = "{BANDS}"\n', "is a layout, too"),
        ('[[part]]\nmotif = "none.toml"\n', "part.1.motif: "),
        ('[[part]]\nmotif = "it.toml"\n', "part.1.motif: it.toml is a layout, too"),
        ("[[part]]\nfill = -1\n", "part.1.fill: -1"),
        (FRETS + "at = [1e308, 0]\n", "part.1.at.1"),
        (FRETS + "parameters = { unit = 0.05, line = 0.02 }\n", "repeats of it – make it larger"),
        ("parameters = { width = 3 }\n" + LINE, "parameters: a layout has none"),
    ],
)
def test_mistakes_are_named_by_file_and_part(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(WeaveError, match=r"it\.toml: ") as told:
        laid(tmp_path, text)
    assert words in str(told.value)


def test_what_only_layouts_may_be_called_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('name = "x"\nprogram = "layout"\nparameters = { width = 3 }\n', "utf-8")
    with pytest.raises(WeaveError, match=r"mine\.toml: program: 'layout' – there are"):
        read_motif(path)
    path.write_text('name = "x"\nrepeat = [0.05, 3]\n' + LINE, "utf-8")
    with pytest.raises(WeaveError, match=r"mine\.toml: repeat\.1: 0\.05"):
        read_motif(path)


def test_a_skirt_length_has_its_bands_at_their_heights_and_is_stored_as_its_recipe() -> None:
    weave = Weave.load(MOTIFS.parent / "weaves" / "skirt-duan.toml")
    numbers = weave.numbers
    assert numbers is not None
    assert weave.size == pytest.approx((0.22, 0.93), rel=0.005)
    height = (np.arange(len(numbers)) + 0.5) * weave.size[1] / len(numbers) * 1000
    bare = (height > 100) & (height < 378) | (height > 530)
    assert not numbers[bare].any()
    for low, high in ((13, 91), (390, 518)):
        share = (numbers[(height > low) & (height < high)] > 0).mean()
        assert 0.1 < share < 0.5
    assert len(str(weave.to_dict()["figure"])) < 2000
    assert np.array_equal(Weave.from_dict(weave.to_dict()).draft.lift, weave.draft.lift)
