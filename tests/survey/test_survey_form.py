"""The form page: what the server writes, and what a visitor meets in a real browser."""

from __future__ import annotations

import re
import tomllib
from html.parser import HTMLParser
from pathlib import Path

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from survey_samples import ASSETS

import survey
from survey.web import form
from survey.web.form import form_page, words

FOLDER = Path(form.__file__).parent

PAGE = "/questionnaires/garment"


class Tags(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def of(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.mark.parametrize(("query", "header", "language"), [
    ("?lang=en", "zh", "en"), ("?lang=zh", "en", "zh-Hans"), ("", "en-GB,en;q=0.9", "en"), ("", "fr, zh-TW", "zh-Hans"),
    ("", "", "zh-Hans"), ("?lang=xx", "", "zh-Hans"),
])  # fmt: skip
def test_the_language_is_the_one_asked_for_else_the_browser_s_else_chinese(hall, query, header, language):
    page = hall.client.get(PAGE + query, headers={"accept-language": header})
    assert Tags(page.text).of("html")[0]["lang"] == language


@pytest.mark.parametrize("language", ["zh", "en"])
@pytest.mark.parametrize("key", ["garment", "platform-user", "platform-admin"])
def test_every_item_has_a_named_group_with_all_points_and_unique_ids(hall, key, language):
    questionnaire = hall.mounted.questionnaires[key]
    page = Tags(hall.client.get(f"/questionnaires/{key}?lang={language}").text)
    ids = [attributes["id"] for _, attributes in page.tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    groups = [attributes for attributes in page.of("div") if attributes.get("role") == "radiogroup"]
    assert [group["aria-labelledby"] for group in groups] == [
        f"label-{item}" for item in questionnaire.item_ids
    ]
    for item in questionnaire.item_ids:
        values = [one["value"] for one in page.of("input") if one.get("name") == f"score-{item}"]
        assert values == ["1", "2", "3", "4", "5", "null"]
    labelled = {label["for"] for label in page.of("label") if "for" in label}
    assert {area["id"] for area in page.of("textarea")} <= labelled


def test_nothing_is_loaded_from_elsewhere_and_the_policy_says_so(hall):
    reply = hall.client.get(PAGE)
    page = Tags(reply.text)
    sources = [
        tag.get("src") or tag.get("href") for kind in ("script", "link", "img") for tag in page.of(kind)
    ]
    assert not [source for source in sources if source and re.match(r"(https?:)?//", source)]
    assert "frame-ancestors 'self'" in reply.headers["content-security-policy"]
    for source in filter(None, sources):
        if source.startswith(".."):
            assert hall.client.get(source.removeprefix("..")).status_code == 200
    assert hall.client.get("/survey-static/page.py").status_code == 404
    assert hall.client.get("/survey-static/..%2fpage.py").status_code == 404


def test_a_curator_s_markup_stays_text():
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(1)>\" ' &"
    questionnaire = survey.read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
    data = questionnaire.document()

    def poisoned(value):
        if isinstance(value, dict):
            return {
                key: evil if key in ("zh", "en") and isinstance(text, str) else poisoned(text)
                for key, text in value.items()
            }
        return [poisoned(entry) for entry in value] if isinstance(value, list) else value

    page = form_page(survey.Questionnaire.model_validate(poisoned(data)), "zh", None)
    tags = Tags(page)
    assert not tags.of("img")
    assert len(tags.of("script")) == 2  # ours and its settings
    assert not [
        attributes for _, attributes in tags.tags if any(name.startswith("on") for name in attributes)
    ]
    assert "&lt;script&gt;" in page


@pytest.mark.parametrize("exhibit", ['"><script>', "../x", "x" * 65, "", "A"])
def test_a_mistyped_exhibit_is_left_out(hall, exhibit):
    page = hall.client.get(PAGE, params={"exhibit": exhibit}).text
    assert '"exhibit": null' in page
    assert "&amp;exhibit" not in page


def test_a_wrong_address_is_a_page_of_ours(hall):
    reply = hall.client.get("/questionnaires/nonsense?lang=en")
    assert reply.status_code == 404
    assert "No such questionnaire" in reply.text


def test_the_page_s_texts_are_the_same_in_both_languages_and_all_used():
    texts = tomllib.loads((FOLDER / "texts.toml").read_text("utf-8"))
    assert set(texts["zh"]) == set(texts["en"])
    for key in texts["zh"]:
        assert set(re.findall(r"{\w+}", texts["zh"][key])) == set(re.findall(r"{\w+}", texts["en"][key]))
    code = (FOLDER / "form.js").read_text("utf-8") + (FOLDER / "page.py").read_text("utf-8")
    unused = [key for key in texts["zh"] if not re.search(rf"""(words\.|["']){key}\b""", code)]
    assert not unused


def luminance(colour: str) -> float:
    """Relative luminance of #rrggbb (WCAG 2)."""
    parts = [int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("ink", ["ink", "quiet", "vermilion"])
@pytest.mark.parametrize("ground", ["paper", "sheet", "wash"])
def test_every_text_colour_stands_out_from_every_ground(ink, ground):
    colours = dict(re.findall(r"--([a-z]+): (#[0-9a-f]{6});", (FOLDER / "form.css").read_text("utf-8")))
    assert colours["paper"] == "#f6f1e6"
    one, other = sorted((luminance(colours[ink]), luminance(colours[ground])))
    assert (other + 0.05) / (one + 0.05) >= 4.5


def test_the_list_names_every_questionnaire_and_its_links_lead_there(hall):
    page = Tags(hall.client.get("/questionnaires?lang=en").text)
    links = [href for link in page.of("a") if (href := link.get("href") or "").startswith("./")]
    assert len(links) == 3
    for link in links:
        assert hall.client.get(link.removeprefix(".")).status_code == 200


def test_an_empty_folder_shows_an_empty_list(tmp_path):
    app = FastAPI()
    mounted = survey.mount(app, content=tmp_path, data=tmp_path / "data")
    with TestClient(app) as client:
        assert words("zh")["list_empty"] in client.get("/questionnaires?lang=zh").text
    mounted.close()


def test_a_scale_s_layout_on_a_phone_follows_its_words():
    garment = survey.read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
    kinds = {language: set(re.findall(r'class="scale ([^"]+)"', form_page(garment, language, None)))
             for language in ("zh", "en")}  # fmt: skip
    assert kinds == {"zh": {"of-5"}, "en": {"of-5 long"}}
    seven = {"anchors": [{"zh": "好", "en": "ok"}] * 7, "not_seen": {"zh": "无", "en": "no"}}
    scaled = survey.Questionnaire.model_validate(garment.document() | {"scale": seven})
    assert 'class="scale of-7 apart"' in form_page(scaled, "en", None)


def test_the_consent_tells_until_when_an_answer_can_be_taken_back():
    for path in (ASSETS / "questionnaires").glob("*.toml"):
        consent = survey.read_questionnaire(path).consent
        assert "until" in consent.en
        assert "之前" in consent.zh


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_while_the_database_is_away_every_door_says_so_and_opens_again_afterwards(hall):
    file, away = hall.data / "survey.sqlite", hall.data / "away"
    file.rename(away)
    for address in ("/questionnaires", PAGE):
        reply = hall.client.get(f"{address}?lang=en")
        assert reply.status_code == 503
        assert "not available just now" in reply.text
        assert int(reply.headers["retry-after"]) > 0
        assert str(file) not in reply.text  # where it lies is for the operator
    assert hall.client.get("/api/v1/questionnaires").status_code == 503
    (problem,) = hall.mounted.problems
    assert problem.file == str(file)
    assert "is gone" in problem.what
    assert not file.exists()
    away.rename(file)
    assert hall.client.get(PAGE).status_code == 200
    assert hall.mounted.problems == ()
