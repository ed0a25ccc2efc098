"""An exhibit that moves by a clip: its address, and what is wrong with a clip."""

from pathlib import Path

import numpy as np
import pytest
from moving_hall import box_clip, write_moving_hall

from hall_app.check import check
from hall_app.content import load, scene_json
from sim_core.garment.clip import Clip, Drawn, Moved


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_moving_hall(tmp_path / "content")


def motion_problems(folder: Path) -> list[str]:
    return [str(problem) for problem in check(folder) if problem.key == "motion"]


def test_a_good_clip_is_served_and_no_problem(folder: Path):
    (entry,) = scene_json(load(folder))["exhibits"]
    assert entry["motion"].startswith("/media/box/sway.clip?v=")
    assert motion_problems(folder) == []
    assert not any("sway" in str(problem) for problem in check(folder))


def test_an_exhibit_without_motion_has_none(folder: Path):
    toml = folder / "exhibits" / "box" / "exhibit.toml"
    toml.write_text(toml.read_text("utf-8").replace('motion = "sway.clip"\n', ""), "utf-8")
    (entry,) = scene_json(load(folder))["exhibits"]
    assert entry["motion"] is None


def test_a_clip_that_is_missing_or_damaged_or_of_another_model_is_named(folder: Path):
    home = folder / "exhibits" / "box"
    clip, model = home / "sway.clip", (home / "box.glb").read_bytes()
    data = clip.read_bytes()
    clip.write_bytes(data[:-5])
    assert "copy it again" in " ".join(motion_problems(folder))
    index = np.arange(8, dtype=np.int32)
    box_clip(model, drawn=(Drawn("other", index),)).save(clip)
    assert "the model has no such mesh" in " ".join(motion_problems(folder))
    box_clip(model, drawn=()).save(clip)
    assert "moves no mesh" in " ".join(motion_problems(folder))
    clip.write_bytes(data + b"\0" * 2_100_000)
    assert motion_problems(folder)
    still = np.random.default_rng(0).uniform(0, 1, (1, 20_000, 3)).repeat(500, axis=0)
    Clip.of([Moved("box", still, np.array([[0, 1, 2]]))], rate=25.0).save(
        clip
    )  # packs well, and takes much memory
    assert "takes 60 MB in the page, at most 50 MB" in " ".join(motion_problems(folder))
    clip.unlink()
    assert "missing file sway.clip" in " ".join(motion_problems(folder))
