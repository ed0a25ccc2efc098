"""An exhibit that moves by a clip, and one that compares: addresses, and what is wrong with models and clips."""

from pathlib import Path

import numpy as np
import pytest
from moving_hall import box_clip, write_comparing_hall, write_moving_hall

from hall_app.check import check
from hall_app.content import exhibit_json, load, scene_json
from hall_app.show import drawn_exhibits
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


def comparison_problems(folder: Path) -> str:
    return " | ".join(str(problem) for problem in check(folder) if "comparison" in problem.key)


def test_a_comparison_is_told_to_the_page_and_no_problem(tmp_path: Path):
    folder = write_comparing_hall(tmp_path / "content")
    detail = exhibit_json(load(folder), "box")
    assert detail is not None
    told = detail["comparison"]
    assert told["clip"].startswith("/media/box/three.clip?v=")
    assert [side["colour"] for side in told["sides"]] == ["#b07030", "#30a060", "#3060b0"]
    assert told["sides"][2]["hausdorff_mm"] is None
    assert comparison_problems(folder) == ""
    assert not any("three." in str(problem) for problem in check(folder))


def test_a_comparison_whose_files_are_wrong_is_named_and_the_exhibit_stays(tmp_path: Path):
    folder = write_comparing_hall(tmp_path / "content")
    home = folder / "exhibits" / "box"
    model, toml = (home / "three.glb").read_bytes(), (home / "exhibit.toml").read_text("utf-8")
    (home / "three.glb").write_bytes((home / "box.glb").read_bytes())
    assert "comparison.clip" in comparison_problems(folder)
    assert "the model has no such mesh" in comparison_problems(folder)
    (home / "three.glb").write_bytes(model[:300])
    assert "three.glb cannot be drawn" in comparison_problems(folder)
    drawn = drawn_exhibits(load(folder), tmp_path / "data")
    assert [figure.id for figure in drawn.figures] == ["box"]
    assert drawn.figures[0].compared is None
    assert [problem.key for problem in drawn.unreadable] == ["comparison.model"]
    (home / "three.glb").unlink()
    assert "missing file three.glb" in comparison_problems(folder)
    for wrong, words in (
        (toml.split("[[comparison.side]]")[0], "comparison.side"),
        (toml.replace("#b07030", "red"), "comparison.side"),
        (toml.replace("vertices = 8\n", "vertices = 0\n"), "vertices"),
        (toml.replace("milliseconds = 3\n", ""), "milliseconds"),
        (toml.replace("hausdorff_mm = 4\n", ""), "only the reference itself has none"),
    ):
        (home / "exhibit.toml").write_text(wrong, "utf-8")
        assert words in comparison_problems(folder)
