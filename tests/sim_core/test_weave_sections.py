"""Sections of yarns at rest and the filaments on them: area kept, room shared, light turned by the way floats run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench.weave_silk import ACROSS, ALONG, mirrored

from sim_core.errors import WeaveError
from sim_core.weave import Weave, Yarn, solve, surface_maps
from sim_core.weave.maps import highlight
from sim_core.weave.yarns import strands

FOLDER = Path(__file__).parents[2] / "assets" / "weaves"


@pytest.fixture(scope="module")
def relaxed():
    made: dict[str, tuple] = {}

    def of(name: str):
        if name not in made:
            weave = Weave.load(FOLDER / f"{name}.toml")
            made[name] = weave, solve(weave, particles=True)
        return made[name]

    return of


@pytest.mark.parametrize("name", ["satin", "twill", "gauze"])
def test_a_yarn_keeps_its_area_and_lies_where_its_axis_lay(relaxed, name):
    weave, geometry = relaxed(name)
    for system in strands(weave, geometry):
        area = system.half_width * system.half_height
        np.testing.assert_allclose(area, system.yarn.width * system.yarn.height / 4, rtol=1e-9)
        assert np.abs(system.side).max() < system.yarn.width / 2


@pytest.mark.parametrize("name", ["satin", "twill"])
def test_floats_spread_until_they_touch_and_overlap_nobody(relaxed, name):
    """Neighbours meet as stage B's contacts do, and over floats in one layer no gap is left between them."""
    weave, geometry = relaxed(name)
    warp = strands(weave, geometry)[0]
    places = warp.place[:, None] + warp.side
    gap = np.roll(places, -1, axis=0) - places
    gap[-1] += warp.across
    beside = [np.roll(values, -1, axis=0) for values in (warp.height, warp.half_width, warp.half_height)]
    lift = np.abs(beside[0] - warp.height) / (warp.half_height + beside[2])
    reach = (warp.half_width + beside[1]) * np.sqrt(np.maximum(1 - lift**2, 0))
    assert (reach - gap).max() < 0.12 * weave.warp.width
    assert warp.half_width.max() > 1.1 * weave.warp.width / 2
    top = 0.6 * warp.height.max()
    floats = (lift < 0.3) & (warp.height > top) & (beside[0] > top)
    assert np.abs(np.median((gap - reach)[floats])) < 0.03 * weave.warp.width


def test_twist_holds_filaments_together_and_turns_them(relaxed):
    weave, geometry = relaxed("satin")
    hard = replace(weave, warp=replace(weave.warp, twist=1500.0))
    loose, held = (strands(one, geometry)[0] for one in (weave, hard))
    assert held.half_width.max() <= weave.warp.width / 2 * (1 + 1e-9) < loose.half_width.max()
    runs = [surface_maps(one, geometry, pixels=256).direction.astype(float) for one in (weave, hard)]
    warp = [np.abs(run[..., 1] - 127.5) > 100 for run in runs]
    lean = [np.abs(run[..., 0] - 127.5)[there].mean() for run, there in zip(runs, warp, strict=True)]
    assert lean[1] > lean[0] + 10
    with pytest.raises(WeaveError, match="turns a metre"):
        Yarn(1e-4, 5e-6, twist=1e6)


@pytest.mark.parametrize(("name", "least"), [("satin", 4.0), ("satin-8", 4.0), ("twill", 2.5)])
def test_floats_gleam_for_a_lamp_tilted_across_them(relaxed, name, least):
    maps = surface_maps(*relaxed(name), pixels=1024)
    assert mirrored(maps, ACROSS) > least * mirrored(maps, ALONG)
    assert highlight(maps, ACROSS).mean() > 0.75 * least * highlight(maps, ALONG).mean()


def test_a_map_too_coarse_for_filaments_gleams_as_wide(relaxed):
    """What a pixel no longer shows makes its highlight wider: the mean stays within a third from 128 to 1024 pixels."""
    fine, coarse = (surface_maps(*relaxed("satin"), pixels=n, repeats=(6, 3)) for n in (1024, 128))
    for lamp in (ACROSS, ALONG):
        assert highlight(coarse, lamp).mean() == pytest.approx(highlight(fine, lamp).mean(), rel=0.34)
