"""What the page is told: scene and exhibit as JSON, texts as harmless HTML, addresses of media."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from content_house import edit, make_house
from hypothesis import given, settings
from hypothesis import strategies as some
from markdown_it import MarkdownIt

from hall_app.content import exhibit_json, load, scene_json, solids_of, walking_floor, yaw_of
from hall_app.content.floor import foot_height, rectangle
from hall_app.content.views import html_of, link_allowed

ASSETS = Path(__file__).parents[2] / "assets"


@pytest.fixture
def house(tmp_path: Path) -> Path:
    return make_house(tmp_path / "assets")


def text_of(house: Path, markdown: str) -> str:
    (house / "exhibits/chest/text.en.md").write_text(markdown, "utf-8")
    shown = exhibit_json(load(house), "chest")
    assert shown is not None
    return shown["text"]["en"]


def test_script_is_escaped(house: Path):
    html = text_of(
        house,
        "Hello <script>alert(1)</script>\n\n<script>\nalert(2)\n</script>\n\n<img src=x onerror=alert(3)>",
    )
    assert "<script" not in html
    assert "<img" not in html
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in html


@pytest.mark.parametrize(
    "address",
    [
        "javascript:alert(1)",
        "JaVaScRiPt:alert(1)",
        "java\nscript:alert(1)",
        "data:text/html,x",
        "vbscript:x",
        "file:///etc/passwd",
        "//example.org/x",
        "mailto:a@b",
    ],
)
def test_links_refused(address: str):
    assert not link_allowed(address)
    html = html_of(f"[x](<{address}>)", lambda src: None)
    assert "href" not in html


@pytest.mark.parametrize(
    "address", ["https://example.org/a?b=1", "http://example.org", "text.html", "#weave", "/catalogue"]
)
def test_links_allowed(address: str):
    assert link_allowed(address)
    assert f'href="{address}"' in html_of(f"[x]({address})", lambda src: None)


def test_a_backslash_does_not_lead_to_another_host():
    assert not link_allowed("/\\example.org")
    assert 'href="/%5Cexample.org"' in html_of("[x](</\\example.org>)", lambda src: None), (
        "a path on this host"
    )


def test_links_outside_open_elsewhere():
    html = html_of("[x](https://example.org) [y](/catalogue)", lambda src: None)
    assert html.count('rel="noopener noreferrer"') == 1


def test_the_empty_corner_of_a_table_heads_nothing():
    html = html_of("| | Length |\n|---|---|\n| a skirt | 93 |\n", lambda src: None)
    assert "<td></td>\n<th>Length</th>" in html
    assert "<td>a skirt</td>" in html


@settings(max_examples=150, deadline=None)
@given(some.text(alphabet="<>&\"'()[]!`*_#-: \n/\\ascriptonjvhf=x", max_size=60))
def test_no_text_makes_a_tag_of_its_own(markdown: str):
    allowed = {
        "p",
        "em",
        "strong",
        "a",
        "code",
        "pre",
        "h1",
        "h2",
        "h3",
        "h4",
        "h5",
        "h6",
        "ul",
        "ol",
        "li",
        "br",
        "hr",
    }
    allowed |= {"blockquote", "table", "thead", "tbody", "tr", "th", "td"}
    # An independent reader takes the tags out of the result again.
    for token in MarkdownIt("commonmark").parse(html_of(markdown, lambda src: None)):
        for piece in [token, *(token.children or ())]:
            if piece.type in ("html_inline", "html_block"):
                for tag in piece.content.split("<")[1:]:
                    name = tag.lstrip("/").split(">")[0].split()[0].rstrip("/")
                    assert name in allowed, (markdown, piece.content)


def test_pictures_in_texts(house: Path):
    assert '<img src="/media/chest/media/front.jpg?v=' in text_of(house, "![Front](media/front.jpg)")
    for src in (
        "https://example.org/x.jpg",
        "../../hall.toml",
        "media/none.jpg",
        "/etc/passwd",
        "exhibit.toml",
    ):
        html = text_of(house, f"![Words]({src})")
        assert "<img" not in html
        assert "Words" in html


def test_scene(house: Path):
    scene = scene_json(load(house))
    assert json.loads(json.dumps(scene)) == scene, "plain JSON"
    assert scene["title"] == {"zh": "厅", "en": "Hall"}
    assert scene["start"] == {"x": 0.0, "z": 3.0, "yaw": 0.0}
    assert scene["outline"] == [[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]]
    assert [solid["kind"] for solid in scene["solids"]] == ["wall", "booth", "column"]
    assert scene["solids"][2]["round"] == [3.0, 0.0, 0.3]
    assert len(scene["opaque"]) == 1
    assert scene["nodes"] == ["/exhibits/chest"]
    assert scene["music"] is None
    (entry,) = scene["exhibits"]
    assert entry["thumbnail"].startswith("/media/chest/media/front.jpg?v=")
    assert scene_json(load(house), nodes=["/room"])["nodes"] == ["/room"]


def test_what_moves_of_itself_is_told_from_what_stands_still(house: Path):
    """A page turns only what the scene calls moving (page/look/turning.js)."""

    def kind() -> str:
        (entry,) = scene_json(load(house))["exhibits"]
        return entry["kind"]

    assert kind() == "still"
    edit(house / "exhibits/chest/exhibit.toml", '"glow_when_near"]', '"glow_when_near", "turn_slowly"]')
    assert kind() == "moving"
    edit(house / "exhibits/chest/exhibit.toml", '"turn_slowly"', '"turn_to_visitor"')
    assert kind() == "live"


def test_music_of_the_shipped_hall():
    scene = scene_json(load(ASSETS))
    assert scene["music"] == scene["music_sources"][0]["url"]
    assert {source["type"] for source in scene["music_sources"]} == {"audio/webm", "audio/mpeg"}


def test_exhibit(house: Path):
    shown = exhibit_json(load(house), "chest")
    assert shown is not None
    assert json.loads(json.dumps(shown)) == shown
    assert shown["text"] == {"zh": "<p>一只箱子。</p>\n", "en": "<p>A chest.</p>\n"}
    (picture,) = shown["media"]
    assert picture["kind"] == "picture"
    assert picture["sources"][0]["type"] == "image/jpeg"
    assert picture["alt"] == {"zh": "正面", "en": "The front"}
    assert shown["has_close"]
    assert shown["measured"] == []
    assert exhibit_json(load(house), "nobody") is None


def test_shipped_exhibits_speak_both_languages():
    content = load(ASSETS)
    for exhibit in content.exhibits:
        shown = exhibit_json(content, exhibit.id)
        assert shown is not None
        assert all(len(shown["text"][language]) > 200 for language in ("zh", "en"))
        assert shown["record"]
        assert shown["licence"] == "CC0-1.0"
    kinds = {medium.kind for exhibit in content.exhibits for medium in exhibit.file.media}
    assert kinds == {"picture", "video", "audio"}


def test_baked_media_may_lie_elsewhere(tmp_path: Path):
    content = load(ASSETS)
    for name in ("drape.webm", "close.glb"):
        (tmp_path / name).write_bytes(b"film")
    (tmp_path / "bake.json").write_text(
        '{"errors": {"hall_hausdorff_max": 0.0004, "area_strain_p95": 0.0213, "other": 7}, "seconds": {"all": 41.25}}'
    )
    shown = exhibit_json(content, "pibo", baked=tmp_path)
    assert shown is not None
    film = next(medium for medium in shown["media"] if medium["kind"] == "video")
    assert [source["url"].partition("?")[0] for source in film["sources"]] == ["/media/pibo/baked/drape.webm"]
    assert shown["has_close"]
    assert [line["value"]["en"] for line in shown["measured"]] == ["2.13 %", "0.40 mm", "41.2 s"]


def test_measured_is_the_garment_that_is_shown_not_its_belt(tmp_path: Path):
    told = {"errors": {"vertices": 217, "yuanling_vertices": 6389, "mass_kg": 0.006}, "shown": "yuanling"}
    for shown, values in (("yuanling", ["6\u2009389"]), ("belt", ["217", "6.0 g"])):
        (tmp_path / "bake.json").write_text(json.dumps(told | {"shown": shown}))
        exhibit = exhibit_json(load(ASSETS), "pibo", baked=tmp_path)
        assert exhibit is not None
        assert [line["value"]["en"] for line in exhibit["measured"]] == values


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{", '{"errors": [1], "seconds": "long"}', '{"errors": {"vertices": "y", "mass_kg": true}}'],
)
def test_damaged_bake_notes_are_no_obstacle(tmp_path: Path, text: str):
    (tmp_path / "bake.json").write_text(text)
    shown = exhibit_json(load(ASSETS), "pibo", baked=tmp_path)
    assert shown is not None
    assert shown["measured"] == []


@pytest.mark.parametrize("facing", [0, 45, 90, 180, 270, 360, -90])
def test_yaw_looks_where_facing_points(facing: float):
    yaw, angle = yaw_of(facing), math.radians(facing)
    assert (-math.sin(yaw), -math.cos(yaw)) == pytest.approx((math.sin(angle), math.cos(angle)))
    assert -math.pi <= yaw <= math.pi


def test_rectangle_turns_its_front_to_facing():
    corners = rectangle((2.0, 1.0), 90.0, (-3.0, 0.0))
    assert {(round(x, 6), round(z, 6)) for x, z in corners} == {
        (-3.5, 1.0),
        (-3.5, -1.0),
        (-2.5, 1.0),
        (-2.5, -1.0),
    }
    front = rectangle((0.002, 1.0), 30.0, (0.0, 0.0))[2]
    assert front == pytest.approx(
        (0.5 * math.sin(math.radians(30)), 0.5 * math.cos(math.radians(30))), abs=2e-3
    )


def test_walking_floor_holds_every_solid(house: Path):
    content = load(house)
    footprints = solids_of(content.plan, content.exhibits)
    assert [footprint.kind for footprint in footprints] == ["wall", "booth", "column", "exhibit"]
    floor = walking_floor(content.plan, content.exhibits)
    assert len(floor.solids) == len(footprints)
    assert floor.shape.area == pytest.approx(100.0)


def test_foot_height(house: Path):
    toml = house / "exhibits/chest/exhibit.toml"
    content = load(house)
    assert foot_height(content.plan, content.exhibits[0].file) == 0.0
    edit(toml, "x = 0.0\nz = -1.0", 'x = -3.0\nz = 0.0\non = "booth"')
    content = load(house)
    assert foot_height(content.plan, content.exhibits[0].file) == 0.2
    edit(toml, 'on = "booth"', 'on = "booth"\ny = 0.5')
    content = load(house)
    assert foot_height(content.plan, content.exhibits[0].file) == 0.5
