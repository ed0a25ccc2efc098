"""Figured silks at the scale of garments: a motif file and a few small weaves become thousands of ends, and one map."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from sim_core.cli import main
from sim_core.errors import WeaveError
from sim_core.weave import (
    Weave,
    facts_of,
    lit_cloth,
    measured,
    parameters_of,
    solve,
    summary_of,
)
from sim_core.weave.draft import Figure, float_statistics
from sim_core.weave.files import source_of
from sim_core.weave.maps import FiguredMaps, drawn_maps, figured_maps

FOLDER = Path(__file__).parents[2] / "assets" / "weaves"
FIGURED = ["cloud-jin", "cup-luo", "flower-zhuanghua", "lian-duan", "lozenge-qi", "roundel-ling"]
TILT = np.radians(40)


@pytest.fixture(scope="module")
def drawn():
    made: dict[str, tuple] = {}

    def of(name: str):
        if name not in made:
            weave = Weave.load(FOLDER / f"{name}.toml")
            geometry = solve(weave, particles=True)
            made[name] = weave, geometry, drawn_maps(weave, geometry, pixels=512)
        return made[name]

    return of


@pytest.mark.parametrize("name", FIGURED)
def test_a_figured_silk_closes_keeps_its_size_and_is_drawn_where_its_motif_is(drawn, name):
    weave, geometry, maps = drawn(name)
    assert weave.figure is not None
    motif = weave.figure.motif
    assert weave.size == pytest.approx(motif.size, rel=0.03)  # gives way to close, by part of a weave
    for cell in weave.cells:
        times = [whole / own for whole, own in zip(weave.size, cell.size, strict=True)]
        assert times == pytest.approx(np.round(times), abs=1e-6)
    assert isinstance(maps, FiguredMaps)
    assert sum(geometry.shares) == pytest.approx(1)
    there = [(maps.number == k).mean() for k in range(len(maps.cells))]
    assert there == pytest.approx(geometry.shares, abs=0.02)
    assert float_statistics(weave.draft)  # a draft of so many yarns can be told


@pytest.mark.parametrize("name", FIGURED)
def test_what_is_stored_of_a_figured_silk_is_its_recipe(drawn, name):
    weave, _, _ = drawn(name)
    told = json.dumps(weave.to_dict())
    assert len(told) < 3000
    assert Weave.from_dict(json.loads(told)) == weave


@pytest.mark.parametrize("name", FIGURED)
def test_parameters_are_the_cells_means_and_so_are_their_bands(drawn, name):
    weave, geometry, _ = drawn(name)
    whole = parameters_of(weave, geometry)
    each = [parameters_of(cell, rest) for cell, rest in zip(weave.cells, geometry.cells, strict=True)]
    assert whole.density == pytest.approx(np.dot(geometry.shares, [one.density for one in each]))
    assert whole.thickness == max(one.thickness for one in each)
    for key, (least, most) in whole.bounds.items():
        assert least <= getattr(whole, key) <= most
        if key != "thickness":
            assert least == pytest.approx(np.dot(geometry.shares, [one.bounds[key][0] for one in each]))
            assert "cells by area" in whole.provenance[key]
    assert measured(weave, geometry)["areal_density"] == pytest.approx(whole.density)


def luminance(maps, lamp) -> list[float]:
    """Median luminance of each cell of a lit map."""
    light = ((lit_cloth(maps, light=lamp) / 255) ** 2.2) @ [0.2126, 0.7152, 0.0722]
    return [float(np.median(light[maps.number == k])) for k in range(len(maps.cells))]


def test_a_damask_of_one_colour_shows_its_figure_by_the_way_it_turns_the_light(drawn):
    """Ground and figure change places as the lamp goes round; even where neither gains, the figure can be read."""
    weave, _, maps = drawn("lian-duan")
    assert weave.warp.colour == weave.weft.colour
    ground, figure = luminance(maps, (np.sin(TILT), 0, np.cos(TILT)))  # across the warp: the ground gleams
    assert ground > 1.4 * figure
    ground, figure = luminance(maps, (0, np.sin(TILT), np.cos(TILT)))
    assert figure > 1.4 * ground
    ground, figure = luminance(maps, (-0.35, 0.5, 0.75))
    assert max(ground, figure) > 1.1 * min(ground, figure)


def test_a_jin_shows_its_colours(drawn):
    weave, _, maps = drawn("cloud-jin")
    for number, colour in enumerate(weave.warp_colours):
        mean = maps.albedo[maps.number == number].mean(axis=0) / 255
        others = [np.abs(mean - np.array(c)).sum() for c in weave.warp_colours]
        assert int(np.argmin(others)) == number, colour


def test_a_close_map_shows_the_yarns_of_the_cell_that_lies_there():
    """A repeat of 1 cm drawn in 2,048 pixels is finer than its yarns: it shows them, as its cells' own maps do."""
    told = Weave.load(FOLDER / "lozenge-qi.toml").to_dict()
    told["figure"]["parameters"] = [["width", 10.0], ["height", 10.0], ["lines", 1.0]]
    weave = Weave.from_dict(told)
    maps = figured_maps(weave, solve(weave), pixels=2048)
    for number, cell in enumerate(maps.cells):
        own = maps.normal[maps.number == number].astype(float).std(axis=0)
        assert own[:2] == pytest.approx(cell.normal.reshape(-1, 3).std(axis=0)[:2], rel=0.35)


def test_a_repeat_drawn_twice_has_no_seam(drawn):
    """Across its border pixels differ no more than they do inside."""
    for name in ("lian-duan", "cloud-jin"):
        _, _, maps = drawn(name)
        picture = maps.albedo.astype(float)
        for axis in (0, 1):
            steps = np.abs(np.roll(picture, -1, axis=axis) - picture).mean(axis=(1 - axis, 2))
            assert steps[-1] < 1.5 * np.median(steps) + 1


def test_the_command_tells_a_figured_silk_and_its_cells():
    weave = Weave.load(FOLDER / "cloud-jin.toml")
    geometry = solve(weave)
    told = summary_of(weave, geometry, 0.0, "")
    assert [cell["share"] for cell in told["cells"]] == pytest.approx(geometry.shares)
    assert told["areal_density"] == pytest.approx(measured(weave, geometry)["areal_density"])
    facts = facts_of(source_of(str(FOLDER / "lozenge-qi.toml")))
    assert facts["integral"]
    assert facts["floats"]["warp"]["longest"] <= 5


WRONG = {
    'motif = "nowhere.toml"': (WeaveError, "nowhere.toml: No such file"),
    'motif = "../motifs/vines.toml"\nparameters = { height = "high" }': (WeaveError, "parameters.height"),
    'motif = "../motifs/vines.toml"\nparameters = { tall = 3.0 }': (WeaveError, "tall: unknown"),
    'motif = ["01", "10"]\nparameters = { height = 3.0 }': (WeaveError, "rows of draft.motif have none"),
    'motif = "../motifs/vines.toml"\nground = "sateen"': (WeaveError, "no such weave"),
    'motif = "../motifs/vines.toml"\nfigure = []': (WeaveError, "draft.figure: missing"),
}


@pytest.mark.parametrize("lines", WRONG)
def test_what_a_weave_file_says_of_a_motif_wrongly_is_named(tmp_path, lines):
    kind, said = WRONG[lines]
    text = (FOLDER / "lian-duan.toml").read_text("utf-8")
    head, rest = text.split("[draft]")[0], text.split("longest = 8")[1]
    draft = '[draft]\nkind = "damask"\n' + lines.replace("../motifs", str(FOLDER.parent / "motifs"))
    if "figure" not in lines:
        draft += '\nfigure = "satin:5/2:weft"'
    (tmp_path / "x.toml").write_text(head + draft + rest, "utf-8")
    with pytest.raises(kind, match=said) as told:
        Weave.load(tmp_path / "x.toml")
    assert "\n" not in str(told.value)


LONGEST = {
    "zhuanghua": {"warp": 4, "weft": 4, "extra": 6},
    "flower-zhuanghua": {"warp": 4, "weft": 4, "extra": 6},
    "luo": {"warp": None, "weft": None},
    "cup-luo": {"warp": None, "weft": None},
    "jin": {"warp": 3, "weft": None},
    "twill": {"warp": 3, "weft": 3},
}


@pytest.mark.parametrize("name", LONGEST)
def test_floats_are_those_a_weaver_counts(name):
    """Those of a brocade's satin, of extra wefts between binding ends (every sixth, none at a rim); none of a leno."""
    told = facts_of(source_of(str(FOLDER / f"{name}.toml")))
    assert {side: one["longest"] for side, one in told["floats"].items()} == LONGEST[name]


def test_floats_that_are_none_are_told_as_such(capsys):
    assert main(["weave", str(FOLDER / "luo.toml")]) == 0
    assert "no floats of warp and weft, hangs together" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["anhuaduan", "lian-duan"])
def test_a_float_limit_below_the_floats_of_its_own_weaves_is_refused(tmp_path, name):
    """Rows written out and a motif file: binding would make another weave of the satin, all over the cloth."""
    text = (FOLDER / f"{name}.toml").read_text("utf-8").replace("../motifs", str(FOLDER.parent / "motifs"))
    path = tmp_path / "x.toml"
    path.write_text(re.sub(r"longest = \d", "longest = 4", text), "utf-8")
    assert max(f.longest for f in float_statistics(Weave.load(path).draft)) == 4
    path.write_text(re.sub(r"longest = \d", "longest = 3", text), "utf-8")
    with pytest.raises(WeaveError) as told:
        Weave.load(path)
    assert str(told.value) == (
        f"{path}: draft.longest: 3 – satin:5/2 itself floats over 4 crossings; give at least 4, or 0 for no limit"
    )
    with pytest.raises(WeaveError, match="longest: 3 – satin:5/2 itself"):  # of a recipe that was stored
        Figure("damask", "vines", words=("satin:5/2", "plain"), longest=3)


def test_a_compound_has_a_series_for_every_number():
    with pytest.raises(WeaveError, match="give it 4"):
        Figure("warp-compound", "roundels", (("colours", 3.0),), series=2)
    with pytest.raises(WeaveError, match="two weaves"):
        Figure("damask", "vines", words=("plain",))
    with pytest.raises(WeaveError, match="one of damask"):
        Figure("velvet", "vines")  # pyright: ignore[reportArgumentType]
