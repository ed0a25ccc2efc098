"""Articles, glossary: read, checked, kept where an edit is bad; what ships is whole in both languages."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from content_house import edit, make_house
from PIL import Image

from hall_app.check import check
from hall_app.content import Watcher, load
from hall_app.content.views import article_html, pictures_in, references_in, spoken_of, words_in, words_of

ASSETS = Path(__file__).parents[2] / "assets"
ARTICLE = """
title = { zh = "纱", en = "On gauze" }
summary = { zh = "说纱。", en = "About gauze." }
picture = "media/net.png"
exhibits = ["chest"]
written = 2026-11-27
licence = "CC0-1.0"
[[source]]
text = { zh = "某页", en = "A page" }
standing = "museum"
url = "https://example.org/page"
"""
GLOSSARY = """
[[word]]
id = "sha"
zh = "纱"
pinyin = "shā"
en = "gauze"
group = "cloth"
short = { zh = "稀而透。", en = "Open and sheer." }
see = ["sha"]
exhibits = ["chest"]
"""
TEXT = 'A [net](word:sha) of <yarns>, see [it](exhibit:chest).\n\n![a net](media/net.png "The net")\n'


@pytest.fixture
def house(tmp_path: Path) -> Path:
    house = make_house(tmp_path / "assets")
    home = house / "articles/gauze"
    (home / "media").mkdir(parents=True)
    (home / "article.toml").write_text(ARTICLE, "utf-8")
    (home / "text.en.md").write_text(TEXT.replace("<yarns>", "yarns"), "utf-8")
    (home / "text.zh.md").write_text(
        "一张[网](word:sha)，见[此](exhibit:chest)。\n\n![网](media/net.png)\n", "utf-8"
    )
    Image.new("RGB", (40, 20), "#7a4b2e").save(home / "media/net.png")
    (house / "glossary.toml").write_text(GLOSSARY, "utf-8")
    return house


def told(house: Path) -> list[str]:
    return [str(problem) for problem in check(house)]


def draw(address: str, words: str) -> str:
    return f'<img src="{address}" alt="{words}">'


def test_a_good_one_has_no_problem_and_leads_where_it_says(house: Path):
    assert told(house) == []
    content = load(house)
    (article,) = content.writing.articles
    html = article_html(content, article, "en", draw)
    assert 'href="/culture/glossary?lang=en#word-sha"' in html
    assert 'aria-describedby="said-sha"' in html
    assert 'href="/catalogue?lang=en#exhibit-chest"' in html
    assert '<figure><img src="/media/articles/gauze/media/net.png?v=' in html
    assert "<figcaption>The net</figcaption>" in html
    assert words_of(content, article, "zh") == ("sha",)
    assert spoken_of(content, article, "exhibit") == ("chest",)


@pytest.mark.parametrize(
    ("file", "old", "new", "line"),
    [
        (
            "articles/gauze/text.en.md",
            "word:sha",
            "word:sah",
            "articles/gauze/text.en.md: word:sah: there is no word 'sah' – did you mean sha?",
        ),
        (
            "articles/gauze/text.zh.md",
            "exhibit:chest",
            "exhibit:box",
            "articles/gauze/text.zh.md: exhibit:box: there is no exhibit 'box' – correct the name",
        ),
        (
            "articles/gauze/text.en.md",
            "media/net.png",
            "media/not.png",
            "articles/gauze/text.en.md: the picture media/not.png is not there and is left out – copy it",
        ),
        (
            "articles/gauze/text.en.md",
            "![a net]",
            "![]",
            "articles/gauze/text.en.md: the picture media/net.png has no description for visitors who cannot see it – ",
        ),
        (
            "articles/gauze/text.en.md",
            "of yarns",
            "of <b>yarns",
            "articles/gauze/text.en.md: HTML is not read, <b> is shown as letters – ",
        ),
        (
            "articles/gauze/article.toml",
            '["chest"]',
            '["chess"]',
            "articles/gauze/article.toml: exhibits: there is no exhibit 'chess' – did you mean chest?",
        ),
        (
            "articles/gauze/article.toml",
            '"media/net.png"',
            '"media/no.png"',
            "articles/gauze/article.toml: picture: the picture media/no.png is not there",
        ),
        (
            "articles/gauze/article.toml",
            'en = "About gauze."',
            'en = ""',
            "articles/gauze/article.toml: summary.en: the text is empty (got '') – write the text, in both languages",
        ),
        (
            "articles/gauze/article.toml",
            '"museum"',
            '"rumour"',
            "articles/gauze/article.toml: source[1].standing: ",
        ),
        (
            "articles/gauze/article.toml",
            "https://example",
            "javascript:example",
            "articles/gauze/article.toml: source[1].url: the address does not begin with https://",
        ),
        ("articles/gauze/article.toml", "2026-11-27", '"soon"', "articles/gauze/article.toml: written: "),
        (
            "glossary.toml",
            'see = ["sha"]',
            'see = ["luo"]',
            "glossary.toml: word[1].see: there is no word 'luo' – correct the name, or add it to glossary.toml",
        ),
        ("glossary.toml", 'pinyin = "shā"', 'pinyn = "shā"', "glossary.toml: word[1].pinyin: missing – "),
        ("glossary.toml", 'en = "gauze"', "", "glossary.toml: word[1].en: missing – "),
    ],
)
def test_a_fault_is_told_by_file_key_and_remedy(house: Path, file: str, old: str, new: str, line: str):
    edit(house / file, old, new)
    found = told(house)
    assert any(one.startswith(line) for one in found), found


def test_a_missing_language_leaves_the_article_out(house: Path):
    (house / "articles/gauze/text.zh.md").unlink()
    assert load(house).writing.articles == ()
    assert "articles/gauze/text.zh.md: missing text – write it: every article has both languages" in told(
        house
    )


def test_what_nobody_shows_and_what_is_too_heavy_is_told(house: Path):
    home = house / "articles/gauze/media"
    (home / "left.png").write_bytes((home / "net.png").read_bytes())
    assert any(one.startswith("articles/gauze/media/left.png: the file is not used") for one in told(house))
    (home / "left.png").unlink()
    with (home / "net.png").open("ab") as picture:
        picture.write(bytes(1_100_000))
    assert any("its pictures have 1.1 MB, at most 1 MB" in one for one in told(house))


@pytest.mark.parametrize(
    "path", ["../../hall.toml", "media/../../../hall.toml", "exhibits/chest/../../hall.toml"]
)
def test_pictures_come_from_the_hall_alone(house: Path, path: str):
    edit(house / "articles/gauze/text.en.md", "media/net.png", path)
    content = load(house)
    assert "<img" not in article_html(content, content.writing.articles[0], "en", draw)


def test_a_bad_edit_keeps_the_last_good_version(house: Path):
    watcher = Watcher(house)
    edit(house / "articles/gauze/article.toml", 'en = "On gauze"', "en = 3")
    edit(house / "glossary.toml", 'group = "cloth"', 'group = "clot"')
    bad = watcher.poll()
    assert bad is not None
    assert [article.file.title.en for article in bad.writing.articles] == ["On gauze"]
    assert [word.id for word in bad.writing.words] == ["sha"]
    assert {problem.file for problem in bad.problems} == {"articles/gauze/article.toml", "glossary.toml"}
    edit(house / "articles/gauze/article.toml", "en = 3", 'en = "Of gauze"')
    good = watcher.poll()
    assert good is not None
    assert [article.file.title.en for article in good.writing.articles] == ["Of gauze"]
    shutil.rmtree(house / "articles/gauze")
    gone = watcher.poll()
    assert gone is not None
    assert gone.writing.articles == (), "what was taken away is gone"


def test_a_reference_is_words_alone_where_it_leads_nowhere(house: Path):
    edit(house / "articles/gauze/text.en.md", "word:sha", "word:none")
    content = load(house)
    html = article_html(content, content.writing.articles[0], "en", draw)
    assert "A net of yarns" in html
    assert "word:" not in html


SHIPPED = load(ASSETS).writing


def english_words(text: str) -> int:
    return len(re.findall(r"[A-Za-z0-9][\w’'-]*", words_in(text)))


def han_in(text: str) -> int:
    return len(re.findall(r"[\u4e00-\u9fff]", words_in(text)))


@pytest.mark.parametrize("article", SHIPPED.articles, ids=lambda one: one.id)
def test_a_shipped_article_is_whole_in_both_languages(article):
    assert 500 <= english_words(article.text_en) <= 950
    assert 850 <= han_in(article.text_zh) <= 1700
    assert list(pictures_in(article.text_zh)) == list(pictures_in(article.text_en))
    assert list(pictures_in(article.text_en)), "it has a picture"
    assert article.file.source
    kinds = [{kind for kind, _ in references_in(text)} for text in (article.text_zh, article.text_en)]
    assert kinds[0] == kinds[1]
    assert "word" in kinds[0]


def test_ten_articles_ship_and_most_words_are_used():
    assert len(SHIPPED.articles) >= 10
    used = {name for a in SHIPPED.articles for kind, name in references_in(a.text_zh) if kind == "word"}
    assert len(used) > len(SHIPPED.words) / 2
    assert all(re.search(r"[\u4e00-\u9fff]", word.zh) and word.pinyin.strip() for word in SHIPPED.words)
