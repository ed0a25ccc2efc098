"""Words for everybody: descriptions of media, texts without HTML, pictures in texts that exist."""

from __future__ import annotations

from hall_app.content.files import TEXTS, shortened
from hall_app.content.folder import Content, Exhibit
from hall_app.content.problems import Problem
from hall_app.content.schema.exhibit import ExhibitFile
from hall_app.content.views.markdown import pictures_in, raw_html_in
from hall_app.content.views.scene import own_picture


def word_problems(content: Content) -> list[Problem]:
    """Missing alt texts and transcripts; HTML and foreign pictures in texts."""
    found = []
    for exhibit in content.exhibits:
        found += _media_words(exhibit.toml, exhibit.file)
        found += _text_words(exhibit)
    return found


def _media_words(toml: str, file: ExhibitFile) -> list[Problem]:
    found = []
    for number, medium in enumerate(file.media, 1):
        key, example = f"media[{number}]", '{ zh = "…", en = "…" }'
        if medium.kind == "picture" and medium.alt is None:
            what = "the picture has no description for visitors who cannot see it"
            found.append(Problem(toml, f"{key}.alt", what, f"add alt = {example}"))
        if medium.kind == "video" and medium.alt is None and medium.transcript is None:
            what = "the video has neither description nor transcript"
            found.append(Problem(toml, f"{key}.alt", what, f"add alt = {example} or transcript = {example}"))
        if medium.kind == "audio" and medium.transcript is None:
            what = "the audio has no transcript for visitors who cannot hear it"
            found.append(Problem(toml, f"{key}.transcript", what, f"add transcript = {example}"))
    return found


def _text_words(exhibit: Exhibit) -> list[Problem]:
    found = []
    for language, text in (("zh", exhibit.text_zh), ("en", exhibit.text_en)):
        name = f"exhibits/{exhibit.id}/{TEXTS[language]}"
        if tag := raw_html_in(text):
            what = f"HTML is not read, {tag} is shown as letters"
            found.append(Problem(name, "", what, "remove the tag and use Markdown"))
        for path in pictures_in(text):
            if own_picture(exhibit, path) is None:
                what = f"the picture {shortened(path)} is not in the exhibit's folder and is left out"
                found.append(Problem(name, "", what, "copy it to media/ and write media/…"))
    return found
