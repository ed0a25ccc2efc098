"""Pictures that hang in the hall: mounted on the sheet of letters, part of the room's key, checked like other files."""

from pathlib import Path

import numpy as np
import pytest
from content_house import edit, make_house
from PIL import Image

from hall_app.check import check
from hall_app.content import ContentError, load
from hall_app.room import raise_room
from hall_app.room.bake import room_key
from hall_app.room.surface import Sheet, Writing, write

SIGN = """
[[sign]]
kind = "picture"
at = [-2, -2.9]
height = 2.4
size = [0.8, 1.6]
picture = "media/hung.png"
"""


@pytest.fixture
def house(tmp_path: Path) -> Path:
    folder = make_house(tmp_path / "house")
    (folder / "media").mkdir(exist_ok=True)
    Image.new("RGB", (60, 120), (200, 30, 20)).save(folder / "media/hung.png")
    with (folder / "plan.toml").open("a", encoding="utf-8") as plan:
        plan.write(SIGN)
    return folder


def _mounted(folder: Path) -> np.ndarray:
    """The part of the sheet that hangs."""
    content = load(folder)
    sheet = raise_room(content.plan, content.hall.title, (), folder=folder, blank=True).sheet
    x0, y0, x1, y1 = _pixels(sheet)[0]
    return sheet.picture[y0:y1, x0:x1]


def _pixels(sheet: Sheet) -> np.ndarray:
    """Left, top, right and bottom (N, 4) of what lies on a sheet [px]."""
    high, wide = sheet.picture.shape[:2]
    return np.rint(np.array(sheet.places) * [wide, high, wide, high]).astype(int)


def test_a_picture_is_mounted_on_its_scroll(house):
    assert check(house) == []
    hung = _mounted(house).astype(int)
    high, wide = hung.shape[:2]
    assert hung[high // 2, wide // 2].tolist() == [200, 30, 20]
    assert np.ptp(hung[: high // 12].reshape(-1, 3), axis=0).max() == 0  # silk
    assert hung[3, 3].tolist() == hung[high - 3, wide - 3].tolist() != [200, 30, 20]


@pytest.mark.parametrize("labels", [1, 30, 90])
def test_what_is_written_lies_on_one_sheet_each_apart(labels):
    writings = [Writing("label", "衣", "dress", (520, 170))] * labels + [
        Writing("plaque", "裳", "skirt", (2600, 300))
    ]
    sheet = write(writings, blank=True)
    assert max(sheet.picture.shape) <= 2048
    if labels == 1:  # what is too wide takes nothing from the others
        assert np.diff(_pixels(sheet)[0, [0, 2]]) == 520
    taken = np.zeros(sheet.picture.shape[:2], int)
    for x0, y0, x1, y1 in _pixels(sheet):
        taken[y0:y1, x0:x1] += 1
    assert taken.max() == 1


def test_another_picture_is_another_room(house):
    first = room_key(load(house))
    Image.new("RGB", (60, 120), (20, 30, 200)).save(house / "media/hung.png")
    assert room_key(load(house)) != first


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (
            'picture = "media/hung.png"',
            'picture = "media/hung.svg"',
            "a picture that hangs in the hall is of pixels",
        ),
        ('picture = "media/hung.png"', "", "has a picture and no text"),
        ('kind = "picture"', 'kind = "banner"', "has a picture and no text"),
        (
            'picture = "media/hung.png"',
            'picture = "media/hung.png"\ntext = "衣"',
            "has a picture and no text",
        ),
        ('picture = "media/hung.png"', 'picture = "../hung.png"', "leaves the content folder"),
        ('picture = "media/hung.png"', 'picture = "media/other.png"', "missing file media/other.png"),
    ],
    ids=["drawing", "without", "banner", "text", "outside", "missing"],
)
def test_what_cannot_hang_is_one_line(house, old, new, says):
    edit(house / "plan.toml", old, new)
    with pytest.raises(ContentError) as told:
        load(house)
    assert says in str(told.value)


def test_a_file_that_is_no_picture_is_told_and_hangs_as_empty_paper(house):
    (house / "media/hung.png").write_bytes(b"no picture at all")
    (problem,) = check(house)
    assert (problem.file, problem.key) == ("plan.toml", "sign[1].picture")
    hung = _mounted(house)
    assert hung[hung.shape[0] // 2, hung.shape[1] // 2].min() > 180
