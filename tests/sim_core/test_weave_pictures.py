"""Pictures of shipped weaves show the files of today."""

import shutil
import sys
from pathlib import Path

import pytest
from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
from weave_pictures import mark_of, marked

ASSETS = Path(__file__).parents[2] / "assets"
FILES = sorted((ASSETS / "weaves").glob("*.toml"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_shipped_picture_was_drawn_from_the_file_of_today(file):
    with Image.open(file.with_suffix(".jpg")) as picture:
        assert picture.info.get("comment", b"").decode() == mark_of(file), (
            f"python tests/bench/weave_pictures.py {file.stem}"
        )


def test_a_mark_is_of_weave_motif_and_drawing_and_leaves_the_pixels(tmp_path):
    assets = tmp_path / "assets"
    shutil.copytree(ASSETS / "motifs", assets / "motifs")
    (assets / "weaves").mkdir()
    file = assets / "weaves" / "crane-duan.toml"
    picture = file.with_suffix(".jpg")
    shutil.copy(ASSETS / "weaves" / "crane-duan.toml", file)
    marks = {mark_of(file)}
    for path in (file, assets / "motifs" / "cranes.toml", assets / "motifs" / "cranes.svg"):
        path.write_text(path.read_text("utf-8") + "\n", "utf-8")
        marks.add(mark_of(file))
    assert len(marks) == 4
    Image.effect_noise((32, 32), 60).save(picture)
    with Image.open(picture) as before:
        pixels = before.tobytes()
    marked(picture, "drawn from x")
    with Image.open(picture) as after:
        assert after.tobytes() == pixels
        assert after.info["comment"] == b"drawn from x"
