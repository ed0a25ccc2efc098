"""`simcore track`: files in, points, figures and pictures out; errors in one line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from moving_people import person
from PIL import Image

from sim_core import cli
from sim_core.track import KINECT

KEYS = [
    "frames", "points", "seconds_per_frame", "rmse_mm", "max_mm", "delta_mm", "m", "iterations", "flips", "lost",
    "bone_error_m",
]  # fmt: skip


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    path = tmp_path / "walk.bvh"
    path.write_text(person("walk", 3.0).bvh(), "utf-8")
    return path


def told(words: list[str], capsys: pytest.CaptureFixture[str]) -> dict:
    assert cli.main(["track", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_it_tells_how_well_it_follows(walk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    facts = told([str(walk)], capsys)
    assert list(facts) == KEYS
    assert facts["frames"] == 90
    assert facts["points"] == 97
    assert facts["rmse_mm"] <= 3.0
    assert facts["bone_error_m"] <= 1e-9
    assert facts["lost"] == facts["flips"] == 0
    words = [str(walk), "--noise", "10", "--outliers", "0.01", "--dropout", "0.01", "--level", "3"]
    worse, again = told(words, capsys), told(words, capsys)
    assert worse["points"] == 193
    assert facts["rmse_mm"] < worse["rmse_mm"] <= 12.5
    assert worse["lost"] > 0
    assert worse["iterations"] <= 5.0
    assert {**again, "seconds_per_frame": 0.0} == {**worse, "seconds_per_frame": 0.0}
    assert told([*words, "--seed", "1"], capsys)["rmse_mm"] != worse["rmse_mm"]
    lazy = told([str(walk), "--noise", "10", "--m0", "1000000", "--filter", "one-euro"], capsys)
    assert lazy["iterations"] == 0.0
    assert cli.main(["track", str(walk), "--noise", "10"]) == 0
    assert "filter kalman" in capsys.readouterr().out


def test_it_writes_what_it_tracked_and_reads_it_again(
    walk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, plot = tmp_path / "out.npz", tmp_path / "plots" / "walk.png"
    facts = told(
        [str(walk), "--noise", "5", "--dropout", ".02", "--out", str(out), "--plot", str(plot)], capsys
    )
    with np.load(out) as found:
        assert found["time"].shape == (90,)
        assert found["joints"].shape == (90, 25, 3)
        assert tuple(found["joint_names"]) == KINECT.joints
        assert found["points"].shape == found["truth"].shape == (90, 97, 3)
        assert found["lost"].shape == (90, 97)
        assert found["lost"].dtype == bool
        assert found["rotations"].shape == (90, 24, 4)
        error = np.linalg.norm(found["points"] - found["truth"], axis=2)
        assert np.sqrt((error**2).mean()) * 1e3 == pytest.approx(facts["rmse_mm"])
        assert found["lost"].sum() == facts["lost"]
    assert np.asarray(Image.open(plot)).std() > 1
    again = told([str(out)], capsys)
    assert again["rmse_mm"] <= 1.0
    assert again["frames"] == 90


def test_a_stream_has_no_truth(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    joints = person("walk", 1.0).places()[:, :25]
    rows = ["time,joint,x,y,z,state"]
    for frame, places in enumerate(joints):
        rows += [f"{frame / 30:.4f},{KINECT.joints[j]},{x},{y},{z},2" for j, (x, y, z) in enumerate(places)]
    path, out = tmp_path / "stream.csv", tmp_path / "out.npz"
    path.write_text("\n".join(rows) + "\n", "utf-8")
    facts = told([str(path), "--out", str(out)], capsys)
    assert facts["rmse_mm"] is None
    assert facts["max_mm"] is None
    with np.load(out) as found:
        assert np.isnan(found["truth"]).all()
        assert np.isfinite(found["points"]).all()


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["none.bvh"], 1, "none.bvh"),
        (["clip.fbx"], 2, "end the name with .bvh"),
        (["WALK", "--filter", "mean"], 2, "invalid choice"),
        (["WALK", "--noise", "-1"], 2, "--noise"),
        (["WALK", "--outliers", "2"], 2, "--outliers"),
        (["WALK", "--level", "9"], 2, "--level"),
        (["WALK", "--mapping", "nobody"], 1, "no mapping"),
        (["WALK", "--out", "x.csv"], 2, ".npz"),
        (["WALK", "--plot", "x.gif"], 2, ".png"),
        (["BAD"], 1, "line 1, column 1"),
        (["WALK", "--dropout", "1"], 1, "walk.bvh: joints: no frame shows a joint of the trunk"),
        (["LONG", "--level", "6"], 1, "long.npz: level: 6, 40000 frames of 1537 points – take a lower level"),
    ],
)
def test_what_cannot_be_done_is_told_in_one_line(
    walk: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    status: int,
    message: str,
) -> None:
    bad = tmp_path / "bad.bvh"
    bad.write_text("nothing of the kind", "utf-8")
    long, frames = tmp_path / "long.npz", 40_000
    if "LONG" in words:
        joints = np.broadcast_to(person("walk", 0.1).places()[0, :25], (frames, 25, 3)).astype(np.float32)
        np.savez(long, joints=joints, joint_names=np.array(KINECT.joints), time=np.arange(frames) / 30.0)
    given = {"WALK": str(walk), "BAD": str(bad), "LONG": str(long)}
    words = [given.get(word, word) for word in words]
    try:
        found = cli.main(["track", *words])
    except SystemExit as ended:
        found = int(str(ended.code))
    assert found == status
    assert message in capsys.readouterr().err.splitlines()[-1]
