"""Motions as arrays: npz with `joints (T, J, 3)`, `joint_names`, `time (T,)`; and what was tracked, written so."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim_core.errors import FileProblem, SimCoreError
from sim_core.track.files.mapping import JointMapping, mapping_for
from sim_core.track.recording import Recording
from sim_core.track.skeletons import KINECT
from sim_core.validation.files import read_npz, written_whole

if TYPE_CHECKING:
    from sim_core.track.tracker import Tracked

__all__ = ["read_arrays", "write_tracked"]

NAMES = ("joints", "joint_names", "time")
REMEDY = "give an npz of joints (T, J, 3) [m], joint_names (J,) and time (T,) [s]"


def read_arrays(path: Path, mapping: JointMapping | None = None, unit: float | None = None) -> Recording:
    """The recording of an npz file: joints of a Kinect by name in any order, or of any skeleton that a mapping knows.

    What is finite is known for true. Raises FileProblem naming array, what is wrong and the remedy.
    """
    found = read_npz(path, NAMES, "a motion file", REMEDY)
    names = [str(name) for name in np.atleast_1d(found["joint_names"])]
    for name in ("joints", "time"):
        if found[name].dtype.kind not in "iuf":
            raise FileProblem(f"{path}: {name}: {found[name].dtype}, no numbers – {REMEDY}")
    joints, time = found["joints"].astype(float), np.atleast_1d(found["time"]).astype(float)
    if (
        joints.ndim != 3
        or joints.shape[1:] != (len(names), 3)
        or time.shape != joints.shape[:1]
        or not len(time)
    ):
        shapes = f"joints {joints.shape}, joint_names ({len(names)},), time {time.shape}"
        raise FileProblem(f"{path}: {shapes} – {REMEDY}")
    joints[~np.isfinite(joints)] = np.nan
    try:
        if mapping is None and set(KINECT.joints) <= set(names):
            order = [names.index(name) for name in KINECT.joints]
            own = joints[:, order] * (1.0 if unit is None else unit)
            return Recording(KINECT, time, own, own.copy())
        chosen = mapping or mapping_for(names)
        return chosen.applied(names, joints, time, 1.0 if unit is None and chosen.unit is None else unit)
    except SimCoreError as error:
        raise FileProblem(f"{path}: {error}") from error


def write_tracked(path: Path, tracked: Tracked) -> None:
    """Writes time (T,), joints (T, J, 3), joint_names, points (T, P, 3), truth (T, P, 3; NaN where it is not known),
    lost (T, P), and for whoever goes on: rotations (T, B, 4), bone_names, trunk (T, 3, 3), m and delta (T, B)."""
    skeleton = tracked.calibration.skeleton
    truth = np.full(tracked.points.shape, np.nan) if tracked.truth is None else tracked.truth
    with written_whole(path) as stream:
        np.savez_compressed(
            stream,
            time=tracked.time,
            joints=tracked.joints,
            joint_names=np.array(skeleton.joints),
            points=tracked.points,
            truth=truth,
            lost=tracked.lost,
            rotations=tracked.rotations,
            bone_names=np.array(skeleton.bone_names),
            trunk=tracked.trunk,
            m=tracked.m,
            delta=tracked.delta,
        )
