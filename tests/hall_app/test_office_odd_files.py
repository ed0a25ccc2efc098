"""Forms of the office over an exhibit.toml that is TOML and no exhibit's: shown with its faults, put right."""

from __future__ import annotations

import json
import shutil
import tomllib
import uuid
from datetime import date

import hypothesis
import pytest
from content_house import EXHIBIT, add_exhibit
from hypothesis import strategies as st
from office_clerk import Clerk, clerk

from hall_app.house.people import Role
from hall_app.web.platform.office.collection import keys_of

TOML = "exhibit.toml"


@pytest.fixture(scope="module")
def curator(counter) -> Clerk:
    return clerk(counter, counter.people, Role.CURATOR)


@pytest.fixture(scope="module")
def chest(counter):
    """An exhibit of its own; its folder."""
    home = add_exhibit(counter.content, f"o{uuid.uuid4().hex[:10]}", EXHIBIT.replace("z = -1.0", "z = 2.0"))
    yield home
    shutil.rmtree(home, ignore_errors=True)


@pytest.fixture(autouse=True)
def as_it_was(curator, chest):
    before = (chest / TOML).read_bytes()
    yield
    (chest / TOML).write_bytes(before)
    if curator.told(f"collection/{chest.name}")["draft"]:
        curator.drop(chest.name)


TITLE, FILE = 'title = { zh = "箱", en = "Chest" }', 'file = "media/front.jpg"'
NESTED = "[" * 300 + "]" * 300


def odd(old: str = "", new: str = "", more: str = "") -> str:
    """The chest with something in it that is TOML and no exhibit's. more: above the first table."""
    place = EXHIBIT.replace("z = -1.0", "z = 2.0")
    assert old in place
    return f"{more}\n{place.replace(old, new)}"


@pytest.mark.parametrize(
    "toml",
    [
        odd(TITLE, "title = { zh = 1, en = 2 }"),
        odd(TITLE, "title = { zh = 1979-05-27, en = 1.0 }"),
        odd(TITLE, 'title = "Chest"'),
        odd(more="caption = { zh = [1], en = { a = 2 } }"),
        odd(more='caption = { zh = "一" }'),
        odd(FILE, 'file = ["a"]'),
        odd(FILE, "files = 3"),
        odd(FILE, 'files = [1, "media/front.jpg"]'),
        odd('kind = "picture"', "kind = [1]"),
        odd("[[media]]", "[media]"),
        odd("radius = 0.4", "radius = 9" + "9" * 400),
        odd("radius = 0.4", "size = [inf, nan]"),
        odd("x = 0.0", "x = 1979-05-27"),
        odd("x = 0.0", f"x = 0x{'f' * 5000}"),
        odd(more=f"size_range = {NESTED}"),
        odd('[models]\nhall = "media/chest.glb"', "", more="models = 3"),
        "",
    ],
)
def test_an_odd_file_is_shown_and_can_be_put_right(curator, chest, toml):
    at = f"collection/{chest.name}"
    curator.told(f"{at}/text", {"file": TOML, "text": toml})
    place = (
        [f"{at}/place"] if "x = 0.0" not in toml or "radius = 0.4" not in toml else []
    )  # the walk takes a second
    for path in (at, f"{at}/preview", "collection", *place):
        assert curator.get(f"/office/{path}?lang=zh").status == 200, path
        assert curator.api(path).status == 200, path
    page = curator.get(f"/office/{at}?lang=en")
    assert 'class="faults"' in page.text, "what the check says of it"
    saved = curator.api(f"{at}/fields", {"title.zh": "箱", "title.en": "A chest"})
    assert saved.status in (200, 400)
    if saved.status == 400:
        assert json.loads(saved.body)["error"] == "content-file"
    assert curator.send(f"/office/{at}", f"/office/{at}/drop").status == 200, "the way out is on the page"
    assert curator.told(at)["draft"] is None


def test_a_title_that_is_no_pair_becomes_one(curator, chest):
    at = f"collection/{chest.name}"
    curator.told(f"{at}/text", {"file": TOML, "text": odd(TITLE, 'title = "Chest"')})
    page = curator.get(f"/office/{at}?lang=en")
    assert page.form("form-words")["title.zh"] == "Chest", "what stands there is shown"
    curator.send(page, "form-words", **{"title.zh": "箱"})
    text = curator.told(f"{at}/text?file={TOML}")["text"]
    assert tomllib.loads(text)["title"] == {"zh": "箱", "en": "Chest"}


@pytest.mark.parametrize(
    ("more", "given", "key"),
    [
        ("record = 3", {"record.material.zh": "木", "record.material.en": "Wood"}, "record.material"),
        ("size_range = 1", {"place.y": "1"}, None),
    ],
)
def test_what_a_form_cannot_write_names_file_and_key(curator, chest, more, given, key):
    at = f"collection/{chest.name}"
    curator.told(f"{at}/text", {"file": TOML, "text": odd(more=more)})
    answer = curator.api(f"{at}/fields", given)
    assert answer.status == (400 if key else 200), answer.text
    if key:
        assert f"exhibit.toml: {key}: what stands there is of another form" in answer.text
        assert "原有的值形式不同" in curator.api(f"{at}/fields?lang=zh", given).text


@pytest.mark.parametrize("value", ["[" * 3000 + "]" * 3000, "9" * 5000])
def test_what_nobody_can_read_is_refused_as_it_is_saved(curator, chest, value):
    at = f"collection/{chest.name}"
    for lang, told in (("en", "shorten its numbers and lists"), ("zh", "缩短其中的数字与列表")):
        answer = curator.api(f"{at}/text?lang={lang}", {"file": TOML, "text": odd(more=f"x = {value}")})
        assert answer.status == 400
        assert "exhibit.toml" in answer.text
        assert told in answer.text
    (chest / TOML).write_text(odd(more=f"x = {value}"), "utf-8")  # by hand
    assert curator.get(f"/office/{at}").status == 200
    assert curator.api(f"{at}/fields", {"title.zh": "箱", "title.en": "A chest"}).status == 400


def written(value: object) -> str:
    """A value as TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(name)} = {written(one)}" for name, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(written, value)) + "]"
    if isinstance(value, str | bool):
        return json.dumps(value)
    return value.isoformat() if isinstance(value, date) else repr(value)


PLAIN = st.one_of(
    st.booleans(),
    st.integers(),
    st.integers(10**390, 10**400),
    st.floats(),
    st.dates(),
    st.sampled_from(["", "media/front.jpg", "picture"]),
)
VALUES = st.recursive(
    PLAIN,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["zh", "en", "file", "files", "kind", "x", "alt"]), inner, max_size=3
        )
    ),
    max_leaves=5,
)
KEYS = sorted(
    {
        one.path
        for one in keys_of(
            "title",
            "caption",
            "record",
            "licence",
            "thumbnail",
            "questionnaire",
            "behaviours",
            "body",
            "models",
            "show",
            "size_range",
            "place",
        )
    }
    | {(name,) for name in ("media", "record", "body", "models", "show", "place", "scan", "outfit")}
)


@hypothesis.settings(
    max_examples=40, deadline=None, suppress_health_check=[hypothesis.HealthCheck.function_scoped_fixture]
)
@hypothesis.given(path=st.sampled_from(KEYS), value=VALUES, listed=st.booleans())
def test_any_value_under_any_key_is_shown(curator, chest, path, value, listed):
    """The forms are of a file that somebody wrote by hand: whatever stands there, its page opens."""
    if path == ("media",) and listed:
        value = [value if isinstance(value, dict) else {"kind": "picture", "file": value}]
    text = f"{'.'.join(path)} = {written(value)}\n"
    at = f"collection/{chest.name}"
    saved = curator.api(f"{at}/text", {"file": TOML, "text": text})
    assert saved.status == 200, (text, saved.text)
    assert curator.get(f"/office/{at}").status == 200, text
    assert curator.api(f"{at}/fields", {"title.zh": "箱", "title.en": "Chest"}).status in (200, 400), text
