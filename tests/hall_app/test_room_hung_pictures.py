"""Pictures that hang in the hall: mounted on the sheet of letters, part of the room's key, checked like other files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from content_house import edit, make_house
from PIL import Image

from hall_app.check import check, hints
from hall_app.content import ContentError, load
from hall_app.room import raise_room
from hall_app.room.bake import room_key
from hall_app.room.picture import room_glb
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
        ('picture = "media/hung.png"', "", "a sign of kind picture has a picture"),
        ('kind = "picture"', 'kind = "banner"', "any other has none"),
        (
            'picture = "media/hung.png"',
            'picture = "media/hung.png"\ntext = "衣"',
            "a picture that hangs in the hall has no text – remove text",
        ),
        ('picture = "media/hung.png"', 'picture = "../hung.png"', "leaves the content folder"),
        ("size = [0.8, 1.6]", "size = [0.001, 2.0]", "greater than or equal to 0.1"),
        ("size = [0.8, 1.6]", "size = [0.8]", "add the missing entries"),
    ],
    ids=["drawing", "without", "banner", "text", "outside", "thin", "one side"],
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


def test_a_lost_picture_keeps_nobody_out(house):
    (house / "media/hung.png").unlink()
    (problem,) = load(house).problems
    assert (problem.key, problem.what) == ("sign[1].picture", "missing file media/hung.png")
    assert _mounted(house).min(axis=(0, 1)).tolist() == SILK  # and nothing else but paper


def test_no_file_outside_the_folder_is_hung(house, tmp_path):
    Image.new("RGB", (60, 120), (200, 30, 20)).save(tmp_path / "outside.png")
    (house / "media/hung.png").unlink()
    (house / "media/hung.png").symlink_to(tmp_path / "outside.png")
    (problem,) = load(house).problems
    assert "link" in problem.what
    assert not np.any(np.all(_mounted(house) == [200, 30, 20], axis=-1))


SILK, PAPER = [94, 114, 118], [239, 230, 210]


def _middle(house: Path) -> list[int]:
    hung = _mounted(house)
    return hung[hung.shape[0] // 2, hung.shape[1] // 2].tolist()


@pytest.mark.parametrize("kind", ["RGBA", "LA", "P"])
def test_what_is_transparent_shows_the_paper(house, kind):
    seal = Image.new("RGBA", (60, 120), (0, 0, 0, 0))
    seal.paste((200, 30, 20, 255), (0, 0, 60, 20))
    seal.convert(kind).save(house / "media/hung.png", **({"transparency": 0} if kind == "P" else {}))
    assert np.abs(np.subtract(_middle(house), PAPER)).max() <= 2


def test_a_picture_is_turned_as_its_camera_says(house):
    taken = Image.new("RGB", (120, 60), (20, 30, 200))
    taken.paste((200, 30, 20), (0, 0, 60, 60))  # at the left of what the sensor saw
    said = Image.Exif()
    said[0x0112] = 6  # to be turned by a quarter clockwise: its left is up
    taken.save(house / "media/hung.jpg", exif=said, quality=95)
    edit(house / "plan.toml", "hung.png", "hung.jpg")
    hung = _mounted(house).astype(int)
    high, wide = hung.shape[:2]
    above, below = hung[high // 4, wide // 2], hung[3 * high // 4, wide // 2]
    assert above[0] > 150 > above[2]
    assert below[2] > 150 > below[0]


@pytest.mark.parametrize("size", [(4000, 4), (3, 5000)])
def test_a_strip_hangs_as_a_strip(house, size):
    Image.new("RGB", size, (200, 30, 20)).save(house / "media/hung.png")
    assert np.any(np.all(_mounted(house) == [200, 30, 20], axis=-1))


def test_a_picture_too_large_is_not_opened(house):
    Image.new("1", (9000, 9000)).save(house / "media/hung.png")
    assert _middle(house) == PAPER


def test_the_rim_goes_on_as_the_edge(house):
    content = load(house)
    sheet = raise_room(content.plan, content.hall.title, (), folder=house, blank=True).sheet
    x0, y0, x1, y1 = _pixels(sheet)[0]
    for beside in range(1, 8):
        assert (sheet.picture[y0:y1, x1 - 1 + beside] == sheet.picture[y0:y1, x1 - 1]).all()
        assert (sheet.picture[y0 - beside, x0:x1] == sheet.picture[y0, x0:x1]).all()


@pytest.mark.parametrize(
    "sign",
    [
        Writing("plaque", "云想衣裳\n", "", (600, 200)),
        Writing("plaque", "云想衣裳", "Silk and\nCloud", (100, 700)),
        Writing("plaque", "衣" * 3000, "robe " * 900, (600, 200)),
        Writing("banner", "衣" * 800, "", (160, 700)),
        Writing("banner", " ", "", (1, 1)),
        Writing("label", "箱\n子", "a chest\n", (1, 900)),
    ],
    ids=["two lines", "upright", "long", "long banner", "point", "line"],
)
def test_whatever_is_written_is_drawn(sign):
    assert len(write([sign]).places) == 1


def test_a_banner_wider_than_high_is_read_along():
    """The letters of 横批 lie beside each other, the seal after the last."""
    sheet = write([Writing("banner", "云想衣裳", "", (640, 160))])
    x0, y0, x1, y1 = _pixels(sheet)[0]
    drawn = sheet.picture[y0:y1, x0:x1].astype(int)
    ink, seal = drawn.max(-1) < 80, (drawn[..., 0] > 120) & (drawn[..., 1] < 80)
    columns, rows = np.flatnonzero(ink.any(0)), np.flatnonzero(ink.any(1))
    assert np.ptp(columns) > 3 * np.ptp(rows) > 60
    assert np.flatnonzero(seal.any(0)).min() > columns.max()


def test_labels_give_way_last():
    label, picture = Writing("label", "衣", "dress", (520, 170)), Writing("picture", "", "", (310, 620))
    for count in (4, 12, 20):
        places = _pixels(write([label, *[picture] * count], blank=True))
        sizes = places[:, 2:] - places[:, :2]
        assert sizes[0, 0] / 520 >= sizes[1, 0] / 310 - 0.01
        assert sizes[0, 0] >= 0.9 * 520


def test_more_than_the_sheet_holds_is_said(house):
    assert not [hint for hint in hints(house) if "pixels" in hint.what]
    with (house / "plan.toml").open("a", encoding="utf-8") as plan:
        plan.write(SIGN * 120)
    assert [hint.key for hint in hints(house) if "pixels" in hint.what] == ["sign"]


def test_pictures_that_weigh_much_are_packed_coarser(house):
    content = load(house)
    rng = np.random.default_rng(0)
    noise = Image.fromarray(rng.integers(0, 255, (1200, 600, 3), np.uint8))

    def weight(count: int) -> int:
        room = raise_room(content.plan, content.hall.title, (), folder=house, blank=True)
        return len(room_glb(replace(room, sheet=write([hung] * count))))

    noise.save(house / "media/hung.png")
    hung = Writing("picture", "", "", (310, 620), house / "media/hung.png")
    few, many = weight(1), weight(8)
    assert many - few < 186_000


def test_leftovers_are_told_where_they_are_named(house):
    (house / "media/left.png").write_bytes((house / "media/hung.png").read_bytes())
    (problem,) = check(house)
    assert (problem.file, problem.fix) == ("media/left.png", "name it in plan.toml, or remove it")


def test_an_exhibits_own_picture_may_hang(house):
    edit(house / "plan.toml", "media/hung.png", "exhibits/chest/media/hung.png")
    (house / "media/hung.png").rename(house / "exhibits/chest/media/hung.png")
    assert check(house) == []
