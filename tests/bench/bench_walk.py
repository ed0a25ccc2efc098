"""A garment on a walking figure, frame by frame: how deep it is in the body, whether it crosses itself, its strain.

    python tests/bench/bench_walk.py [--motion assets/motions/walk.toml] [--rounds 1] [--clip FILE.bvh]
        [--room 0.035] [--garment FILE.npz] [--every 1] [--json FILE] [--frames FILE.npz]

The garment is carried on by `follow` from where it came to rest: the wearer comes from the pose it was dressed in into
the motion, then goes through whole loops in place (two strides of the walk each). Told a frame: the deepest vertex
inside the body [mm], vertices, midpoints and centroids inside, pairs of cloth that cross, area strain (95th
percentile), and time. Limits: 1 mm, no crossing, 4 %. The shown loop's frames are those after the lead. --clip: instead
of a loop the motion of somebody else's file, tracked, brought onto the figure and held in place, its whole length; its
arms are kept `--room` from the trunk, since who was captured wore no coat.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from sim_core import metrics
from sim_core.body import Loop, Mannequin, load_motion, pose_named
from sim_core.body.motion import RATE, figure_from, minimum_jerk
from sim_core.cloth.step import FRAME
from sim_core.garment import Garment, follow
from sim_core.track import KINECT, TrackSettings, read_recording, track

ROOT = Path(__file__).resolve().parents[2]
DEEPEST, STRAIN = 0.001, 0.04  # [m], share: the limits


def way(motion: Loop, figure: Mannequin, rounds: int) -> tuple[np.ndarray, int]:
    """The wearer's vertices (T, B, 3) [m] at the begin and end of every frame, and which frame the loop begins with."""
    poses = list(motion.course(pose_named("display"), figure))
    once = len(motion.times()) - 1
    lead = len(poses) - once - 1
    poses += poses[-once:] * (rounds - 1)
    return np.stack([figure.posed(pose) for pose in poses]), lead


def clip_way(path: Path, figure: Mannequin, room: float) -> tuple[np.ndarray, int]:
    """The same of a motion file: tracked points move the figure, whose root's way along the floor is taken out."""
    followed = track(read_recording(path), TrackSettings("none"))
    rate = 1.0 / float(np.median(np.diff(followed.time)))
    moved = figure_from(figure, followed.joints, KINECT.joints, rate=rate, room=room)
    print(f"arms raised by {moved.raised[0]:.1f} and {moved.raised[1]:.1f} degrees at most", flush=True)
    posed = moved.poses
    frames = np.clip(np.round(np.arange(0.0, len(posed) / rate, FRAME) * rate).astype(int), 0, len(posed) - 1)
    walked = [posed[k].shifted(x=-posed[k].shift[0], z=-posed[k].shift[2]) for k in frames]
    start, count = pose_named("display"), round(RATE)
    lead = [start.towards(walked[0], float(minimum_jerk(k / count))) for k in range(count)]
    return np.stack([figure.posed(pose) for pose in [*lead, *walked]]), count


def measured(garment: Garment, x: np.ndarray, body: np.ndarray, faces: np.ndarray) -> dict[str, Any]:
    """One frame: cloth x (V, 3) against the body (B, 3)."""
    inside = metrics.penetration(x, garment.faces, body, faces)
    strain = np.abs(metrics.area_strain(garment.rest_corners(), x, garment.faces))
    return {
        "deepest_mm": round(max(0.0, -1000 * inside.clearance[0]), 3),
        "inside": inside.total,
        "crossings": int(metrics.intersections(x, garment.faces)),
        "strain_p95": round(float(np.percentile(strain, 95)), 5),
        "strain_max": round(float(strain.max()), 4),
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--motion", type=Path, default=ROOT / "assets/motions/walk.toml")
    parser.add_argument("--clip", type=Path, help="a motion file (BVH, npz, CSV, JSON) instead of a loop")
    parser.add_argument("--room", type=float, default=0.035, help="[m] between arms and trunk in --clip")
    parser.add_argument("--garment", type=Path, default=ROOT / "assets/exhibits/beizi/baked/garment.npz")
    parser.add_argument("--figure", type=Path, default=ROOT / "assets/mannequins/woman.npz")
    parser.add_argument(
        "--rounds", type=int, default=1, help="loops after the lead (the walk: two strides each)"
    )
    parser.add_argument("--every", type=int, default=1, help="measure each so manieth frame")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--frames", type=Path, help="keep the cloth's frames and the body's")
    arguments = parser.parse_args()
    garment, figure = Garment.load(arguments.garment), Mannequin.load(arguments.figure)
    if arguments.clip is not None:
        body, lead = clip_way(arguments.clip, figure, arguments.room)
    else:
        motion = load_motion(arguments.motion)
        if not isinstance(motion, Loop):
            parser.error(f"--motion: {arguments.motion} does not repeat")
        body, lead = way(motion, figure, arguments.rounds)
    frames, ends = [garment.positions.astype(np.float32)], [time.process_time()]

    def heard(index: int, x: np.ndarray) -> None:
        frames.append(x)
        ends.append(time.process_time())
        sys.stderr.write(f"\rframe {index + 1} of {len(body) - 1}, {ends[-1] - ends[-2]:.1f} s")
        sys.stderr.flush()

    follow(garment, body, figure.faces, on_frame=heard)
    sys.stderr.write("\n")
    if arguments.frames:
        np.savez_compressed(arguments.frames, cloth=np.stack(frames), body=body.astype(np.float32))
    rows = []
    print(
        f"{'frame':>5} {'part':<6} {'deepest mm':>10} {'inside':>7} {'crossings':>9} {'strain95':>8} {'seconds':>8}"
    )
    for k in range(0, len(frames), arguments.every):
        row = measured(garment, frames[k].astype(float), body[k], figure.faces)
        row |= {"frame": k, "part": "lead" if k < lead else "loop"}
        row["seconds"] = round(ends[k] - ends[k - 1], 2) if k else 0.0
        rows.append(row)
        print(
            f"{k:5d} {row['part']:<6} {row['deepest_mm']:10.3f} {row['inside']:7d} {row['crossings']:9d}"
            f" {100 * row['strain_p95']:7.2f}% {row['seconds']:8.2f}",
            flush=True,
        )
    loop = [row for row in rows if row["part"] == "loop"]
    worst = {
        "deepest_mm": max(row["deepest_mm"] for row in loop),
        "crossings": max(row["crossings"] for row in loop),
        "strain_p95": max(row["strain_p95"] for row in loop),
        "frames_over_1_mm": sum(row["deepest_mm"] > 1000 * DEEPEST for row in loop),
        "frames_crossed": sum(row["crossings"] > 0 for row in loop),
        "frames_over_4_per_cent": sum(row["strain_p95"] > STRAIN for row in loop),
        "frames": len(loop),
        "seconds_a_frame": round(float(np.median(np.diff(ends[1:]))), 2),
    }
    print("loop: " + ", ".join(f"{name} {value}" for name, value in worst.items()))
    if arguments.json:
        arguments.json.write_text(json.dumps({"worst": worst, "frames": rows}, indent=1), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
