"""The pattern language of several panels: measures, curves, seams with a direction, and errors that name the key."""

from pathlib import Path

import numpy as np
import pytest

from sim_core.errors import FileProblem, OutlineError, SimCoreError
from sim_core.garment import Pattern
from sim_core.garment.pattern import measured

ASSETS = Path(__file__).parents[2] / "assets" / "patterns"

BAG = """\
name = "bag"
edge = 0.05
mirror = true
dye = "#804020"
[measures]
wide = 200
tall = "2 * wide - 50"
[[panel]]
name = "sack"
outline = [
  { name = "top", at = [0, "-tall"] },
  { name = "low", at = [0, "tall"] },
  { name = "corner", at = ["wide", "tall"] },
  { name = "waist", at = ["0.8 * wide", 0], curve = [["wide", 200], ["wide", 100]] },
  { name = "back", at = ["wide", "-tall"], curve = [["wide", -100], ["wide", -200]] },
]
[[panel]]
name = "strap"
doubled = true
dye = "#102030"
along = "sack: low > corner"
outline = [
  { name = "a", at = [0, 0] },
  { name = "b", at = [30, 0] },
  { name = "c", at = [30, "along('sack: low > corner')"] },
  { name = "d", at = [0, "along('sack: low > corner')"] },
]
[[seam]]
middle = "sack: top > low"
[[seam]]
joined = ["sack: low > corner", "strap: b > c"]
[[seam]]
sewn = ["sack: corner > waist", "sack: back < waist"]
"""


def read(tmp_path: Path, text: str) -> Pattern:
    path = tmp_path / "bag.toml"
    path.write_text(text, "utf-8")
    return Pattern.load(path)


def test_seams_have_equal_steps_and_twins_meet(tmp_path: Path) -> None:
    pattern = read(tmp_path, BAG)
    cloth = pattern.cloth(0.03)
    for seam in pattern.seams:
        a = cloth.along(seam.a, pattern.panel(seam.a.panel))
        assert cloth.vertices[a[0]] == pytest.approx(seam.a.legs(pattern.panel(seam.a.panel))[0][0])
        if seam.b is None:
            assert np.isin(a, cloth.middle).all()
            continue
        b = cloth.along(seam.b, pattern.panel(seam.b.panel))
        assert len(a) == len(b)
        assert (cloth.closed[a] == cloth.closed[b]).all()
        steps = [np.linalg.norm(np.diff(cloth.vertices[side], axis=0), axis=1) for side in (a, b)]
        assert steps[0] == pytest.approx(steps[1], rel=0.03)
    assert len(cloth.pairs) == cloth.joined.max() - cloth.closed.max()
    assert pattern.panel("strap").doubled
    assert pattern.panel("strap").dye == pytest.approx((16 / 255, 32 / 255, 48 / 255))


def test_notches_of_a_seam_are_vertices_of_both_sides(tmp_path: Path) -> None:
    """They meet, also on sides with ease, and survive a dictionary."""
    eased = BAG.replace("\"along('sack: low > corner')\"", "\"1.01 * along('sack: low > corner')\"")
    text = eased.replace('"strap: b > c"]', '"strap: b > c"]\nnotches = [0.31, 0.77]', 1)
    pattern = read(tmp_path, text)
    assert [seam.notches for seam in pattern.seams] == [(), (0.31, 0.77), ()]
    assert Pattern.from_dict(pattern.to_dict()).seams == pattern.seams
    cloth, seam = pattern.cloth(0.03), pattern.seams[1]
    assert [len(fit.notches) for fit in cloth.fits] == [2, 0]
    fit = cloth.fits[0]
    assert seam.b is not None
    a, b = (cloth.along(path, pattern.panel(path.panel)) for path in (seam.a, seam.b))
    for path, side in ((seam.a, a), (seam.b, b)):
        length = path.length(pattern.panel(path.panel))
        steps = np.linalg.norm(np.diff(cloth.vertices[side], axis=0), axis=1)
        assert [steps[:at].sum() / length for at in fit.notches] == pytest.approx([0.31, 0.77])
    assert (cloth.closed[a[fit.notches]] == cloth.closed[b[fit.notches]]).all()
    assert fit.lengths == pytest.approx([0.2, 0.202])
    assert cloth.mirrored().fits[0].ease == pytest.approx(0.01)


def test_both_halves_are_mirror_images_joined_in_the_middle(tmp_path: Path) -> None:
    half = read(tmp_path, BAG).cloth(0.04)
    whole, count = half.mirrored(), len(half.vertices)
    assert whole.names == ("sack left", "strap left", "sack right", "strap right")
    assert whole.vertices[count:] == pytest.approx(half.vertices * [-1, 1])
    same = whole.closed[half.middle] == whole.closed[half.middle + count]
    assert same.all()
    apart = np.flatnonzero(~np.isin(half.closed, half.closed[half.middle]))
    assert not np.isin(whole.closed[apart], whole.closed[count + apart]).any()
    a, b, c = (whole.vertices[whole.faces[:, k]] for k in range(3))
    u, v = b - a, c - a
    area = u[:, 1] * v[:, 0] - u[:, 0] * v[:, 1]
    assert area.min() > 0  # in (x, -y), both halves


def test_patterns_survive_the_way_through_a_dictionary(tmp_path: Path) -> None:
    pattern = read(tmp_path, BAG)
    kept = pattern.to_dict()
    for panel in kept["panels"]:
        panel["layer"] = 1  # as garments have it that were saved before that key was gone
    again = Pattern.from_dict(kept)
    first, second = pattern.cloth(0.04), again.cloth(0.04)
    assert second.vertices.tobytes() == first.vertices.tobytes()
    assert second.closed.tobytes() == first.closed.tobytes()


@pytest.mark.parametrize("name", ["beizi", "robe"])
def test_shipped_patterns_are_cut(name: str) -> None:
    pattern = Pattern.load(ASSETS / f"{name}.toml")
    cloth = pattern.cloth(0.03)
    assert pattern.mirror
    assert len(cloth.pairs) > 20
    area = 2 * sum(abs(_area(panel.outline())) for panel in pattern.panels)
    assert 1.3 < area < 3.0


def _area(points: np.ndarray) -> float:
    x, y = points.T
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"2 * wide - 50"', '"2 * width"', ["measures.tall", "'width'", "wide"]),
        ('"2 * wide - 50"', '"2 * * wide"', ["measures.tall", "no expression"]),
        ('"2 * wide - 50"', '"wide / 0"', ["measures.tall", "zero"]),
        ('"2 * wide - 50"', "\"__import__('os')\"", ["measures.tall", "not known"]),
        ('name = "strap"', 'name = "sack"', ["panel.sack", "twice"]),
        ('name = "b"', 'name = "a"', ["panel.strap.outline", "'a'", "twice"]),
        ('middle = "sack: top > low"', 'middle = "sack: top > hem"', ["seam.1.middle", "'hem'", "top"]),
        ('middle = "sack: top > low"', 'middle = "sack: corner > waist"', ["seam.1.middle", "x = 0"]),
        ('middle = "sack: top > low"', 'middle = "sack top low"', ["seam.1.middle", "from > to"]),
        ('"strap: b > c"', '"strap: a > b"', ["seam.2.joined", "mm"]),
        ('"strap: b > c"', '"belt: b > c"', ["seam.2.joined", "'belt'", "no panel"]),
        ('"sack: back < waist"', '"sack: low > corner"', ["seam.3", "mm"]),
        ('"strap: b > c"', '"strap: b > b"', ["seam.2.joined", "no length", "two corners"]),
        ('middle = "sack: top > low"', 'middle = "sack: top > top"', ["seam.1.middle", "no length"]),
        ("along('sack: low > corner')", "along('sack: low > low')", ["strap.outline.c.at", "no length"]),
        ('"sack: back < waist"', '"sack: waist < corner"', ["seam.3", "sewn already"]),
        ("wide = 200", "wide = 200000", ["panel.sack.outline", "m wide", "20 m"]),
        ("wide = 200", "wide = true", ["measures.wide"]),
        ("edge = 0.05", "edge = true", ["edge", "True"]),
        ("mirror = true", "mirror = false", ["seam.1.middle", "mirror"]),
        ("doubled = true", "folded = true", ["panel.2.folded", "unknown key"]),
        ("doubled = true", "layer = 1", ["panel.2.layer", "unknown key"]),
        ("at = [30, 0]", 'at = [30, "x"]', ["panel.strap.outline.b.at", "'x'"]),
        ("joined = [", "notches = [1.5]\njoined = [", ["seam.2.notches.1", "less than 1", "1.5"]),
        ("middle = ", "notches = [0.5]\nmiddle = ", ["seam.1.notches", "leave them out"]),
        ('dye = "#102030"', 'dye = "blue"', ["panel.2.dye", "blue"]),
        ("edge = 0.05", "size = [1.0, 1.0]\nedge = 0.05", ["[[panel]]"]),
    ],
)
def test_mistakes_name_file_and_key(tmp_path: Path, old: str, new: str, words: list[str]) -> None:
    assert old in BAG
    with pytest.raises(FileProblem) as caught:
        read(tmp_path, BAG.replace(old, new, 1))
    message = str(caught.value)
    assert message.startswith(str(tmp_path / "bag.toml"))
    assert "\n" not in message
    assert all(word in message for word in words), message


def test_a_side_is_sewn_once(tmp_path: Path) -> None:
    twice = BAG + '[[seam]]\nsewn = ["sack: back < waist", "sack: corner > waist"]\n'
    with pytest.raises(FileProblem, match=r"seam\.4: .* sewn already"):
        read(tmp_path, twice)
    with pytest.raises(SimCoreError, match="no panel 'hood'"):
        read(tmp_path, BAG).panel("hood")


def test_measures_are_reckoned_and_nothing_else() -> None:
    known = {"a": 3.0, "b": 4.0}
    assert measured("max(a, b) * -2 + min(a, 1)", known) == -7.0
    assert measured(5, known) == 5.0
    for bad in ("a.b", "a if b else 1", "[a]", "open('x')", "lambda: 1", "a ** 9"):
        with pytest.raises(ValueError, match=r"not allowed|not known"):
            measured(bad, known)


def test_a_panel_smaller_than_the_trial_mesh_is_a_panel(tmp_path: Path) -> None:
    small = (
        BAG.replace("wide = 200", "wide = 30")
        .replace('"2 * wide - 50"', "15")
        .replace("at = [30, ", "at = [8, ")
    )
    small = small.replace('["wide", 200], ["wide", 100]', '["wide", 10], ["wide", 5]')
    small = small.replace('["wide", -100], ["wide", -200]', '["wide", -5], ["wide", -10]')
    pattern = read(tmp_path, small.replace("edge = 0.05", "edge = 0.005"))
    assert len(pattern.cloth().faces) > 50


def test_meshes_that_fail_name_their_panel(tmp_path: Path) -> None:
    pattern = read(tmp_path, BAG)
    with pytest.raises(OutlineError, match=r"^panel\.sack: edge 0\.0001 m makes more than 200000 vertices"):
        pattern.cloth(0.0001)
    with pytest.raises(OutlineError, match=r"^panel\.strap: edge 0\.5 m is longer than the panel"):
        pattern.cloth(0.5)
    for edge in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(SimCoreError, match="positive length"):
            pattern.cloth(edge)
