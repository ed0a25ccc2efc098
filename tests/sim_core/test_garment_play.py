"""An outfit's motion: its garments go through it with the wearer, and one that repeats closes without a jump."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from plain_garments import SHORT

from sim_core import metrics
from sim_core.body import Loop, Motion, Pose, load_motion
from sim_core.body.motion import Curve
from sim_core.errors import SimCoreError
from sim_core.garment import Garment, Outfit, Played, dress, load_outfit, move, moving_errors
from sim_core.garment.worn import Lengths, Pins

pytestmark = pytest.mark.slow

ASSETS = Path(__file__).parents[2] / "assets"


def coarse(outfit: Outfit) -> Outfit:
    layers = tuple(
        replace(layer, program=replace(layer.program, steps=SHORT), edge=0.05) for layer in outfit.layers
    )
    return replace(outfit, layers=layers)


@dataclass(frozen=True)
class Walked:
    outfit: Outfit
    garments: tuple[Garment, ...]
    played: Played


SWAY = (
    Curve("pelvis", "y", (0.0, 50.0), (6.0, -6.0)),
    Curve("shoulder", "x", (0.0, 50.0), (5.0, -5.0)),
)


@pytest.fixture(scope="module")
def walked() -> Walked:
    """Turned to and fro, arms swinging, thrice in two seconds, in a coat of large triangles."""
    outfit = coarse(load_outfit(ASSETS / "outfits" / "beizi.toml"))
    outfit = replace(outfit, motion=Loop("sway", 0.64, base=outfit.pose, curves=SWAY, lead=0.2))
    garments = dress(outfit)
    return Walked(outfit, garments, move(outfit, garments))


def test_a_motion_that_repeats_is_a_loop_of_one_round(walked: Walked) -> None:
    played = walked.played
    assert played.loop
    assert len(played.poses) == walked.outfit.repeats() == 16
    (frames,) = played.frames
    assert frames.shape == (16, *walked.garments[0].positions.shape)
    assert np.abs(frames[8] - frames[0]).max() > 0.02  # cloth moves


def test_a_walk_repeats_after_two_strides(walked: Walked) -> None:
    walk = replace(walked.outfit, motion=load_motion(ASSETS / "motions" / "walk.toml"))
    assert walk.repeats() == 56
    assert walk.poses()[-1].quaternions() == pytest.approx(walk.poses()[-57].quaternions(), abs=1e-9)


def test_pins_go_with_the_skin_they_are_in(walked: Walked) -> None:
    outfit, (garment,) = walked.outfit, walked.garments
    assert outfit.wearer is not None
    pins = Pins.of(garment, outfit.wearer, outfit.pose)
    assert len(pins.vertices) >= 2  # both shoulders
    assert pins.places(outfit.wearer.posed(outfit.pose)) == pytest.approx(garment.positions[pins.vertices])
    (frames,) = walked.played.frames
    for pose, x in zip(walked.played.poses, frames, strict=True):
        assert x[pins.vertices] == pytest.approx(pins.places(outfit.wearer.posed(pose)), abs=1e-5)


def test_a_loop_closes_without_a_jump_in_place_or_speed(walked: Walked) -> None:
    """From the last frame to the first, vertices go and turn no more than from any frame to the next."""
    (x,) = walked.played.frames
    steps = np.linalg.norm(np.diff(np.concatenate([x, x[:2]]), axis=0), axis=2)
    bends = np.linalg.norm(np.diff(np.concatenate([x[-2:], x, x[:2]]), n=2, axis=0), axis=2)
    assert np.percentile(steps[-2:], 99) <= np.percentile(steps[:-2], 99, axis=1).max()
    assert np.percentile(bends[-2:], 99) <= np.percentile(bends[2:-2], 99, axis=1).max()
    # .043 and .054 by two processors' rounding: cloth of large triangles falls now so, now so.
    assert 0.0 < walked.played.apart[0] < 0.08


def test_cloth_half_way_between_two_states_is_led_back_to_its_lengths(walked: Walked) -> None:
    """A mean of two ways in which sleeves lie is shorter than either."""
    (garment,), (frames,) = walked.garments, walked.played.frames
    held = np.arange(20)
    half = 0.5 * (frames[0].astype(float) + frames[8])
    led = Lengths.of(garment, held).relaxed(half)
    strains = [
        np.percentile(np.abs(metrics.area_strain(garment.rest_corners(), x, garment.faces)), 95)
        for x in (frames[0].astype(float), half, led)
    ]
    assert strains[1] > strains[0]
    assert strains[2] < 0.75 * strains[1]
    assert np.array_equal(led[held], half[held])


def test_every_frame_is_measured(walked: Walked) -> None:
    heard: list[float] = []
    few = [0, 5, 10, 15]
    played = replace(
        walked.played,
        poses=tuple(walked.played.poses[k] for k in few),
        frames=(walked.played.frames[0][few],),
    )
    (told,) = moving_errors(
        walked.outfit, walked.garments, played, progress=lambda share, _: heard.append(share)
    )
    # Hands poke through cloth of 5 cm triangles: what keeps its corners clear hides half an edge at most.
    assert told["deepest_m"] <= 0.5 * walked.outfit.layers[0].edge
    assert (
        told["layer_order"] <= 2
    )  # of 739 vertices: where fronts overlap by less than a triangle, rounding decides
    assert told["area_strain_p95"] < 0.1
    assert heard[-1] == 1.0
    sunk = played.frames[0].copy()
    sunk[2] *= np.float32(0.9)
    (wrong,) = moving_errors(walked.outfit, walked.garments, replace(played, frames=(sunk,)))
    assert wrong["deepest_m"] > told["deepest_m"] + 0.002
    assert wrong["area_strain_p95"] > told["area_strain_p95"]


def test_a_motion_gone_through_once_begins_as_the_garment_hangs(walked: Walked) -> None:
    low, high = walked.outfit.pose, Pose.arms(7.0, 4.0)
    once = replace(walked.outfit, motion=Motion(((0.2, high),)))
    played = move(once, walked.garments)
    assert (played.loop, len(played.poses), played.apart) == (False, 6, ())
    assert played.frames[0][0] == pytest.approx(walked.garments[0].positions, abs=1e-6)
    back = replace(once, motion=Motion(((0.2, high), (0.2, low))))
    assert back.repeats() == 10
    again = move(back, walked.garments)
    assert (again.loop, len(again.poses)) == (True, 10)
    assert again.poses[0] == low


def test_who_stands_has_no_motion(walked: Walked) -> None:
    with pytest.raises(SimCoreError, match="nobody moves"):
        move(replace(walked.outfit, motion=None), walked.garments)
