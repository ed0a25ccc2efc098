"""The glossary by groups, and the weaves of the hall with what their files say."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from hall_app.content.folder import Article, Cloth, Content
from hall_app.content.schema.glossary import Word
from hall_app.content.views.writing import articles_on, image_html, page_of, weave_picture
from hall_app.web.pages.frame import Frame, other_language, part
from hall_app.web.reading.culture import Pictures

MOST = 3  # articles named below a word; the search finds the others

__all__ = ["GROUPS", "glossary_page", "weaves_page"]

GROUPS = {
    "zh": {
        "cloth": "织物",
        "making": "织造与裁制",
        "garment": "衣裳",
        "part": "部位",
        "wearing": "穿着",
        "hall": "本馆用语",
    },
    "en": {
        "cloth": "Cloth",
        "making": "Weaving and cutting",
        "garment": "Garments",
        "part": "Parts of a garment",
        "wearing": "Wearing",
        "hall": "Words of this hall",
    },
}
DRAFTS = {
    "zh": {
        "plain": "平纹",
        "twill": "斜纹",
        "satin": "缎纹",
        "damask": "暗花",
        "leno": "绞经",
        "compound": "重组织",
        "tapestry": "通经断纬",
        "brocade": "挖梭加纬",
        "lift": "逐纬写出",
    },
    "en": {
        "plain": "tabby",
        "twill": "twill",
        "satin": "satin",
        "damask": "damask",
        "leno": "crossing ends",
        "compound": "compound",
        "tapestry": "tapestry",
        "brocade": "brocaded",
        "lift": "written out",
    },
}
_WORDS = {
    "zh": {
        "glossary": "词语表",
        "words": "文章里的行话，一词一两句。文章中带点线的词，指向这里。",
        "weaves": "织物",
        "cloths": "展厅所用与所备的织物，由组织、经纬密与纱线算出。"
        "左图是花纹或整块布，右图是放大的纱线（宽 2.2 毫米）。"
        "经纬密与纱线多为通行范围内的假设，各条出处写明何者有据。",
        "kicker": "服饰文化",
        "groups": "分组",
        "see": "参看",
        "told": "见于",
        "source": "出处与假设",
        "sett": "每厘米经 {ends:.0f} 根、纬 {picks:.0f} 根",
        "picture": "{title}：左为布面，右为放大的纱线",
        "empty": "还没有词语。",
        "none": "还没有织物。",
    },
    "en": {
        "glossary": "Glossary",
        "words": "The words of the craft that the articles use, a sentence or two each. Words with a dotted line "
        "lead here.",
        "weaves": "Weaves",
        "cloths": "The cloths that the hall wears and keeps, computed from their weave, their sett and their yarns. On "
        "the left the figure or the whole cloth, on the right its yarns, 2.2 mm wide. Setts and yarns are mostly "
        "assumptions in the usual range; each line tells what it rests on.",
        "kicker": "Culture of dress",
        "groups": "Groups",
        "see": "Compare",
        "told": "See",
        "source": "Source and assumptions",
        "sett": "{ends:.0f} ends and {picks:.0f} picks a centimetre",
        "picture": "{title}: on the left the cloth, on the right its yarns from near",
        "empty": "There are no words yet.",
        "none": "There are no weaves yet.",
    },
}


def glossary_page(content: Content, lang: str) -> str:
    """All words, by groups."""
    words, frame = _WORDS[lang], Frame(content.hall, lang, "glossary", "/culture/glossary")
    parts, ways = [], []
    for group, name in GROUPS[lang].items():
        listed = [word for word in content.writing.words if word.group == group]
        if listed:
            ways.append(f'<a href="#group-{group}">{name}</a>')
            entries = "".join(_word(content, word, lang) for word in listed)
            parts.append(part(f"group-{group}", name, f'<dl class="words">{entries}</dl>'))
    shown = "".join(parts) or f"<p>{words['empty']}</p>"
    return frame.page(
        words["glossary"],
        f"""<header><p class="kicker">{words["kicker"]}</p><h1>{words["glossary"]}</h1>
<p class="lead">{words["words"]}</p>
<nav class="letters" aria-label="{words["groups"]}">{"".join(ways)}</nav></header>{shown}""",
    )


def _word(content: Content, word: Word, lang: str) -> str:
    other = other_language(lang)
    first, second = (word.zh, word.en) if lang == "zh" else (word.en, word.zh)
    there = content.writing
    compared = [
        (page_of("word", one.id, lang), _called(one, lang)) for n in word.see if (one := there.word(n))
    ]
    told = [
        (page_of("exhibit", n, lang), getattr(one.file.title, lang))
        for n in word.exhibits
        if (one := content.exhibit(n))
    ]
    told += [(page_of("weave", n, lang), one.title(lang)) for n in word.weaves if (one := there.cloth(n))]
    told += _articles(articles_on(content, "word", word.id)[:MOST], lang)
    below = _ways("see", compared, lang) + _ways("told", told, lang)
    return f"""<div id="word-{word.id}"><dt>{escape(first)}<span lang="{other}">{escape(second)}</span>
<span>{escape(word.pinyin)}</span></dt>
<dd>{escape(getattr(word.short, lang))}</dd>{below}</div>"""


def _called(word: Word, lang: str) -> str:
    return word.zh if lang == "zh" else word.en


def _articles(articles: Iterable[Article], lang: str) -> list[tuple[str, str]]:
    return [(page_of("article", one.id, lang), getattr(one.file.title, lang)) for one in articles]


def _ways(key: str, ways: list[tuple[str, str]], lang: str, tag: str = "dd") -> str:
    if not ways:
        return ""
    mark = "、" if lang == "zh" else ", "
    links = mark.join(f'<a href="{address}">{escape(name)}</a>' for address, name in ways)
    colon = "：" if lang == "zh" else ": "
    return f'<{tag} class="ways">{_WORDS[lang][key]}{colon}{links}</{tag}>'


def weaves_page(content: Content, lang: str, pictures: Pictures) -> str:
    """All weaves of the hall."""
    words, frame = _WORDS[lang], Frame(content.hall, lang, "weaves", "/culture/weaves")
    listed = "".join(_weave(content, cloth, lang, pictures) for cloth in content.writing.cloths)
    shown = f'<ul class="weaves">{listed}</ul>' if listed else f"<p>{words['none']}</p>"
    return frame.page(
        words["weaves"],
        f"""<header><p class="kicker">{words["kicker"]}</p><h1>{words["weaves"]}</h1>
<p class="lead">{words["cloths"]}</p></header>{shown}""",
    )


def _weave(content: Content, cloth: Cloth, lang: str, pictures: Pictures) -> str:
    words, other = _WORDS[lang], other_language(lang)
    url, title = weave_picture(content, cloth.id), escape(cloth.title(lang))
    picture = image_html(url, words["picture"].format(title=title), pictures.size_of(url)) if url else ""
    kind = DRAFTS[lang].get(cloth.kind, escape(cloth.kind))
    sett = words["sett"].format(ends=cloth.ends / 100, picks=cloth.picks / 100)
    told = _ways("told", _articles(articles_on(content, "weave", cloth.id), lang), lang, "p")
    colon = "：" if lang == "zh" else ": "
    source = f'{words["source"]}{colon}<span lang="en">{escape(cloth.source)}</span>' if cloth.source else ""
    return f"""<li id="weave-{cloth.id}"><h2>{title}</h2>
<p class="second" lang="{other}">{escape(cloth.title(other))}</p>{picture}
<p>{kind} · {sett}</p><p class="quiet">{source}</p>{told}</li>"""
