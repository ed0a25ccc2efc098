"""The pages to read: one head and foot, one h1, headings without a gap, links that lead somewhere, both languages."""

from __future__ import annotations

import json
import re
import urllib.error
import urllib.request
from html.parser import HTMLParser
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = ("/culture", "/culture/glossary", "/culture/weaves", "/research", "/search?q=纱", "/catalogue")


class Page(HTMLParser):
    """Headings, ids, links, pictures and terms of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.levels: list[int] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self.described: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs) -> None:
        given = dict(attrs)
        if re.fullmatch("h[1-6]", tag):
            self.levels.append(int(tag[1]))
        if "id" in given:
            self.ids.append(given["id"])
        if tag in ("a", "img") and (address := given.get("href", given.get("src"))):
            self.links.append(address)
        if "aria-describedby" in given:
            self.described.append(given["aria-describedby"])


def got(url: str) -> bytes:
    with urllib.request.urlopen(urllib.parse.quote(url, safe=":/?=&#%"), timeout=60) as answer:
        return answer.read()


def page_of(hall, path: str, lang: str) -> Page:
    mark = "&" if "?" in path else "?"
    return Page(got(f"{hall.url}{path}{mark}lang={lang}").decode())


def articles() -> list[str]:
    return sorted(path.parent.name for path in (ROOT / "assets/articles").glob("*/article.toml"))


@pytest.mark.parametrize("lang", ["zh", "en"])
@pytest.mark.parametrize("path", [*PAGES, *(f"/culture/{name}" for name in articles())])
def test_a_page_is_in_order(shipped_hall, path: str, lang: str):
    page = page_of(shipped_hall, path, lang)
    assert page.levels.count(1) == 1
    assert all(after <= before + 1 for before, after in zip(page.levels, page.levels[1:], strict=False))
    assert len(page.ids) == len(set(page.ids))
    assert set(page.described) <= set(page.ids), "what describes a word is on the page"
    other = "en" if lang == "zh" else "zh"
    assert any(link.endswith(f"lang={other}") for link in page.links), "a way to the other language"
    for way in ("/culture", "/culture/glossary", "/research", "/catalogue", "/questionnaires"):
        assert f"{way}?lang={lang}" in page.links


def test_every_link_within_leads_somewhere(shipped_hall):
    """From all pages: addresses are there, and so is the place on the page that they name."""
    pages: dict[str, Page] = {}
    for path in (*PAGES, *(f"/culture/{name}" for name in articles())):
        pages[path] = page_of(shipped_hall, path, "en")
    seen: dict[str, set[str]] = {}
    for page in pages.values():
        for link in page.links:
            address, _, place = link.partition("#")
            if address.startswith("/") and not address.startswith("/?"):
                seen.setdefault(address, set()).add(place)
    for address, places in sorted(seen.items()):
        body = got(shipped_hall.url + address)
        if places - {""}:
            assert places - {""} <= set(Page(body.decode()).ids), address


def test_a_page_that_is_not_there_says_so_and_leads_on(shipped_hall):
    with pytest.raises(urllib.error.HTTPError) as lost:
        got(f"{shipped_hall.url}/culture/nothing?lang=en")
    with lost.value as answer:
        assert answer.code == 404
        assert 'href="/culture?lang=en"' in answer.read().decode()


@pytest.mark.parametrize(("lang", "title"), [("zh", "没有这一页"), ("en", "There is no such page")])
@pytest.mark.parametrize("path", ["nothing", "culture/glossary/nothing", "research/nothing", "media/nothing"])
def test_an_address_without_anything_is_a_page_to_a_reader_and_json_to_a_program(
    shipped_hall, path: str, lang: str, title: str
):
    address = f"{shipped_hall.url}/{path}?lang={lang}"
    found = {}
    for kind in ("text/html,*/*;q=0.8", "application/json"):
        with pytest.raises(urllib.error.HTTPError) as lost:
            urllib.request.urlopen(urllib.request.Request(address, headers={"Accept": kind}), timeout=60)
        with lost.value as answer:
            assert answer.code == 404
            found[answer.headers["content-type"].partition(";")[0]] = answer.read().decode()
    assert f"<h1>{title}</h1>" in found["text/html"]
    assert f'href="/catalogue?lang={lang}"' in found["text/html"]
    assert set(json.loads(found["application/json"])) == {"detail"}


@pytest.mark.parametrize(
    "path",
    [
        "media/articles/this-hall/article.toml",
        "media/articles/this-hall/%2e%2e/%2e%2e/hall.toml",
        "media/weaves/luo.toml",
        "media/research/numbers.json",
        "research/numbers.json",
        "research/data/%2e%2e/papers.toml",
        "research/methods/%2e%2e%2fREADME.md",
        "research/methods/secret.md",
    ],
)
def test_files_that_are_not_for_visitors_stay_where_they_are(shipped_hall, path: str):
    with pytest.raises(urllib.error.HTTPError) as refused:
        got(f"{shipped_hall.url}/{path}")
    with refused.value as answer:
        assert answer.code == 404
