"""The form page's HTML: a questionnaire in, a page out; every text from outside is escaped."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from html import escape
from pathlib import Path
from typing import Literal

from survey.questionnaire import TEXT_LIMIT, Item, Language, Module, Questionnaire, Text
from survey.web.form.clip import Clip, clip_html

__all__ = ["ASSETS", "Home", "Ways", "document", "form_page", "heading", "list_page", "notice_page", "words"]

Home = Callable[[Language, str | None], str]  # language and exhibit -> address of where the visitor came from


@dataclass(frozen=True)
class Ways:
    """Where a visitor goes on from the thanks. home: back to where he came from; keep: address of a page that offers
    to keep the withdrawal code, to which it is posted as `code` (with `lang`) by who asks for that. None: nowhere."""

    home: Home | None = None
    keep: str | None = None


FOLDER = Path(__file__).parent
ASSETS = {"form.css": "text/css; charset=utf-8", "form.js": "text/javascript; charset=utf-8"}


@lru_cache(maxsize=1)
def _texts() -> dict[str, dict[str, str]]:
    return tomllib.loads((FOLDER / "texts.toml").read_text("utf-8"))


def words(language: Language) -> dict[str, str]:
    """The page's own texts in a language."""
    return _texts()[language]


@lru_cache(maxsize=1)
def _stamp() -> str:
    """Changes with the style and the script, so that a browser never mixes two releases."""
    return hashlib.sha256(b"".join((FOLDER / name).read_bytes() for name in sorted(ASSETS))).hexdigest()[:12]


def form_page(
    questionnaire: Questionnaire,
    language: Language,
    exhibit: str | None,
    *,
    clip: Clip | None = None,
    preview: bool = False,
    home: str | None = None,
    keep: str | None = None,
    privacy: bool = False,
) -> str:
    """The page of one questionnaire; `exhibit` is kept with the answer, `clip` stands beside items on motion.

    home, keep: addresses as in Ways. privacy: whether there is a privacy page to name.
    preview: everything as visitors see it, but nothing is kept or sent.
    """
    say = words(language)
    modules = "".join(
        _module(questionnaire, module, number, language, clip)
        for number, module in enumerate(questionnaire.modules, 1)
    )
    title, intro = questionnaire.title.in_language(language), questionnaire.intro.in_language(language)
    body = f"""
{heading(title, intro, language, exhibit, preview)}
<noscript><p class="notice">{escape(say["noscript"])}</p></noscript>
{f'<p class="notice" id="preview">{escape(say["preview"])}</p>' if preview else ""}
<div class="progress"><div class="track"><div id="bar"></div></div><p id="count" role="status"></p></div>
<form id="form" novalidate autocomplete="off">
<div id="errors" class="notice" tabindex="-1" hidden></div>
<p id="restored" class="notice quiet" hidden><span>{escape(say["restored"])}</span>
<button type="button" id="restart" class="plain">{escape(say["restart"])}</button></p>
{modules}
{_consent(questionnaire, language, privacy)}
<div class="sending"><button type="submit" id="send" class="primary">{escape(say["send"])}</button>
<p class="small">{escape(say["saved"])}</p></div>
</form>
<div id="state" class="notice" role="status" tabindex="-1" hidden></div>
{_thanks(say, language, home, keep)}
{_withdraw(say)}
<script type="application/json" id="settings">{_settings(questionnaire, language, exhibit, preview)}</script>"""
    return document(questionnaire.title.in_language(language), language, body, script=True)


def list_page(questionnaires: Iterable[Questionnaire], language: Language) -> str:
    """All questionnaires with links."""
    say = words(language)
    named = ((found.id, escape(found.title.in_language(language))) for found in questionnaires)
    links = "".join(
        f'<li><a href="./questionnaires/{key}?lang={language}">{name}</a></li>' for key, name in named
    )
    listed = f'<ul class="list">{links}</ul>' if links else f"<p>{escape(say['list_empty'])}</p>"
    head = heading(say["list_title"], say["list_intro"], language, None)
    return document(say["list_title"], language, head + listed, script=False, base="./")


def notice_page(kind: Literal["missing", "nothing", "unavailable"], language: Language) -> str:
    """What a wrong address shows, a questionnaire of which nothing is asked here, or any while the store is away."""
    say = words(language)
    title, text = {
        "missing": (say["missing_title"], say["missing_text"]),
        "nothing": (say["nothing_title"], say["nothing_text"]),
        "unavailable": (say["unavailable_title"], say["unavailable_text"]),
    }[kind]
    return document(title, language, heading(title, text, language, None), script=False)


def document(
    title: str, language: Language, body: str, *, script: bool, base: str = "../", alone: bool = False
) -> str:
    """A whole page. base: the way from it to where style and script lie; alone: the style stands in the page."""
    stamp = _stamp()
    style = f'<link rel="stylesheet" href="{base}survey-static/form.css?v={stamp}">'
    if alone:  # what leads to another page of the service leads nowhere in a file
        style = f"<style>{(FOLDER / 'form.css').read_text('utf-8')}\n.switch {{ display: none; }}</style>"
    source = f'<script src="{base}survey-static/form.js?v={stamp}" defer></script>' if script else ""
    return f"""<!doctype html>
<html lang="{"zh-Hans" if language == "zh" else "en"}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title>
<link rel="icon" href="data:,">
{style}
{source}
</head>
<body><main>{body}
</main></body>
</html>
"""


def heading(title: str, intro: str, language: Language, exhibit: str | None, preview: bool = False) -> str:
    """The top of a page: the seal, the switch to the other language, title and introduction."""
    say, other = words(language), "en" if language == "zh" else "zh"
    kept = f"&amp;exhibit={escape(exhibit)}" if exhibit else ""
    kept += "&amp;preview" if preview else ""
    return f"""<header><div class="top"><span class="seal" aria-hidden="true">{escape(say["seal"])}</span>
<a class="switch" id="switch" href="?lang={other}{kept}" lang="{other}"
 aria-label="{escape(say["switch_label"])}">{escape(say["switch"])}</a></div>
<h1 tabindex="-1">{escape(title)}</h1>
<p class="intro">{escape(intro)}</p></header>"""


def _module(
    questionnaire: Questionnaire, module: Module, number: int, language: Language, clip: Clip | None
) -> str:
    items = "".join(_item(questionnaire, item, language) for item in questionnaire.items_of(module))
    intro = f'<p class="lead">{escape(module.intro.in_language(language))}</p>' if module.intro else ""
    title = escape(module.title.in_language(language))
    numeral = "一二三四五六七八九十"[number - 1] if language == "zh" and number <= 10 else str(number)
    return f"""<section class="module" aria-labelledby="module-{module.id}">
<h2 id="module-{module.id}"><span class="numeral" aria-hidden="true">{numeral}</span>{title}</h2>
{intro}{clip_html(clip, module, language)}{items}{_suggestion(module, language)}</section>
"""


def _suggestion(module: Module, language: Language) -> str:
    if module.suggestion is None:
        return ""
    name = f"suggestion-{module.id}"
    return f"""<div class="suggestion"><label for="{name}">{escape(module.suggestion.in_language(language))}</label>
<textarea id="{name}" data-module="{module.id}" rows="3" maxlength="{TEXT_LIMIT}"></textarea></div>
"""


def _item(questionnaire: Questionnaire, item: Item, language: Language) -> str:
    anchors = questionnaire.scale.anchors
    points = "".join(
        _point(item, str(point), str(point), anchor, language) for point, anchor in enumerate(anchors, 1)
    )
    first, last = escape(anchors[0].in_language(language)), escape(anchors[-1].in_language(language))
    points += (
        f'<p class="ends" aria-hidden="true"><span>1 {first}</span><span>{len(anchors)} {last}</span></p>'
    )
    unseen = questionnaire.scale.not_seen
    wide = _scale_kinds(anchors, unseen, language)
    if unseen:
        points += _point(item, "null", "–", unseen, language)
    hint, described = "", ""
    if item.hint:
        hint = f'<span class="hint" id="hint-{item.id}">{escape(item.hint.in_language(language))}</span>'
        described = f' aria-describedby="hint-{item.id}"'
    label = escape(item.label.in_language(language))
    return f"""<div class="item" id="item-{item.id}" data-item="{item.id}">
<div class="asked"><span class="label" id="label-{item.id}">{label}</span>{hint}</div>
<div class="answer"><div class="scale {wide}" role="radiogroup" aria-labelledby="label-{item.id}"{described}>
{points}</div>
<p class="wrong" id="wrong-{item.id}" hidden>{escape(words(language)["choose"])}</p></div></div>
"""


def _scale_kinds(anchors: list[Text], unseen: Text | None, language: Language) -> str:
    """How the scale is laid out on a phone: what does not fit into a cell of 44 px stands beneath the row."""
    kinds = [f"of-{len(anchors)}"]
    if any(len(anchor.in_language(language)) > 3 for anchor in anchors):
        kinds.append("long")
    words_apart = [] if unseen is None else unseen.in_language(language).split()
    if len(anchors) > 5 or len(words_apart) > 2 or any(len(word) > 4 for word in words_apart):
        kinds.append("apart")
    return " ".join(kinds)


def _point(item: Item, value: str, mark: str, anchor: Text, language: Language) -> str:
    kind = "point unseen" if value == "null" else "point"
    # Prefixed: a control named "hidden" or "elements" would take the place of the form's own property.
    return (
        f'<label class="{kind}"><input type="radio" name="score-{item.id}" value="{value}">'
        f'<span class="cell"><b>{mark}</b> <i>{escape(anchor.in_language(language))}</i></span></label>'
    )


def _consent(questionnaire: Questionnaire, language: Language, privacy: bool) -> str:
    say, until = words(language), questionnaire.retain_until
    kept = f'<p class="small">{escape(say["kept"].format(date=until.isoformat()))}</p>' if until else ""
    if privacy:  # in a window of its own: what was filled in stays where it is
        link = f'<a href="../privacy?lang={language}" target="_blank" rel="noopener">{escape(say["privacy"])}</a>'
        kept += f'<p class="small">{link}</p>'
    return f"""<section class="module consent" id="consent-box"><h2>{escape(say["consent_title"])}</h2>
<label class="check"><input type="checkbox" id="consent" aria-describedby="wrong-consent">
<span>{escape(questionnaire.consent.in_language(language))}</span></label>{kept}
<p class="wrong" id="wrong-consent" hidden>{escape(say["consent_missing"])}</p></section>
"""


def _thanks(say: dict[str, str], language: Language, home: str | None, keep: str | None) -> str:
    back = f'<a id="home" class="primary" href="{escape(home)}">{escape(say["home"])}</a>' if home else ""
    return f"""<section id="thanks" class="thanks" hidden>
<h2 tabindex="-1" id="thanks-title">{escape(say["thanks"])}</h2>
<p id="thanks-note" class="notice quiet" hidden></p><p>{escape(say["thanks_text"])}</p>
<p class="code"><span class="small">{escape(say["code"])}</span><output id="code"></output>
<button type="button" id="copy" class="plain">{escape(say["copy"])}</button></p>
{_keep(say, language, keep) if keep else ""}<p class="ways">{back}
<button type="button" id="again" class="plain">{escape(say["again"])}</button></p></section>
"""


def _keep(say: dict[str, str], language: Language, address: str) -> str:
    """Hands the code on by itself, in a window beside: an address would leave it in the browser's history."""
    return f"""<form method="post" action="{escape(address)}" target="_blank" rel="noopener" class="keep">
<input type="hidden" name="code" id="keep-code"><input type="hidden" name="lang" value="{language}">
<p class="small" id="keep-text">{escape(say["keep_text"])}</p>
<button class="plain" aria-describedby="keep-text">{escape(say["keep"])}</button></form>
"""


def _withdraw(say: dict[str, str]) -> str:
    return f"""<details class="withdraw"><summary>{escape(say["withdraw"])}</summary>
<form id="withdraw"><label for="withdraw-code">{escape(say["withdraw_text"])}</label>
<div class="row"><input id="withdraw-code" autocomplete="off" spellcheck="false" required
 placeholder="00000000-0000-0000-0000-000000000000">
<button type="submit" class="plain">{escape(say["withdraw_send"])}</button></div>
<p id="withdraw-state" role="status"></p></form></details>
"""


def _settings(questionnaire: Questionnaire, language: Language, exhibit: str | None, preview: bool) -> str:
    settings = {
        "id": questionnaire.id,
        "version": questionnaire.version,
        "language": language,
        "exhibit": exhibit,
        "preview": preview,
        "submissions": f"../api/v1/questionnaires/{questionnaire.id}/submissions",
        "required": [item.id for item in questionnaire.items if item.required],
        "words": words(language),
    }
    # "<" would end the script element from inside a string.
    return json.dumps(settings, ensure_ascii=False).replace("<", "\\u003c")
