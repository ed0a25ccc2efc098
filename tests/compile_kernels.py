"""Makes the machine code that tests need, once: two workers that meet a kernel at the same time would both compile it.

    python tests/compile_kernels.py               all rooms, one after the other
    python tests/compile_kernels.py cloth light   these

`.ci/run` starts it on both cores, beside another step. What is made is kept where NUMBA_CACHE_DIR says; a kernel that
no room here calls is compiled by the first test that needs it, as without this script.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from sim_core.metrics import compile_clock

sys.path.insert(0, str(Path(__file__).parent / "hall_app"))
ASSETS = Path(__file__).parents[1] / "assets"
EDGE = 0.06  # [m] as coarse as the tests bake


def mesh() -> None:
    """Panels of both qualities: bare, with a hole and a line, and with lines that cross at a narrow angle."""
    from sim_core.mesh import panel_mesh

    outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    hole, line = [[0.6, 0.4], [0.6, 0.6], [0.8, 0.6], [0.8, 0.4]], [[0.3, 0.0], [0.35, 1.0]]
    for quality in ("fair", "best"):
        panel_mesh(outline, edge=0.2, quality=quality)
        panel_mesh(outline, edge=0.2, holes=[hole], constraints=[np.array(line)], quality=quality)
    narrow = [np.array([[0.2, 0.2], [0.8, 0.24]]), np.array([[0.2, 0.24], [0.8, 0.2]])]
    panel_mesh(outline, edge=0.1, constraints=narrow, quality="best")


def weave() -> None:
    """Yarns at rest, the cloth's parameters, and its maps."""
    from sim_core.weave import Weave, relax_particles, solve, surface_maps

    gauze = Weave.load(ASSETS / "weaves/gauze.toml")
    relax_particles(gauze)
    surface_maps(gauze, solve(gauze), pixels=64)


def cloth() -> None:
    """The published scenes, two frames of each: both precisions, wind, solids of every kind, layers."""
    from sim_core.cloth import Pace
    from sim_core.cloth.scenes import bar, scene

    made = [scene(name, frames=2, vertices=100) for name in ("flag", "drape", "teapot", "hanging")]
    for one in (*made, bar(0.1, seconds=0.08)):
        for pace in (None, Pace("single")):
            one.drape(pace=pace)


def garment() -> None:
    """A scarf on its stand, a robe and a gown on the figure, a few frames each, and what is measured and drawn."""
    from dataclasses import replace

    from sim_core.garment import choose_detail, dress, load_outfit
    from sim_core.picture import Camera, Surface, render

    for name in ("pibo", "robe", "gown"):
        outfit = load_outfit(ASSETS / f"outfits/{name}.toml").coarser(EDGE)
        layers = []
        for layer in outfit.layers:
            steps = tuple(replace(step, seconds=min(step.seconds, 0.2)) for step in layer.program.steps)
            layers.append(replace(layer, program=replace(layer.program, steps=steps)))
        (worn,) = dress(replace(outfit, layers=tuple(layers)))
        if name == "pibo":
            choose_detail(worn, 1e-9)  # one level
            render([Surface(worn.positions, worn.faces)], Camera((0, 1, 3), (0, 1, 0)), (8, 6))


def light() -> None:
    """A lit box with a spot in it."""
    from light_rooms import box, quads

    from hall_app.light import Sampling, Spot, bake_light

    room = quads(box((0, 0, 0), (2, 2, 2), inward=True), albedo=0.5, emission=[1, 0, 0, 0, 0, 0], density=4)
    spot = Spot(np.array([1, 1.9, 1]), np.array([1, 0.0, 1]), np.ones(3), 50.0, 20.0, 10.0)
    bake_light(room, [spot], sampling=Sampling((4, 4)))


def track() -> None:
    """A few frames by every filter."""
    from sim_core.track import KINECT, Recording, TrackSettings
    from sim_core.track import track as follow

    joints = np.random.default_rng(0).normal(size=(4, 25, 3))
    for name in ("none", "kalman", "one-euro"):
        follow(Recording(KINECT, np.arange(4) / 30.0, joints), TrackSettings(filter=name))


def learn() -> None:
    """A small sheet pooled by every method, upsampled, read in spirals and measured."""
    from sim_core.cloth.scenes import equilateral_sheet
    from sim_core.learn.convolution import spirals
    from sim_core.learn.evaluation import frame_errors
    from sim_core.learn.pooling import collapse, decimate, mean_absolute_curvature
    from sim_core.learn.upsampling import linear

    rest, faces = equilateral_sheet(0.5, 0.4, 0.05)
    frame = np.column_stack([rest, np.sin(9 * rest[:, 0])])
    decimate(rest, faces, mean_absolute_curvature([frame], faces), 0.8)
    pooled = collapse(rest, faces, frame[None], 0.8)
    made = linear(rest[pooled.kept], pooled.faces, rest) @ frame[pooled.kept]
    frame_errors(made, frame, faces, rest)
    spirals(faces, 9, rest)


ROOMS: dict[str, Callable[[], None]] = {
    "mesh": mesh,
    "weave": weave,
    "cloth": cloth,
    "garment": garment,
    "light": light,
    "track": track,
    "learn": learn,
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("room", nargs="*", help=f"of {', '.join(ROOMS)}; default: all")
    asked = parser.parse_args().room
    if strange := [room for room in asked if room not in ROOMS]:
        parser.error(f"{', '.join(strange)}: no room – choose from {', '.join(ROOMS)}")
    for room in asked or ROOMS:
        begin = time.monotonic()
        with compile_clock() as clock:
            ROOMS[room]()
        print(f"{room:<8} {clock.seconds:6.1f} s of {time.monotonic() - begin:.1f} s compiling", flush=True)


if __name__ == "__main__":
    main()
