"""The catalogue: contents, one h1, headings without a gap, small pictures that are made once."""

from __future__ import annotations

import io
import json
import re
import urllib.error
import urllib.request
from html.parser import HTMLParser
from pathlib import Path

import pytest
from PIL import Image

from hall_app.content.views import html_of
from hall_app.web.pages import EDGE, Thumbnails


class Outline(HTMLParser):
    """Headings, ids, links and pictures of a page, in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.levels: list[int] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs) -> None:
        given = dict(attrs)
        if re.fullmatch("h[1-6]", tag):
            self.levels.append(int(tag[1]))
        if "id" in given:
            self.ids.append(given["id"])
        if tag == "a":
            self.links.append(given["href"])
        if tag == "img":
            self.pictures.append(given)


def got(url: str) -> bytes:
    with urllib.request.urlopen(url, timeout=30) as answer:
        return answer.read()


def no_gaps(levels: list[int]) -> bool:
    return all(after <= before + 1 for before, after in zip(levels, levels[1:], strict=False))


@pytest.mark.parametrize("lang", ["zh", "en"])
def test_the_shipped_catalogue(shipped_hall, lang: str):
    page = Outline(got(f"{shipped_hall.url}/catalogue?lang={lang}").decode())
    exhibits = [
        "exhibit-" + entry["id"] for entry in json.loads(got(f"{shipped_hall.url}/api/scene"))["exhibits"]
    ]
    assert page.levels[0] == 1
    assert page.levels.count(1) == 1
    assert no_gaps(page.levels)
    assert [link[1:] for link in page.links if link[1:] in exhibits] == exhibits, "the contents lead to each"
    assert [name for name in page.ids if name in exhibits] == exhibits
    assert len(page.ids) == len(set(page.ids))
    for picture in page.pictures:
        assert picture["loading"] == "lazy"
        if picture["src"].partition("?")[0].endswith(".svg"):  # sharp at any size
            continue
        assert picture["src"].startswith("/thumbnails/"), "no full-size picture"
        size = int(picture["width"]), int(picture["height"])
        assert max(size) <= EDGE
        with Image.open(io.BytesIO(got(shipped_hall.url + picture["src"]))) as small:
            assert small.size == size
        large = picture["src"].replace("/thumbnails/", "/media/")
        assert large in page.links or picture["alt"] == "", "a click leads to the large one"


@pytest.mark.parametrize(
    "path", ["box/exhibit.toml", "nobody/x.png", "box/%2e%2e/%2e%2e/hall.toml", "box/box.glb"]
)
def test_thumbnails_are_of_shown_pictures_alone(plain_hall, path: str):
    with pytest.raises(urllib.error.HTTPError) as refused:
        got(f"{plain_hall.url}/thumbnails/{path}")
    with refused.value as answer:
        assert answer.code == 404


def test_a_thumbnail_is_made_once_and_again_for_another_picture(tmp_path: Path):
    picture, thumbnails = tmp_path / "wide.png", Thumbnails(tmp_path / "kept")
    Image.new("RGBA", (1200, 300), (200, 30, 20, 128)).save(picture)
    assert thumbnails.size(picture) == (EDGE, EDGE // 4)
    first = thumbnails.file(picture)
    written = first.stat().st_mtime_ns
    assert thumbnails.file(picture) == first
    assert first.stat().st_mtime_ns == written
    with Image.open(first) as small:
        assert small.size == (EDGE, EDGE // 4)
        assert small.mode == "RGBA"
    Image.new("RGB", (100, 300), (20, 30, 200)).save(picture)
    assert thumbnails.size(picture) == (100, 300), "never larger than the picture"
    assert thumbnails.file(picture) != first
    assert len(list((tmp_path / "kept").iterdir())) == 2


def test_a_picture_on_its_side_stands_upright(tmp_path: Path):
    picture, thumbnails = tmp_path / "phone.jpg", Thumbnails(tmp_path / "kept")
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.new("RGB", (800, 400)).save(picture, exif=exif)
    assert thumbnails.size(picture) == (EDGE // 2, EDGE)
    with Image.open(thumbnails.file(picture)) as small:
        assert small.size == (EDGE // 2, EDGE)


def test_grey_of_sixteen_bits_stays_grey(tmp_path: Path):
    picture, thumbnails = tmp_path / "scan.png", Thumbnails(tmp_path / "kept")
    Image.new("I;16", (90, 90), 0x4040).save(picture)
    with Image.open(thumbnails.file(picture)) as small:
        assert abs(small.convert("L").getpixel((45, 45)) - 0x40) <= 2


@pytest.mark.parametrize("data", [b"", b"no picture", b"\x89PNG\r\n\x1a\n cut off"])
def test_what_is_no_picture_is_handed_on_as_it_is(tmp_path: Path, data: bytes):
    picture = tmp_path / "odd.png"
    picture.write_bytes(data)
    thumbnails = Thumbnails(tmp_path / "kept")
    assert thumbnails.size(picture) is None
    assert thumbnails.file(picture) == picture
    assert thumbnails.size(tmp_path / "gone.png") is None


def test_a_folder_that_takes_nothing_costs_no_picture(tmp_path: Path):
    picture = tmp_path / "p.png"
    Image.new("RGB", (8, 8)).save(picture)
    (tmp_path / "kept").write_text("a file, not a folder")
    assert Thumbnails(tmp_path / "kept").file(picture) == picture


LEVELS = {
    "as most curators write": ("## a\n## b\n### c\n## d", [3, 3, 4, 3]),
    "from the top": ("# a\n## b\n# c", [3, 4, 3]),
    "with gaps": ("# a\n#### b\n###### c\n## d", [3, 4, 5, 4]),
    "upside down": ("#### a\n## b\n### c", [3, 3, 4]),
    "deeper than HTML": ("# a\n## b\n### c\n#### d\n##### e", [3, 4, 5, 6, 6]),
}


@pytest.mark.parametrize("case", LEVELS)
def test_headings_of_a_text_stand_beneath_its_title(case: str):
    markdown, levels = LEVELS[case]
    html = html_of(markdown.replace("\n", "\n\n"), lambda path: None, top=3)
    assert Outline(html).levels == levels
    assert len(re.findall(r"</h[3-6]>", html)) == len(levels)
    plain = html_of("## a", lambda path: None)
    assert plain == "<h2>a</h2>\n", "elsewhere they stay as they were written"
