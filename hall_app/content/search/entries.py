"""What there is to find in a hall: each thing once in each language."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from hall_app.content.folder import Content, Exhibit
from hall_app.content.views.markdown import words_in
from hall_app.content.views.writing import page_of

KINDS = ("exhibit", "article", "activity", "word", "weave")  # in the order in which equals are listed
LANGUAGES = ("zh", "en")


@dataclass(frozen=True)
class Entry:
    """Something to find, in one language. words: what else it is called, heard as the title's equal but not shown;
    address: the page that tells of it, in that language."""

    kind: str
    id: str
    lang: str
    title: str
    words: str
    text: str
    address: str


def entries_of(content: Content, shown: Iterable[Exhibit] | None = None) -> Iterator[Entry]:
    """Exhibits (`shown`, else all), articles, words and weaves."""
    for lang in LANGUAGES:
        for exhibit in content.exhibits if shown is None else shown:
            yield _exhibit(exhibit, lang)
        for article in content.writing.articles:
            file = article.file
            text = f"{getattr(file.summary, lang)} {words_in(article.text(lang))}"
            yield _entry("article", article.id, lang, getattr(file.title, lang), "", text)
        for word in content.writing.words:
            called = f"{word.zh} {word.en} {word.pinyin} {_toneless(word.pinyin)}"
            title = f"{word.zh} {word.pinyin}" if lang == "zh" else f"{word.en} {word.zh}"
            yield _entry("word", word.id, lang, title, called, getattr(word.short, lang))
        for cloth in content.writing.cloths:
            called = f"{cloth.title_zh} {cloth.title_en} {cloth.id}"
            yield _entry(
                "weave", cloth.id, lang, cloth.title(lang), called, cloth.source if lang == "en" else ""
            )


def _exhibit(exhibit: Exhibit, lang: str) -> Entry:
    file = exhibit.file
    told = [getattr(file.caption, lang)] if file.caption else []
    told.append(words_in(exhibit.text_zh if lang == "zh" else exhibit.text_en))
    told += [
        getattr(line, lang)
        for line in (file.record.material, file.record.technique, file.record.date)
        if line
    ]
    return _entry("exhibit", exhibit.id, lang, getattr(file.title, lang), exhibit.id, " ".join(told))


def _entry(kind: str, identity: str, lang: str, title: str, words: str, text: str) -> Entry:
    return Entry(kind, identity, lang, title, words, text, page_of(kind, identity, lang))


def _toneless(pinyin: str) -> str:
    """The syllables as one word, as people type them: mǎ miàn qún → mamianqun; accents fall when it is indexed."""
    return "".join(pinyin.split())
