"""An outfit that names a motion: the clip that is baked beside the hall's model, and plays on it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from plain_garments import SHORT, plain_maps
from scipy.spatial import KDTree

from hall_app.build import play, write_motion
from hall_app.content.models import TrackedMotion
from sim_core import metrics
from sim_core.body import Motion, Pose
from sim_core.garment import Clothed, Outfit, choose_detail, dress, load_outfit, write_glb
from sim_core.garment.clip import Clip
from sim_core.garment.levels import shown_figure
from sim_core.gltf import glb_parts

pytestmark = pytest.mark.slow

ASSETS = Path(__file__).parents[2] / "assets"
SHORTER = tuple(step for step in SHORT if step.do != "close")


def raising(outfit: Outfit) -> Outfit:
    """Dressed in a second, then the arms are lifted a little and lowered again, in six frames."""
    layers = tuple(
        replace(layer, program=replace(layer.program, steps=SHORTER), edge=0.05) for layer in outfit.layers
    )
    low, high = Pose.arms(10.0, 2.0), Pose.arms(7.0, 4.0)
    return replace(outfit, layers=layers, pose=low, motion=Motion(((0.12, high), (0.12, low))))


def test_the_clip_of_an_outfit_that_moves(tmp_path: Path):
    outfit = raising(load_outfit(ASSETS / "outfits" / "beizi.toml"))
    assert outfit.wearer is not None
    garments = dress(outfit)
    level = choose_detail(garments[-1], 0.01)
    body = outfit.wearer.posed(outfit.pose), outfit.wearer.faces
    played = play(outfit, garments, lambda share, label: None)
    assert played is not None
    moments = [(outfit.wearer.posed(played.poses[3]), played.frames[0][3])]
    cloth = garments[-1].positions, garments[-1].faces
    figure = shown_figure(*body, *cloth, triangles=1600, moments=moments)
    write_glb(tmp_path / "hall.glb", [Clothed(level, plain_maps())], precision="hall", figure=figure)
    write_glb(
        tmp_path / "close.glb", [Clothed(garments[-1], plain_maps())], figure=shown_figure(*body, *cloth)
    )
    told = write_motion(outfit, garments, played, tmp_path, lambda share, label: None)
    assert told["moving_frames"] == 6
    assert told["moving_deepest_m"] == told["moving_self_intersections"] == told["moving_layer_order"] == 0
    assert 0 < told["moving_area_strain_p95"] < 0.1
    fine, clip = (Clip.load(tmp_path / name) for name in ("motion-close.clip", "motion.clip"))
    assert fine.meshes[0].count == len(garments[-1].positions) > clip.meshes[0].count
    assert (clip.frames, clip.loop, clip.rate) == (fine.frames, fine.loop, fine.rate) == (6, True, 25.0)
    tracked = TrackedMotion.load(tmp_path / "motion.points")
    assert (tracked.frames, tracked.loop, tracked.rate) == (clip.frames, clip.loop, clip.rate)
    for frame in (0, 3):  # on the base, as the model does
        away = KDTree(fine.positions(frame, fine.names[0])).query(tracked.cloth[frame])[0]
        assert (
            away < 0.5e-3
        ).sum() >= 2  # one in two hundred places of the cloth is as near to a vertex by chance
    names = {drawn.node for mesh in clip.meshes for drawn in mesh.drawn}
    document = glb_parts((tmp_path / "hall.glb").read_bytes()).document
    figure_nodes = {drawn.node for drawn in clip.figure.drawn} if clip.figure else set()
    assert {node["name"] for node in document["nodes"]} - names - figure_nodes == {"base"}
    name = clip.names[0]
    for frame in (0, 3, 5):
        posed = outfit.wearer.posed(played.poses[frame]) + [0.0, 0.025, 0.0]
        found = metrics.penetration(clip.positions(frame, name), clip.faces(name), posed, outfit.wearer.faces)
        assert found.vertices == 0
    assert np.abs(clip.positions(3, name) - clip.positions(0, name)).max() > 0.005


def test_an_outfit_without_a_motion_has_none():
    outfit = replace(load_outfit(ASSETS / "outfits" / "beizi.toml"), motion=None)
    assert play(outfit, (), lambda share, label: None) is None
