"""`hall check` opens pictures, films and sounds, and knows every questionnaire, weave and pattern."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from content_house import edit, make_house, png_of
from full_matrix import by_day
from PIL import Image

from hall_app.check import check
from hall_app.check.files import AUDIO, VIDEO
from hall_app.content import exhibit_json, load
from hall_app.content.models import FORMATS
from hall_app.content.views import TYPES

ASSETS = Path(__file__).parents[2] / "assets"
TOML = "exhibits/chest/exhibit.toml"


@pytest.fixture
def house(tmp_path: Path) -> Path:
    return make_house(tmp_path / "assets")


def lines(folder: Path) -> list[str]:
    return [str(problem) for problem in check(folder)]


def media(house: Path, name: str, data: bytes, kind: str = "picture") -> None:
    """Put another medium, with all words it needs, in place of the chest's picture."""
    home = house / "exhibits/chest"
    edit(
        home / "exhibit.toml",
        'kind = "picture"\nfile = "media/front.jpg"',
        f'kind = "{kind}"\nfile = "media/{name}"',
    )
    edit(home / "exhibit.toml", "alt =", 'transcript = { zh = "静", en = "Silence" }\nalt =')
    (home / "media/front.jpg").unlink()
    (home / "media" / name).write_bytes(data)


def jpeg() -> bytes:
    from io import BytesIO

    out = BytesIO()
    Image.effect_noise((64, 64), 50).save(out, "JPEG")
    return out.getvalue()


def svg(inner: bytes) -> bytes:
    return b'<svg xmlns="http://www.w3.org/2000/svg">' + inner + b"</svg>"


SVG = svg(b'<path d="M0 0L1 1"/>')

BAD: dict[str, tuple[str, bytes, str, str, str]] = {
    "letters": ("a.jpg", b"not a jpg", "picture", "it is no picture, or broken", "export it again"),
    "a page": ("a.png", b"<script>alert(1)</script>", "picture", "it is no picture", "export it again"),
    "huge": ("a.png", png_of(60_000, 60_000), "picture", "more pixels than can be opened", "export it again"),
    "large": (
        "a.png",
        png_of(9_000, 20),
        "picture",
        "9000 x 20 pixels, at most 8192 x 8192",
        "scale it down",
    ),
    "cut off": ("a.jpg", jpeg()[:-400], "picture", "it is broken or cut off", "copy or export it again"),
    "misnamed": ("a.png", jpeg(), "picture", "its name says PNG, but it is JPEG", "rename it"),
    "drawing": (
        "a.gif",
        b"GIF89a",
        "picture",
        "the hall shows no .gif as picture",
        "convert it to one of .jpg",
    ),
    "svg of nothing": ("a.svg", b"<svg/>", "picture", "it is no SVG", "correct its name"),
    "svg cut off": ("a.svg", SVG[:-4], "picture", "it is broken or cut off", "copy or export it again"),
    "svg that unfolds": ("a.svg", b"<!DOCTYPE x>" + SVG, "picture", "a document type", "plain SVG"),
    "svg that runs": ("a.svg", svg(b"<script/>"), "picture", "it holds a program", "remove scripts"),
    "svg that acts": (
        "a.svg",
        svg(b'<path onload="x()"/>'),
        "picture",
        "it holds a program",
        "remove scripts",
    ),
    "svg that asks": (
        "a.svg",
        svg(b'<image href="http://x/y.png"/>'),
        "picture",
        "it asks for another file",
        "into the file itself",
    ),
    "no ending": ("a", jpeg(), "picture", "the hall shows no file without an ending", "convert it"),
    "film": ("a.webm", b"RIFF" + bytes(12), "video", "it is no webm file", "export it again in that format"),
    "sound": ("a.wav", b"RIFF\0\0\0\0AVI ", "audio", "it is no wav file", "export it again"),
    "mp3": ("a.mp3", b"\xff\xd8\xff\xe0 a picture", "audio", "it is no mp3 file", "export it again"),
    "mp4": ("a.mp4", b"ftyp" + bytes(12), "video", "it is no mp4 file", "export it again"),
    "a picture for a sound": (
        "a.jpg",
        jpeg(),
        "audio",
        "the hall shows no .jpg as audio",
        "convert it to one of .webm",
    ),
}


@pytest.mark.parametrize("case", by_day([*BAD][::4], BAD))
def test_media_that_are_not_what_they_say(house: Path, case: str):
    name, data, kind, what, fix = BAD[case]
    media(house, name, data, kind)
    (line,) = lines(house)
    assert line.startswith(f"{TOML}: media[1].file: media/{name}: ")
    assert what in line
    assert fix in line.partition(" – ")[2]


GOOD = {
    "a.JPG": (jpeg(), "picture"),
    "a.svg": (SVG, "picture"),
    "a.webm": (b"\x1a\x45\xdf\xa3....", "video"),
    "a.mp4": (b"\0\0\0\x18ftypmp42", "audio"),
    "a.m4a": (b"\0\0\0\x18ftypM4A ", "audio"),
    "a.ogg": (b"OggS\0", "audio"),
    "a.opus": (b"OggS\0", "audio"),
    "a.wav": (b"RIFF\1\1\1\1WAVE", "audio"),
    "a.mp3": (b"ID3\4\0", "audio"),
    "b.mp3": (b"\xff\xfb\x90\x64", "audio"),
}


@pytest.mark.parametrize("name", by_day([*GOOD][::4], GOOD))
def test_media_that_are(house: Path, name: str):
    media(house, name, *GOOD[name])
    assert lines(house) == []


def test_what_is_checked_is_what_is_served():
    assert {*FORMATS, *VIDEO, *AUDIO, ".glb", ".clip", ".points"} == set(TYPES)


def test_thumbnail_poster_music_and_pictures_of_texts(house: Path):
    home = house / "exhibits/chest"
    edit(home / "exhibit.toml", "licence", 'thumbnail = "media/small.png"\nlicence')
    edit(home / "exhibit.toml", "alt =", 'poster = "media/still.webp"\nalt =')
    (home / "text.zh.md").write_text("![图](media/seen.jpg)", "utf-8")
    for name in ("small.png", "still.webp", "seen.jpg"):
        (home / "media" / name).write_bytes(b"no picture")
    edit(house / "hall.toml", "licence", 'music = ["media/tune.ogg"]\nlicence')
    (house / "media").mkdir()
    (house / "media/tune.ogg").write_bytes(b"no music")
    starts = (
        "hall.toml: music[1]",
        f"{TOML}: thumbnail",
        f"{TOML}: media[1].poster",
        "exhibits/chest/text.zh.md",
    )
    found = lines(house)
    assert len(found) == len(starts)
    for line, start in zip(found, starts, strict=True):
        assert line.startswith(f"{start}: ")


@pytest.mark.parametrize(
    "src", ["<media/我的 图.jpg>", "media/%E6%88%91%E7%9A%84%20%E5%9B%BE.jpg", "<./media/我的 图.jpg?v=1>"]
)
def test_pictures_with_spaces_and_chinese_names(house: Path, src: str):
    home = house / "exhibits/chest"
    (home / "media/我的 图.jpg").write_bytes(jpeg())
    (home / "text.en.md").write_text(f"![mine]({src})", "utf-8")
    assert lines(house) == []
    shown = exhibit_json(load(house), "chest")
    assert shown is not None
    assert 'src="/media/chest/media/%E6%88%91%E7%9A%84%20%E5%9B%BE.jpg?v=' in shown["text"]["en"]


# Questionnaires, weaves and patterns.


def asked(house: Path, name: str = "garment") -> Path:
    """Give the folder a questionnaire; returns its file."""
    (house / "questionnaires").mkdir(exist_ok=True)
    path = house / "questionnaires" / f"{name}.toml"
    path.write_bytes((ASSETS / "questionnaires/garment.toml").read_bytes())
    return path


def test_questionnaires_are_read(house: Path):
    edit(house / "hall.toml", "licence", 'questionnaire = "garment"\nlicence')
    path = asked(house)
    assert lines(house) == []
    path.write_text('qqq = "?"\n' + path.read_text("utf-8"), "utf-8")
    assert lines(house) == [
        "questionnaires/garment.toml: qqq: unknown key – remove it or correct its spelling"
    ]


@pytest.mark.parametrize(
    ("name", "toml"),
    [("nope", "hall.toml"), ("nope", TOML), ("../hall", "hall.toml"), ("x" * 300, TOML), ("\0", TOML)],
)
def test_a_questionnaire_that_is_not_there(house: Path, name: str, toml: str):
    asked(house)
    written = name.replace("\0", "\\u0000")
    edit(house / toml, "licence", f'questionnaire = "{written}"\nlicence')
    (line,) = lines(house)
    assert line.startswith(f"{toml}: questionnaire: there is no questionnaire ")
    assert line.endswith("write one of questionnaires/: garment")


@pytest.mark.parametrize("name", ["weaves/satin.toml", "patterns/none.toml", "mannequins/nobody.npz"])
def test_crafts_no_exhibit_names_are_read_too(house: Path, name: str):
    (house / name).parent.mkdir()
    (house / name).write_text("x=1")
    if name.startswith("mannequins/"):  # a figure needs a licence as well
        (house / "mannequins/README.md").write_text("nobody.npz: CC0-1.0")
    (line,) = lines(house)
    assert line.startswith(f"{name}: ")
    assert " – " in line


def test_crafts_are_no_links_out_of_the_folder(house: Path, tmp_path: Path):
    (tmp_path / "secret").write_text("root:x:0:0")
    (house / "weaves").mkdir()
    (house / "weaves/w.toml").symlink_to(tmp_path / "secret")
    (line,) = lines(house)
    assert line.startswith(
        "weaves/w.toml: it is a link that leaves the content folder – copy the file itself"
    )


def spoil_pattern(house: Path) -> None:
    (house / "patterns").mkdir()
    (house / "patterns/p.toml").write_bytes(b"")


EMPTY: dict[str, Callable[[Path], object]] = {
    "patterns/p.toml": spoil_pattern,
    "questionnaires/garment.toml": lambda house: asked(house).write_bytes(b""),
}


@pytest.mark.parametrize("name", EMPTY)
def test_empty_files_are_named(house: Path, name: str):
    EMPTY[name](house)
    assert any(line.startswith(f"{name}: ") for line in lines(house))
