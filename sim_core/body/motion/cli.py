"""`simcore motion`: how figures move. Motion files are drawn, measured and written as joints in time."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim_core.errors import FileProblem, SimCoreError, WrongArgument
from sim_core.validation.arguments import ending, number
from sim_core.validation.files import check_target, written_whole

if TYPE_CHECKING:
    import numpy as np

    from sim_core.body.mannequin import Mannequin
    from sim_core.body.motion.keys import Motion
    from sim_core.body.motion.loop import Loop
    from sim_core.body.pose import Pose

DESCRIPTION = """\
How a figure moves: a motion file says it as data, and any figure walks, turns or salutes by it with its own bones.

  simcore motion --list
      names the motion files of ./assets/motions (or --content), how long they are and what they do
  simcore motion assets/motions/walk.toml --picture walk.png
      draws it as a strip of poses, from the front and from its left
  simcore motion assets/motions/walk.toml --measure
      period, stride, speed; how far a planted foot slides [mm], how deep anything is in the floor [mm], how near
      limbs come to each other [mm], and what jumps where the loop begins again
  simcore motion assets/motions/walk.toml --out walk.npz [--in-place] [--rate 25]
      joints in time: time (T,) [s], joints (T, J, 3) [m, y up], joint_names (J,); turns (T, J, 3) rotation vectors
      [degrees] and shift (T, 3) [m] of the root, of which poses can be made again

A motion file that repeats is curves over a period, on top of a base pose, or keyed poses:

  name = "walk"
  title = { zh = "行走", en = "Walk" }
  period = 1.12                  # seconds
  rounds = 2                     # periods until the figure is as it was; of a turn until it faces as before
  lead = 1.0                     # seconds in which a wearer comes into it from where it stands
  pose = { name = "arms-down" }  # base; as everywhere: a name, or { name, joints, shift }

  [steps]                        # of a figure that steps; without it both feet stand where the base pose has them
  off = 0.62                     # share of the period a foot stands; flat = [0.12, 0.36]: shares it lies flat between
  width = 0.16                   # metres between the ankles; lift, toe_out [degrees]
  turn = 0.0                     # degrees to its left in a period, on the spot

  [[curve]]                      # as many as there are
  joint = "hip"                  # without _l or _r both sides, the right one half a period later (lag); or "root"
  axis = "x"                     # turns are about axes as they lie in the T-pose: x to its left, y up, z to its front
  at = [0, 31, 50, 75]           # per cent of the period; a periodic spline goes through
  degrees = [20, 0, -20, 15]     # metres = […] of the root
  scale = -0.75                  # and offset = 0.0
  source = "where the values are from"

  loop = true                    # keyed: instead of period, pose, steps and curves (which may go on top)
  [[key]]
  seconds = 1.8                  # until the pose is reached, by minimum jerk; the last key leads back to the begin
  early = 0.4                    # seconds by which it begins before the last key's move has ended
  pose = { name = "salute" }

A file of [[key]] tables without loop = true is gone through once, from where the wearer stands.
"""
POSES = 8  # of a strip
WIDTH, HEIGHT = 230, 400
FIGURE = "mannequins/woman.npz"


def add_parser(subparsers: Any) -> None:
    """Adds `motion` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "motion",
        help="how figures move: draw, measure and write motion files",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("motion", nargs="?", type=Path, metavar="MOTION.toml", help="the motion file")
    parser.add_argument("--list", action="store_true", help="name motion files")
    parser.add_argument(
        "--content", type=Path, metavar="DIR", default=Path("assets"), help="folder (default: assets)"
    )
    parser.add_argument(
        "--figure", type=Path, metavar="FILE.npz", help=f"who moves (default: {FIGURE} of --content)"
    )
    parser.add_argument("--picture", type=ending(".png"), metavar="PNG", help="draw a strip of poses")
    parser.add_argument("--out", type=ending(".npz"), metavar="FILE.npz", help="write joints in time")
    parser.add_argument("--measure", action="store_true", help="measure feet, floor, clearances and the loop")
    parser.add_argument(
        "--rate", type=number(1.0, 1000.0, " frames a second"), default=25.0, help="of --out (default: 25)"
    )
    parser.add_argument("--in-place", action="store_true", help="hold the root: it walks on the spot")
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Names, draws, measures, writes; returns the exit status."""
    if args.list:
        return _listed(args.content, args.json)
    if args.motion is None:
        raise WrongArgument("MOTION.toml: missing – give a motion file, or --list")
    if args.motion.suffix != ".toml":
        raise WrongArgument(f"{args.motion}: a motion file ends in .toml")
    if not (args.picture or args.out or args.measure):
        raise WrongArgument(
            f"{args.motion}: nothing to do – add --measure, --picture FILE.png or --out FILE.npz"
        )
    for path in (args.picture, args.out):
        if path is not None:
            check_target(path)
    from sim_core.body.mannequin import Mannequin
    from sim_core.body.motion.file import load_motion

    motion = load_motion(args.motion)
    figure = Mannequin.load(args.figure or args.content / FIGURE)
    facts: dict[str, Any] = {"motion": str(args.motion), "figure": figure.name}
    try:
        facts |= _facts(motion, figure)
        if args.measure:
            facts |= measured(motion, figure)
        times, poses = _played(motion, figure, args.rate, args.in_place)
    except SimCoreError as error:  # what a figure cannot do
        raise FileProblem(f"{args.motion}: {error}") from error
    if args.out:
        _write(args.out, figure, times, poses)
        facts |= {"out": str(args.out), "frames": len(poses)}
    if args.picture:
        from sim_core.picture import save_png

        save_png(args.picture, strip(figure, _differing(motion, poses)))
        facts |= {"picture": str(args.picture)}
    sys.stdout.write(_told(facts, args.json))
    return 0


def _facts(motion: Motion | Loop, figure: Mannequin) -> dict[str, Any]:
    from sim_core.body.motion.loop import Loop

    if not isinstance(motion, Loop):
        return {"loop": False, "seconds": round(sum(seconds for seconds, _ in motion.keys), 3)}
    stride = motion.stride(figure)
    facts: dict[str, Any] = {
        "loop": True,
        "period_s": motion.period,
        "rounds": motion.rounds,
        "seconds": motion.seconds,
    }
    if motion.steps is not None:
        facts |= {
            "steps_a_minute": round(120.0 / motion.period, 1),
            "stride_m": round(stride, 4),
            "speed_m_s": round(stride / motion.period, 3),
        }
    return facts


def measured(motion: Motion | Loop, figure: Mannequin) -> dict[str, Any]:
    """What a motion does on the floor, between limbs and at its seam, in millimetres, by the keys of --json."""
    from sim_core.body.motion.loop import Loop
    from sim_core.body.motion.measure import clearances, ground, seam

    _, poses = _played(motion, figure, 25.0, False)
    met = ground(figure, poses)
    facts: dict[str, Any] = {
        "slide_mm": {
            side: round(1000 * slide, 2) for side, slide in zip(("left", "right"), met.slide, strict=True)
        },
        "floor_mm": round(1000 * met.deepest, 2),
        "planted": {
            side: round(share, 3) for side, share in zip(("left", "right"), met.planted, strict=True)
        },
    }
    one = poses
    if isinstance(motion, Loop):
        one = poses[: len(poses) // motion.rounds + 1]  # further rounds are the same limbs elsewhere
    near = clearances(figure, one)
    facts["clearance_mm"] = {pair: round(1000 * least, 1) for pair, least in near.least.items()}
    if isinstance(motion, Loop):
        jump = seam(figure, motion)
        facts["seam"] = {
            "place_mm": round(1000 * jump.place, 4),
            "speed_mm_s": round(1000 * jump.speed, 3),
            "acceleration_m_s2": round(jump.acceleration, 3),
        }
    return facts


def _played(
    motion: Motion | Loop, figure: Mannequin, rate: float, in_place: bool
) -> tuple[np.ndarray, tuple[Pose, ...]]:
    """Times (T,) [s] and poses; of a motion gone through once at 25 frames a second, from the pose `display`."""
    import numpy as np

    from sim_core.body.motion.keys import RATE
    from sim_core.body.motion.loop import Loop
    from sim_core.body.pose import pose_named

    if isinstance(motion, Loop):
        return motion.times(rate), motion.poses(figure, rate=rate, in_place=in_place)
    poses = motion.poses(pose_named("display"))
    return np.arange(len(poses)) / RATE, poses


def _differing(motion: Motion | Loop, poses: tuple[Pose, ...]) -> tuple[Pose, ...]:
    """The poses of one period where further ones look the same, else all."""
    from sim_core.body.motion.loop import Loop

    if not isinstance(motion, Loop) or motion.steps is None or motion.steps.turn:
        return poses
    return poses[: len(poses) // motion.rounds + 1]


def _write(path: Path, figure: Mannequin, times: np.ndarray, poses: tuple[Pose, ...]) -> None:
    import numpy as np

    from sim_core.body.joints import JOINTS

    arrays = {
        "time": times,
        "joints": np.stack([figure.skeleton.joints(pose) for pose in poses]),
        "joint_names": np.array(JOINTS),
        "turns": np.array([[pose.vector(joint) for joint in JOINTS] for pose in poses]),
        "shift": np.array([pose.shift for pose in poses]),
    }
    with written_whole(path) as stream:
        np.savez_compressed(stream, **arrays)  # pyright: ignore[reportArgumentType]


def strip(figure: Mannequin, poses: tuple[Pose, ...]) -> np.ndarray:
    """A picture (H, W, 3): poses spread evenly over the motion, from the front above, from the left below."""
    import numpy as np

    from sim_core.picture import Camera, Light, Surface, render

    rows = []
    chosen = np.linspace(0, len(poses) - 1, POSES + 1)[:-1].round().astype(int)
    for degrees in (0.0, 90.0):
        a = np.radians(degrees)
        side, front = np.array([np.cos(a), 0.0, -np.sin(a)]), np.array([np.sin(a), 0.0, np.cos(a)])
        eye, key = 5.2 * front + [0.0, 1.0, 0.0], 0.56 * front - 0.55 * side + [0.0, 0.62, 0.0]
        camera = Camera((float(eye[0]), float(eye[1]), float(eye[2])), (0.0, 0.86, 0.0), 22.0)
        light = Light(key=(float(key[0]), float(key[1]), float(key[2])))
        row = []
        for k in chosen:
            pose = poses[k].shifted(x=-poses[k].shift[0], z=-poses[k].shift[2])
            surface = Surface(figure.posed(pose), figure.faces, (0.80, 0.78, 0.74), gloss=0.1)
            row.append(render([surface], camera, (WIDTH, HEIGHT), light=light))
        rows.append(np.concatenate(row, axis=1))
    return np.concatenate(rows)


def _listed(content: Path, as_json: bool) -> int:
    from sim_core.body.motion.file import load_motion
    from sim_core.body.motion.loop import Loop

    folder = content / "motions"
    if not folder.is_dir():
        raise FileProblem(f"{folder}: no such folder – give --content DIR, which holds motions/")
    found: dict[str, dict[str, Any]] = {}
    for path in sorted(folder.glob("*.toml")):
        motion = load_motion(path)
        loop = isinstance(motion, Loop)
        seconds = motion.seconds if isinstance(motion, Loop) else sum(key[0] for key in motion.keys)
        title = dict(motion.title) if isinstance(motion, Loop) else {}
        found[path.name] = {"seconds": round(seconds, 3), "loop": loop, "title": title}
    if as_json:
        sys.stdout.write(json.dumps(found, indent=2, ensure_ascii=False) + "\n")
        return 0
    for name, facts in found.items():
        words = "  ".join(facts["title"].values())
        sys.stdout.write(
            f"{name:22} {facts['seconds']:6.2f} s  {'repeats' if facts['loop'] else 'once':8} {words}\n"
        )
    return 0


def _told(facts: dict[str, Any], as_json: bool) -> str:
    if as_json:
        return json.dumps(facts, indent=2, ensure_ascii=False) + "\n"
    lines = []
    for key, value in facts.items():
        inner = (
            ", ".join(f"{name} {part}" for name, part in value.items()) if isinstance(value, dict) else value
        )
        lines.append(f"{key:16} {inner}")
    return "\n".join(lines) + "\n"
