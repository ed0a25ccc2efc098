"""The draft as a visitor would see it, before anybody does."""

from __future__ import annotations

from html import escape
from typing import Any

from hall_app.check import likeness_of
from hall_app.content.folder import Exhibit
from hall_app.content.loading import load
from hall_app.content.models.glb import GlbError, read_glb
from hall_app.content.problems import ContentError
from hall_app.content.schema.exhibit import Record
from hall_app.content.views.markdown import html_of
from hall_app.house.people import PeopleError
from hall_app.web.platform.counter import Asking, Shown
from hall_app.web.platform.office.collection.desk import Desk, listed_problems, publish_form, refusal
from hall_app.web.platform.office.collection.files import TURN, drawn_model, file_address, shown_medium
from hall_app.web.platform.office.collection.words import WORDS
from hall_app.web.platform.office.table import office_page

__all__ = ["Previews"]


class Previews:
    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def told(self, asking: Asking) -> dict[str, Any]:
        key = self._desk.key(asking)
        exhibit = self._exhibit(key)
        return {
            "id": key,
            "whole": exhibit is not None,
            "title": exhibit.file.title.as_json() if exhibit else None,
            "problems": [one.as_json() for one in self._desk.problems(key)],
        }

    def _exhibit(self, key: str) -> Exhibit | None:
        """As the hall would read it; None where it could not. Its files are the draft's, not those of its folder."""
        drafts = self._desk.drafts
        try:
            if drafts.of(key) is None:
                return load(drafts.content).exhibit(key)
            with likeness_of(drafts.content, drafts.changes(key)) as whole:
                return load(whole).exhibit(key)
        except ContentError:
            return None

    def page(self, asking: Asking) -> Shown:
        desk, key, word = self._desk, self._desk.key(asking), asking.word
        exhibit, at = self._exhibit(key), f"/office/collection/{key}"
        wrong = listed_problems(asking, desk.problems(key))
        deeds = f'<a class="way" href="{asking.address(at)}">{word("回到展品", "Back to the exhibit")}</a>'
        if desk.drafts.of(key) is not None and asking.person.may("publish"):
            deeds = publish_form(desk, asking, key) + deeds
        title = f"{word('预览', 'Preview')} · {desk.title(key, asking.lang)}"
        if exhibit is None:
            told = word("这份草稿还不能展出。", "This draft cannot be shown yet.")
            shown = f"<p>{told}</p>"
        else:
            shown = _shown(asking, desk, exhibit)
        inside = f'{refusal(asking)}<div class="state"><div class="deeds">{deeds}</div>{wrong}</div>{shown}'
        return office_page(asking, title, inside, path=f"collection/{key}/preview", script=TURN)


def _shown(asking: Asking, desk: Desk, exhibit: Exhibit) -> str:
    """Title, text, media, record and models, of both languages the one that is read."""
    file, lang, word = exhibit.file, asking.lang, asking.word
    text = exhibit.text_zh if lang == "zh" else exhibit.text_en
    prose = html_of(text, lambda path: file_address(asking, exhibit.id, path).replace("&amp;", "&"))
    media = "".join(
        f"<figure>{shown_medium(asking, exhibit.id, one.model_dump(), list(one.sources))}"
        f"<figcaption>{escape(getattr(one.caption, lang)) if one.caption else ''}</figcaption></figure>"
        for one in file.media
    )
    record = "".join(
        f"<dt>{escape(word(*WORDS[f'record.{name}']))}</dt><dd>{escape(getattr(value, lang))}</dd>"
        for name in Record.model_fields
        if name != "line" and (value := getattr(file.record, name)) is not None
    )
    record += "".join(
        f"<dt>{escape(getattr(one.label, lang))}</dt><dd>{escape(getattr(one.value, lang))}</dd>"
        for one in file.record.line
    )
    caption = f'<p class="lead">{escape(getattr(file.caption, lang))}</p>' if file.caption else ""
    return f"""<article class="preview"><h2>{escape(getattr(file.title, lang))}</h2>{caption}
<div class="prose">{prose}</div><div class="gallery">{media}</div>{_models(asking, desk, exhibit)}
<dl class="how">{record}</dl><p class="quiet">{word("许可", "Licence")}: {escape(file.licence)}</p></article>"""


def _models(asking: Asking, desk: Desk, exhibit: Exhibit) -> str:
    """What is known of its models; they are drawn by the hall."""
    models, lines = exhibit.file.models, []
    for name in (models.hall, models.close) if models else ():
        if name is None:
            continue
        try:
            info = read_glb(desk.drafts.path(exhibit.id, name))
        except (GlbError, OSError, PeopleError):
            continue
        size = " × ".join(f"{high - low:.2f}" for low, high in zip(info.low, info.high, strict=True))
        triangles = asking.word(f"{info.triangles} 个三角形", f"{info.triangles} triangles")
        lines.append(drawn_model(asking, exhibit.id, name, f'<p class="quiet">{triangles} · {size} m</p>'))
    if (scan := exhibit.file.scan) is not None:
        lines.append(drawn_model(asking, exhibit.id, scan))
    return f'<div class="gallery">{"".join(lines)}</div>' if lines else ""
