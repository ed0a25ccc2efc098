"""Tracking: time and error together. The truth is the motion itself before it was worsened as a sensor would.

    python tests/bench/bench_track.py [--quick] [--json FILE] [--plot FILE.png] [--peers [FOLDER]] [--motion FILE ...]

Clips: the real walk in ../shared/data/motion where it is there (120 Hz, and every fourth frame), a walk and a dance
made here, and whatever --motion names. Levels 0 to 4, filters, M0, both engines; beside them the trunk's rigid motion
alone and that of all points. Alignment of 25 points stands beside scipy's `align_vectors` and, with --peers, RoMa's
registration (an environment of its own), in turns. Seconds are the median of rounds that take turns, CPU seconds of the
process, so that whoever else computes counts little; wall seconds stand beside them.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
from peers import Peers, add_peers, peer_python
from scipy.spatial.transform import Rotation

from sim_core.track import (
    FILTERS,
    KINECT,
    Calibration,
    Disturbance,
    Recording,
    Tracker,
    TrackSettings,
    align,
    calibrate,
    feature_points,
    read_recording,
    track,
)

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from moving_people import person  # noqa: E402

WALK = ROOT.parent / "shared" / "data" / "motion" / "cmu_12_01_walk.bvh"
NOISE = 0.01  # [m] an axis
LEVELS, THRESHOLDS = (0, 1, 2, 3, 4), (0.01, 0.1, 0.5, 2.0, 1e9)
LIMITS = {"clean": 3.0, "noise": 12.0, "outliers": 12.5}  # [mm]
TICKS = (20, 50, 100, 200, 500)  # [us]
COMPILED, PLAIN = 0.25e-3, 1e-3  # [s] a frame of 97 points


def clips(more: list[Path], quick: bool) -> dict[str, Recording]:
    found = {}
    if WALK.is_file():
        whole = read_recording(WALK)
        assert whole.truth is not None
        found["real walk, 120 Hz"] = whole
        found["real walk, 30 Hz"] = Recording(KINECT, whole.time[::4], whole.joints[::4], whole.truth[::4])
    else:
        print(f"{WALK}: not here, left out", file=sys.stderr)
    with tempfile.TemporaryDirectory() as folder:
        for kind in ("walk", "dance"):
            path = Path(folder) / f"{kind}.bvh"
            path.write_text(person(kind, 5.0).bvh(), "utf-8")
            found[f"made here: {kind}"] = read_recording(path)
    for path in more:
        found[path.stem] = read_recording(path)
    return dict(list(found.items())[:2]) if quick else found


def timed(settings: TrackSettings, clip: Recording, calibration: Calibration) -> tuple[float, float]:
    """CPU and wall seconds a frame of `update` alone."""
    tracker = Tracker(calibration, settings)
    tracker.update(clip.joints[0], float(clip.time[0]))
    begin, wall = process_time(), perf_counter()
    for joints, time in zip(clip.joints[1:], clip.time[1:], strict=True):
        tracker.update(joints, float(time))
    count = max(1, len(clip.time) - 1)
    return (process_time() - begin) / count, (perf_counter() - wall) / count


def tracking(name: str, clip: Recording, cases: dict[str, TrackSettings], rounds: int) -> list[dict]:
    """One row a setting, with 10 mm noise; the settings take turns."""
    worse = clip.disturbed(Disturbance(NOISE, seed=1))
    calibration = calibrate(KINECT, worse.joints, worse.step)
    times: dict[str, list[tuple[float, float]]] = {case: [] for case in cases}
    for _ in range(rounds):
        for case, settings in cases.items():
            times[case].append(timed(settings, worse, calibration))
    rows = []
    for case, settings in cases.items():
        tracked = track(worse, settings, calibration)
        errors = tracked.errors() * 1e3
        rows.append(
            {
                "clip": name,
                "case": case,
                "filter": settings.filter,
                "level": settings.level,
                "m0": settings.m0,
                "compiled": settings.compiled,
                "points": errors.shape[1],
                "seconds": statistics.median(cpu for cpu, _ in times[case]),
                "wall_seconds": statistics.median(wall for _, wall in times[case]),
                "rmse_mm": float(np.sqrt((errors**2).mean())),
                "max_mm": float(errors.max()),
                "iterations": float(tracked.iterations.mean()),
                "acceleration": acceleration(tracked.points, clip.step),
                "bone_error_m": tracked.bone_error(),
            }
        )
        tell(rows[-1])
    return rows


def acceleration(points: np.ndarray, step: float) -> float:
    """RMS [m/s2] an axis: what trembling looks like."""
    return float(np.sqrt((np.diff(points, 2, axis=0) ** 2).mean()) / step**2)


def tell(row: dict) -> None:
    times = "".join(f"{row[key] * 1e6:>8.0f}" for key in ("seconds", "wall_seconds"))
    print(
        f"{row['clip']:<20}{row['case']:<24}{row['points']:>5}{times}{row['rmse_mm']:>8.2f}{row['max_mm']:>8.1f}"
        f"{row['iterations']:>6.2f}{row['acceleration']:>7.1f}",
        flush=True,
    )


def settings_of(quick: bool) -> dict[str, TrackSettings]:
    cases = {f"{name}, level {level}": TrackSettings(name, level) for name in FILTERS for level in LEVELS}
    cases |= {f"{name}, M0 {m0:g}": TrackSettings(name, m0=m0) for name in FILTERS for m0 in THRESHOLDS}
    cases |= {f"{name}, numpy": TrackSettings(name, compiled=False) for name in FILTERS}
    return {case: s for case, s in cases.items() if s.filter == "kalman"} if quick else cases


def rigid(name: str, clip: Recording) -> dict:
    """What no limb step leaves, on the clean clip: all points carried by one motion of the trunk, and of all points."""
    points = feature_points(KINECT)
    there = points.of(clip.joints)
    row = {"clip": name}
    for kind, chosen in (("torso", points.torso), ("all", np.ones(len(points.torso), bool))):
        moved = [align(frame[chosen], there[0][chosen]).of(there[0]) for frame in there]
        row[f"rigid_{kind}_mm"] = float(np.sqrt(((np.array(moved) - there) ** 2).sum(2).mean()) * 1e3)
    return row


def accuracy(name: str, clip: Recording, seeds: int) -> dict:
    """The figures to reach: clean, noise, outliers, dropout, an arm away for half a second."""
    row = rigid(name, clip)
    clean = track(clip, TrackSettings("none"))
    row |= {"clean_mm": rms(clean.errors()), "clean_max_mm": float(clean.errors().max() * 1e3)}
    row["clean_kalman_mm"] = rms(track(clip).errors())
    for kind, more in (("noise", {}), ("outliers", {"outliers": 0.01}), ("dropout", {"dropout": 0.02})):
        found = [
            rms(track(clip.disturbed(Disturbance(NOISE, seed=seed, **more))).errors())
            for seed in range(seeds)
        ]
        row[f"{kind}_mm"], row[f"{kind}_worst_mm"] = statistics.mean(found), max(found)
    arm = [KINECT.joints.index(f"{part}Left") for part in ("Elbow", "Wrist", "Hand", "HandTip", "Thumb")]
    found = []
    for share in (0.2, 0.4, 0.6, 0.8):
        joints, first = clip.disturbed(Disturbance(NOISE, seed=3)).joints, int(share * len(clip.time))
        joints[first : first + round(0.5 / clip.step), arm] = np.nan
        found.append(rms(track(Recording(KINECT, clip.time, joints, clip.truth)).errors()))
    row["arm_mm"], row["arm_worst_mm"] = statistics.mean(found), max(found)
    print(
        f"{name:<20}{row['rigid_torso_mm']:>8.0f}{row['rigid_all_mm']:>6.0f}{row['clean_mm']:>8.2f}{row['clean_max_mm']:>6.1f}"
        f"{row['clean_kalman_mm']:>9.2f}{row['noise_worst_mm']:>8.2f}{row['outliers_worst_mm']:>10.2f}"
        f"{row['dropout_worst_mm']:>9.2f}{row['arm_worst_mm']:>8.1f}",
        flush=True,
    )
    return row


def rms(errors: np.ndarray) -> float:
    return float(np.sqrt((errors**2).mean()) * 1e3)


def alignment(peers: Peers | None, rounds: int) -> list[dict]:
    """25 points: ours as numpy and compiled, scipy's, RoMa's, in turns; errors of the rotation against the true one."""
    from sim_core.track.engine import compiled_kabsch

    compiled = compiled_kabsch()

    random = np.random.default_rng(0)
    source = random.normal(size=(25, 3)) * 0.4
    turn = Rotation.random(random_state=1).as_matrix()
    target = source @ turn.T + [0.1, 1.0, -2.0]
    centred = source - source.mean(0)
    covariance = centred.T @ (target - target.mean(0))

    def scipy() -> np.ndarray:
        return Rotation.align_vectors(target - target.mean(0), centred)[0].as_matrix()

    runs: dict[str, Callable[[], np.ndarray]] = {
        "ours, numpy": lambda: align(target, source).rotation,
        "ours, compiled SVD": lambda: compiled(covariance.copy()),
        "scipy align_vectors": scipy,
    }
    times: dict[str, list[float]] = {name: [] for name in (*runs, "RoMa")}
    errors = {}
    for _ in range(rounds):
        for name, run in runs.items():
            errors[name] = float(np.abs(run() - turn).max())
            begin = process_time()
            for _ in range(200):
                run()
            times[name].append((process_time() - begin) / 200)
        if peers is not None:
            made = peers.run("roma", source=source, target=target)
            errors["RoMa"] = float(np.abs(made["rotation"] - turn).max())
            times["RoMa"].append(made["seconds"])
    rows = []
    print(f"\n{'alignment of 25 points':<24}{'us':>9}{'x ours':>9}{'error':>10}")
    for name, error in errors.items():
        seconds = statistics.median(times[name])
        ratio = statistics.median(t / own for t, own in zip(times[name], times["ours, numpy"], strict=True))
        rows.append({"engine": name, "seconds": seconds, "ratio": ratio, "error": error})
        print(f"{name:<24}{seconds * 1e6:>9.1f}{ratio:>9.2f}{error:>10.1e}", flush=True)
    return rows


def plot(figures: dict, path: Path) -> None:
    """Time a frame against error: a panel a clip; levels by lines, thresholds dotted, the numpy engine square."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    names = list(dict.fromkeys(row["clip"] for row in figures["tracking"]))
    figure = Figure(figsize=(4.6 * len(names), 4.4), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    colours = {"none": "#6b6b6b", "kalman": "#1f5f99", "one-euro": "#c4782a"}
    for axes, name in zip(np.atleast_1d(figure.subplots(1, len(names), sharey=True)), names, strict=True):
        for kind, colour in colours.items():
            rows = [row for row in figures["tracking"] if row["clip"] == name and row["filter"] == kind]
            for style, marker, chosen in (
                ("-", "o", [row for row in rows if "level" in row["case"]]),
                (":", "x", [row for row in rows if "M0" in row["case"]]),
                ("", "s", [row for row in rows if "numpy" in row["case"]]),
            ):
                if not chosen:
                    continue
                there = [[1e6 * row["seconds"] for row in chosen], [row["rmse_mm"] for row in chosen]]
                label = kind if style == "-" else None
                axes.plot(*there, marker=marker, linestyle=style, color=colour, label=label, fillstyle="none")
        axes.set_title(name, fontsize="medium")
        axes.set_xscale("log")
        axes.minorticks_off()
        axes.set_xticks(TICKS, [f"{tick}" for tick in TICKS])
        axes.set_xlabel("CPU time a frame [us]")
    axes.legend(title="o levels 0-4, x M0,\n□ numpy", frameon=False, fontsize="small")
    figure.supylabel("error, RMS [mm], 10 mm noise an axis", fontsize="medium")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="two clips, one filter, fewer rounds")
    parser.add_argument(
        "--motion", nargs="+", type=Path, default=[], metavar="FILE", help="these motions, too"
    )
    parser.add_argument("--json", type=Path, help="write the figures as JSON")
    parser.add_argument(
        "--plot", type=Path, default=ROOT / "build" / "bench_track.png", help="build/bench_track.png"
    )
    add_peers(parser, "with RoMa (torch)")
    args = parser.parse_args()
    rounds, seeds = (3, 2) if args.quick else (5, 6)
    peers = (
        Peers(peer_python(args.peers, "track"), Path(__file__).with_name("track_peers.py"))
        if args.peers
        else None
    )
    chosen = clips(args.motion, args.quick)
    figures: dict[str, list[dict]] = {"accuracy": [], "tracking": []}
    print(
        "mm RMS; worst seed       rigid torso, all   clean   max   kalman   noise  outliers  dropout     arm"
    )
    for name, clip in chosen.items():
        figures["accuracy"].append(accuracy(name, clip, seeds))
    print(
        f"\n{'10 mm noise':<20}{'':<24}{'P':>5}{'us CPU':>8}{'wall':>8}{'mm':>8}{'max':>8}{'it.':>6}{'m/s2':>7}"
    )
    for name, clip in chosen.items():
        figures["tracking"] += tracking(name, clip, settings_of(args.quick), rounds)
    figures["alignment"] = alignment(peers, 2 * rounds)
    if peers is not None:
        peers.close()
    plot(figures, args.plot)
    print(f"drawn: {args.plot}")
    if args.json:
        args.json.parent.mkdir(parents=True, exist_ok=True)
        args.json.write_text(json.dumps(figures, indent=1) + "\n", "utf-8")
    return 0 if reached(figures) else 1


def reached(figures: dict) -> bool:
    """Errors within their limits on the clips of this bench; times are told, and judged by who reads them."""
    wrong = [
        f"{row['clip']}: {kind} {row[key]:.2f} mm, at most {LIMITS[kind]}"
        for row in figures["accuracy"]
        for kind, key in (
            ("clean", "clean_mm"),
            ("noise", "noise_worst_mm"),
            ("outliers", "outliers_worst_mm"),
        )
        if row[key] > LIMITS[kind]
    ]
    wrong += [f"{row['case']}: bones" for row in figures["tracking"] if row["bone_error_m"] > 1e-9]
    for row in figures["tracking"]:
        budget = COMPILED if row["compiled"] else PLAIN
        if row["level"] == 2 and row["seconds"] > budget:
            print(
                f"slow: {row['clip']}, {row['case']}: {row['seconds'] * 1e6:.0f} us, {budget * 1e6:.0f} meant"
            )
    for line in wrong:
        print(f"missed: {line}")
    return not wrong


if __name__ == "__main__":
    sys.exit(main())
