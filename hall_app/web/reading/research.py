"""The research page: what was measured, how and when; papers, methods and data to download; what visitors answered."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import Any

from hall_app.content.folder import Content
from hall_app.content.schema.research import Measured, Paper, Part, Sheet
from hall_app.content.views.writing import image_html, plot_picture
from hall_app.web.pages.frame import Frame, part
from hall_app.web.reading.culture import Pictures

__all__ = ["METHODS", "data_file", "method_file", "research_page"]

ROOT = Path(__file__).resolve().parents[3]  # of the three packages, installed or not

# name -> (README of a room, what it tells in both languages)
METHODS: dict[str, tuple[str, dict[str, str]]] = {
    "weave": (
        "sim_core/weave",
        {"zh": "织物：由组织与纱线算出布的性质", "en": "Weaving: from drafts and yarns to cloth"},
    ),
    "mesh": (
        "sim_core/mesh",
        {"zh": "网格：裁片怎样划成三角形", "en": "Meshing: panels divided into triangles"},
    ),
    "cloth": (
        "sim_core/cloth",
        {"zh": "布料模拟：垂挂、碰撞与误差", "en": "Cloth: draping, contact and errors"},
    ),
    "body": ("sim_core/body", {"zh": "人台与姿势", "en": "Figures and poses"}),
    "track": ("sim_core/track", {"zh": "动作跟踪", "en": "Tracking motion"}),
    "garment": ("sim_core/garment", {"zh": "裁片、着装与检验", "en": "Patterns, dressing and its checks"}),
    "learn": ("sim_core/learn", {"zh": "学习的布料", "en": "Learned cloth"}),
    "walk": ("hall_app/walk", {"zh": "漫游与碰撞", "en": "Walking and obstacles"}),
    "room": ("hall_app/room", {"zh": "由平面图建屋", "en": "The room, raised from its plan"}),
    "light": ("hall_app/light", {"zh": "光的计算", "en": "Light"}),
    "survey": ("survey", {"zh": "问卷与统计", "en": "Questionnaires and statistics"}),
}

_WORDS = {
    "zh": {
        "title": "研究",
        "lead": "这座展厅公布的每一个数字，都由一条命令量得。"
        "下面逐项列出数字、命令、机器、日期与原始数据，谁都可以重做。数据里没有记下日子的，写的是发布日期。",
        "contents": "本页",
        "numbers": "数字",
        "what": "量了什么",
        "value": "结果",
        "command": "命令",
        "machine": "机器",
        "measured": "量得日期",
        "published": "发布日期",
        "data": "数据",
        "all": "全部数字（{n} 行，英文，与项目说明相同）",
        "figures": "要点",
        "papers": "可读的论文",
        "papers_lead": "许可允许转载的附 PDF，其余只给出处与链接，不附原文。",
        "bib": "引文（BibTeX）",
        "methods": "方法说明",
        "methods_lead": "各部分的方法写在程序旁边，英文纯文本，可直接下载。",
        "results": "问卷结果",
        "results_lead": "满十份回答才公布平均数，此后每多十份更新一次，以免从变化中认出某一位。",
        "answers": "已公布 {n} 份回答的平均数",
        "none": "还不足十份回答，没有可公布的数字。",
        "mean": "平均",
        "withheld": "暂不公布",
        "module": "模块",
        "json": "数据（JSON）",
        "ask": "去答问卷",
        "no_survey": "这里没有问卷。",
        "empty": "还没有数字。",
        "cite": "引用本项目，见随附的 CITATION.cff。",
    },
    "en": {
        "title": "Research",
        "lead": "Every figure this hall publishes is measured by a command. Here are the figures with their commands, "
        "machines, dates and data, so that anybody can measure them again. Where the data do not tell their day, "
        "the date is that of publication.",
        "contents": "On this page",
        "numbers": "Figures",
        "what": "Measured",
        "value": "Figure",
        "command": "Command",
        "machine": "Machine",
        "measured": "Measured on",
        "published": "Published on",
        "data": "Data",
        "all": "All figures ({n} lines, as in the project's READMEs)",
        "figures": "In short",
        "papers": "Papers to read",
        "papers_lead": "Where a licence allows it a PDF is here; of all others, where to read them and no copy.",
        "bib": "Citations (BibTeX)",
        "methods": "Methods",
        "methods_lead": "Each part's method is written beside its code, as plain text in English, to download.",
        "results": "What visitors answered",
        "results_lead": "Means are published from ten answers on and move on by ten at a time, so that no change tells "
        "of anybody.",
        "answers": "Means of {n} answers",
        "none": "There are fewer than ten answers, so there is nothing to publish yet.",
        "mean": "Mean",
        "withheld": "not published yet",
        "module": "Module",
        "json": "data (JSON)",
        "ask": "Answer it",
        "no_survey": "Nothing is asked here.",
        "empty": "There are no figures yet.",
        "cite": "To cite this project, see its CITATION.cff.",
    },
}


def research_page(content: Content, lang: str, pictures: Pictures, results: Iterable[dict[str, Any]]) -> str:
    """The whole page. results: of each questionnaire its title and what everybody may see (survey's public results)."""
    words, frame = _WORDS[lang], Frame(content.hall, lang, "research", "/research")
    sections = content.writing.numbers
    ways = "".join(f'<a href="#{one.id}">{escape(getattr(one.title, lang))}</a>' for one in sections)
    ways += "".join(f'<a href="#{key}">{words[key]}</a>' for key in ("results", "papers", "methods"))
    measured = (
        "".join(_measured(content, one, lang, pictures) for one in sections) or f"<p>{words['empty']}</p>"
    )
    return frame.page(
        words["title"],
        f"""<header><h1>{words["title"]}</h1><p class="lead">{words["lead"]}</p>
<nav class="letters" aria-label="{words["contents"]}">{ways}</nav></header>{measured}
{_results(list(results), lang)}{_papers(content.writing.papers, lang)}{_methods(lang)}""",
    )


def _measured(content: Content, one: Measured, lang: str, pictures: Pictures) -> str:
    words = _WORDS[lang]
    rows = "".join(
        f'<tr><th scope="row">{escape(getattr(f.what, lang))}</th><td>{escape(getattr(f.value, lang))}</td></tr>'
        for f in one.figure
    )
    commands = "<br>".join(f"<code>{escape(command)}</code>" for command in one.command)
    files = ", ".join(
        f'<a href="/research/{escape(path)}">{escape(Path(path).name)}</a>' for path in one.data
    )
    facts = [("command", commands), ("machine", escape(getattr(one.machine, lang)))]
    facts += [(one.dated, _days(one)), ("data", files)]
    how = "".join(f"<dt>{words[key]}</dt><dd>{value}</dd>" for key, value in facts if value)
    inside = f"""<p>{escape(getattr(one.about, lang))}</p>
<table class="numbers"><caption class="unseen">{words["figures"]}</caption>
<thead><tr><th scope="col">{words["what"]}</th>
<th scope="col">{words["value"]}</th></tr></thead><tbody>{rows}</tbody></table>
{_plot(content, one, lang, pictures)}<dl class="how">{how}</dl>{_all(one, lang)}"""
    return part(escape(one.id), escape(getattr(one.title, lang)), inside, style="measured")


def _days(one: Measured) -> str:
    """The day, or the first and the last of several."""
    days = [one.date] if one.since is None else [one.since, one.date]
    return " – ".join(f'<time datetime="{day}">{day}</time>' for day in days)


def _plot(content: Content, one: Measured, lang: str, pictures: Pictures) -> str:
    url = plot_picture(content, one.plot) if one.plot else None
    if url is None or one.plot_alt is None:
        return ""
    alt = escape(getattr(one.plot_alt, lang))
    return f"<figure>{image_html(url, alt, pictures.size_of(url))}<figcaption>{alt}</figcaption></figure>"


def _all(one: Measured, lang: str) -> str:
    """Every row that the READMEs publish, folded."""
    count = len(one.line) + sum(len(part.row) for sheet in one.sheet for part in sheet.part)
    if not count:
        return ""
    lines = Part(
        text="",
        head=("Measured", "Figure", "Command"),
        row=tuple((line.what, line.value, line.command) for line in one.line),
    )
    inside = _table(lines, "README.md") if one.line else ""
    inside += "".join(map(_sheet, one.sheet))
    return f"""<details><summary>{_WORDS[lang]["all"].format(n=count)}</summary>
<div lang="en">{inside}</div></details>"""


def _sheet(one: Sheet) -> str:
    parts = "".join(
        _table(part, one.file) if part.head else f"<p>{escape(part.text)}</p>" for part in one.part
    )
    return f"<h3>{escape(one.file)}</h3><p><code>{escape(one.command)}</code></p>{parts}"


def _table(one: Part, name: str) -> str:
    """A table that scrolls by itself where the page is narrower. A blank is no heading."""
    head = "".join(f'<th scope="col">{escape(cell)}</th>' if cell else "<td></td>" for cell in one.head)
    rows = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in one.row)
    return f"""<div class="wide" role="group" tabindex="0" aria-label="{escape(name)}"><table class="numbers">
<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"""


def _results(results: list[dict[str, Any]], lang: str) -> str:
    words = _WORDS[lang]
    parts = "".join(_result(one, lang) for one in results) or f"<p>{words['no_survey']}</p>"
    return part("results", words["results"], f"<p>{words['results_lead']}</p>{parts}", style="measured")


def _result(one: dict[str, Any], lang: str) -> str:
    words, key = _WORDS[lang], escape(one["questionnaire"])
    links = f"""<p class="doors"><a href="/questionnaires/{key}?lang={lang}">{words["ask"]}</a>
<a href="/api/v1/questionnaires/{key}/results">{words["json"]}</a></p>"""
    title = f"<h3>{escape(one['title'][lang])}</h3>"
    if not one["modules"]:
        return f"{title}<p>{words['none']}</p>{links}"
    rows = "".join(
        f'<tr><th scope="row">{escape(m["label"][lang])}</th>'
        f"<td>{_mean(m, lang)}</td><td>{_bar(m, one['points'])}</td></tr>"
        for m in one["modules"]
    )
    caption = words["answers"].format(n=one["n"])
    return f"""{title}<table class="numbers"><caption>{caption}</caption>
<thead><tr><th scope="col">{words["module"]}</th><th scope="col">{words["mean"]} / {one["points"]}</th>
<td></td></tr></thead><tbody>{rows}</tbody></table>{links}"""


def _mean(module: dict[str, Any], lang: str) -> str:
    if module["mean"] is None:
        return _WORDS[lang]["withheld"]
    return f"{module['mean']:.{module['decimals']}f}"


def _bar(module: dict[str, Any], points: int) -> str:
    if module["mean"] is None:
        return ""
    return f'<span class="bar" style="width:{module["mean"] / points * 100:.0f}%"></span>'


def _papers(papers: tuple[Paper, ...], lang: str) -> str:
    words = _WORDS[lang]
    lines = "".join(_paper(paper, lang) for paper in papers)
    cited = any(paper.cite is not None for paper in papers)
    bib = f'<p class="doors"><a href="/research/papers.bib">{words["bib"]}</a></p>' if cited else ""
    inside = f"""<p>{words["papers_lead"]}</p><ul class="sources">{lines}</ul>{bib}<p>{words["cite"]}</p>"""
    return part("papers", words["papers"], inside, style="measured")


def _paper(paper: Paper, lang: str) -> str:
    title, where, about = (escape(getattr(told, lang)) for told in (paper.title, paper.where, paper.about))
    address = escape(paper.url or (f"/research/{paper.file}" if paper.file else ""))
    way = f'<a href="{address}" rel="noopener noreferrer">{title}</a>' if address else f"<b>{title}</b>"
    return f"<li>{way}<br>{where}<br>{about}</li>"


def _methods(lang: str) -> str:
    words = _WORDS[lang]
    lines = "".join(
        f'<li><a href="/research/methods/{name}.md">{told[lang]}</a></li>'
        for name, (_, told) in METHODS.items()
        if method_file(name) is not None
    )
    inside = f'<p>{words["methods_lead"]}</p><ul class="sources">{lines}</ul>'
    return part("methods", words["methods"], inside, style="measured")


def method_file(name: str) -> Path | None:
    """The README of a method, None where there is none of that name."""
    found = ROOT / METHODS[name][0] / "README.md" if name in METHODS else None
    return found if found is not None and found.is_file() else None


def data_file(content: Content, path: str) -> Path | None:
    """A bench's data or a paper, by the path its table names; None for anything else."""
    named = {file for one in content.writing.numbers for file in one.data}
    named |= {paper.file for paper in content.writing.papers if paper.file is not None}
    home = content.folder / "research"
    full = (home / path).resolve() if path in named else home
    return full if full.is_relative_to(home.resolve()) and full.is_file() else None
