"""`simcore track`: a motion file becomes points that follow the person in it, and how well they do."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING, Any

from sim_core.validation.arguments import ending, number, whole

if TYPE_CHECKING:
    from sim_core.track.recording import Recording
    from sim_core.track.settings import TrackSettings
    from sim_core.track.tracker import Tracked

DESCRIPTION = """\
Follow a person: feature points on the body, placed by rigid alignment of the trunk and refined limb by limb under the
lengths of their bones (Eq. 10-17 of the paper).

MOTION is a BVH file of any hierarchy, an npz of joints (T, J, 3) [m], joint_names (J,) and time (T,) [s], or a sensor's
stream: CSV with the columns time, joint, x, y, z, state, or a JSON array of such rows. Joints of a Kinect v2 are
followed; which of a file's are which says a mapping (cmu, mixamo, figure, default, found by the names, or a file), and
what it does not find is named. Lengths of a BVH file are in the mapping's unit, else in the one that makes the person
as tall as people are.

--noise, --dropout and --outliers worsen the joints first, as a sensor would; errors are told against the joints before
that. Bones and trunk are measured on the recording itself, as it is then. Without --filter, kalman is taken for streams
and worsened motions, none for others.

The summary:
  seconds_per_frame    of the tracker alone; machine code is made once, cached, and not counted
  rmse_mm, max_mm      of all points of all frames against the truth, lost ones too (null where it is not known)
  delta_mm, m          means of Eq. 16 and 17: tracked against seen length of a bone, and that against its way
  iterations           of the local step, mean of a frame (at most 5)
  flips                rotations that turned by more than 90 degrees in a frame
  lost                 points that were not seen or not believed, summed over the frames
  bone_error_m         the greatest difference of a tracked bone from its length
The npz of --out holds time (T,), joints (T, J, 3) [m, y up], joint_names, points (T, P, 3), truth, lost (T, P), and
rotations (T, B, 4; from rest, real part first), bone_names, trunk (T, 3, 3), m and delta (T, B).

examples:
  simcore track walk.bvh --out walk.npz --plot walk.png
  simcore track walk.bvh --noise 10 --outliers 0.01 --json
  simcore track stream.csv --filter one-euro --level 3 --out points.npz
"""
FILTERS = ("none", "kalman", "one-euro")


def add_parser(subparsers: Any) -> None:
    """Adds `track` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "track",
        help="body motion -> points that follow it",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "motion",
        type=ending(".bvh", ".npz", ".csv", ".json"),
        metavar="MOTION",
        help=".bvh, .npz, .csv, .json",
    )
    parser.add_argument(
        "--noise",
        type=number(0, 1000, " mm"),
        default=0.0,
        metavar="MM",
        help="noise of every joint, an axis [mm]",
    )
    parser.add_argument(
        "--dropout", type=number(0, 1), default=0.0, metavar="P", help="the share of joints that are not seen"
    )
    parser.add_argument(
        "--outliers",
        type=number(0, 1),
        default=0.0,
        metavar="P",
        help="the share of joints measured 30 cm away",
    )
    parser.add_argument("--seed", type=whole(0, 2**32), default=0, metavar="N", help="of these three (0)")
    parser.add_argument("--filter", choices=FILTERS, help="kalman: for sensors; one-euro: for a viewer; none")
    parser.add_argument(
        "--m0", type=number(0, 1e9), default=0.1, metavar="X", help="refine limbs while M exceeds this (0.1)"
    )
    parser.add_argument(
        "--level", type=whole(0, 6), default=2, metavar="N", help="halvings of a bone: 2 gives 97 points (2)"
    )
    parser.add_argument("--mapping", metavar="NAME", help="cmu, mixamo, figure, default, or a file (.toml)")
    parser.add_argument(
        "--unit",
        type=number(1e-9, 1e6, " m"),
        metavar="M",
        help="metres that a unit of the file's lengths is (a stream: 1)",
    )
    parser.add_argument("--out", type=ending(".npz"), metavar="FILE.npz", help="write what was tracked")
    parser.add_argument(
        "--plot", type=ending(".png"), metavar="FILE.png", help="draw errors, M and lost points over time"
    )
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Read, worsen, follow, write; returns the exit status."""
    from sim_core.errors import FileProblem, SimCoreError
    from sim_core.track import Disturbance, TrackSettings, read_recording, save_chart, summary, write_tracked
    from sim_core.validation.files import check_target

    for target in (args.out, args.plot):
        if target is not None:
            check_target(target)
    recording = read_recording(args.motion, args.mapping, args.unit)
    for words in recording.told:
        sys.stderr.write(f"simcore track: {args.motion}: {words}\n")
    disturbance = Disturbance(args.noise / 1e3, args.dropout, args.outliers, seed=args.seed)
    worse = args.noise > 0.0 or args.dropout > 0.0 or args.outliers > 0.0
    if worse:
        recording = recording.disturbed(disturbance)
    chosen = args.filter or ("kalman" if worse or recording.truth is None else "none")
    try:
        tracked, seconds = _followed(recording, TrackSettings(filter=chosen, level=args.level, m0=args.m0))
    except SimCoreError as error:
        raise FileProblem(f"{args.motion}: {error}") from error
    facts = summary(tracked, seconds)
    if args.out is not None:
        write_tracked(args.out, tracked)
    if args.plot is not None:
        save_chart(args.plot, tracked)
    told = json.dumps(facts, indent=2) if args.json else _text(args, chosen, tracked, facts)
    sys.stdout.write(told + "\n")
    return 0


def _followed(recording: Recording, settings: TrackSettings) -> tuple[Tracked, float]:
    """What was tracked, and the seconds of the frames alone."""
    from time import perf_counter

    from sim_core.metrics import compile_clock
    from sim_core.track import Tracker, calibrate, track

    calibration = calibrate(recording.skeleton, recording.joints, recording.step)
    with compile_clock(_tell_compiling):
        Tracker(calibration, settings).update(recording.joints[0], float(recording.time[0]))
    begin = perf_counter()
    tracked = track(recording, settings, calibration)
    return tracked, perf_counter() - begin


def _tell_compiling() -> None:
    sys.stderr.write("simcore track: making machine code, once; the next run has it ready\n")


def _text(args: argparse.Namespace, chosen: str, tracked: Tracked, facts: dict[str, Any]) -> str:
    """The summary for people."""
    error = "truth not known"
    if facts["rmse_mm"] is not None:
        error = f"error {facts['rmse_mm']:.2f} mm RMS, {facts['max_mm']:.1f} mm at most"
    events = {
        "joints taken up anew": int(tracked.reacquired.sum()),
        "frames with left and right exchanged": int(tracked.swapped.sum()),
        "frames no later than the last": int(tracked.clock.sum()),
    }
    noise = tracked.calibration.noise
    lines = [
        f"{args.motion}: {facts['frames']} frames, {facts['points']} points, filter {chosen}, "
        f"{facts['seconds_per_frame'] * 1e6:.0f} us a frame",
        f"  {error}; bones to {facts['bone_error_m']:.1e} m",
        f"  delta {facts['delta_mm']:.2f} mm, M {facts['m']:.3f}, {facts['iterations']:.2f} iterations a frame, "
        f"{facts['flips']} flips, {facts['lost']} points lost"
        + ("" if noise is None else f"; noise found {noise * 1e3:.1f} mm"),
        *(f"  {count} {words}" for words, count in events.items() if count),
    ]
    return "\n".join(lines)
