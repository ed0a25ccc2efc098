"""The numbers of the hall's research page, from what the benches measured; nothing is typed in but words.

python tests/bench/research_page.py      writes assets/research/numbers.json, data/ and plots/
"""

import datetime
import json
import os
import sys
from pathlib import Path

import research_plots
import signature
from research_sections import SECTIONS, Section
from research_tables import lines, sheets

ROOT = Path(__file__).parents[2]
FIGURES, HOME = ROOT / "docs" / "figures", ROOT / "assets" / "research"
NUMBERS = HOME / "numbers.json"
MACHINE = {"zh": "双核 x86-64 机器", "en": "two x86-64 cores"}  # of figures that do not tell theirs
DRAWN = {"zh": "，浏览器以软件绘制", "en": "; the browser draws in software"}
UNTOLD = {"zh": "（数据中没有记下）", "en": " (not recorded in the data)"}


def data(one: Section) -> dict[str, bytes]:
    """What can be downloaded of a section, by its place: the benches' files, and what the bakes recorded."""
    found = {f"data/{name}.json": (FIGURES / f"{name}.json").read_bytes() for name in one.files}
    for name, gathered in one.records.items():
        text = json.dumps(gathered(), ensure_ascii=False, indent=1)
        found[f"data/{name}.json"] = f"{text}\n".encode()
    return found


def machine_of(one: Section, found: list[dict]) -> dict[str, str]:
    """What the files say of the machine; what the READMEs say where any of them says nothing."""
    told = [signature.machines(figures) for figures in found]
    if told and all(told):
        each = {(m["processor"], m["cores"]): None for machines in told for m in machines}
        words = {
            "zh": "；".join(f"{name}，{cores} 核" for name, cores in each),
            "en": "; ".join(f"{name}, {cores} cores" for name, cores in each),
        }
    else:
        named = next((figures["processor"] for figures in found if "processor" in figures), None)
        beside = {"zh": f"（{named}）", "en": f" ({named})"} if named else {"zh": "", "en": ""}
        words = {lang: MACHINE[lang] + beside[lang] + UNTOLD[lang] for lang in MACHINE}
    return {lang: text + (DRAWN[lang] if one.drawn else "") for lang, text in words.items()}


def date_of(one: Section, found: list[dict], kept: dict[str, dict]) -> dict[str, str]:
    """When it was measured, as the files say; where one says nothing, since when it stands on the page.

    That day is kept for as long as the data are the same. It is not asked of git: a copy without history knows no day,
    and every merge makes another.
    """
    told = [signature.days(figures) for figures in found]
    if told and all(told):
        days = sorted(day for each in told for day in each)
        return {"dated": "measured", "date": days[-1]} | ({"since": days[0]} if days[0] != days[-1] else {})
    there = {place: HOME / place for place in data(one)}
    same = all(path.is_file() and path.read_bytes() == data(one)[place] for place, path in there.items())
    before = kept.get(one.id)
    today = datetime.date.today().isoformat()
    return {"dated": "published", "date": before["date"] if before is not None and same else today}


def numbers() -> list[dict]:
    before = json.loads(NUMBERS.read_text("utf-8"))["section"] if NUMBERS.is_file() else []
    kept, made = {one["id"]: one for one in before}, []
    for one in SECTIONS:
        found = [json.loads((FIGURES / f"{name}.json").read_text("utf-8")) for name in one.files]
        section = {
            "id": one.id,
            "title": one.title,
            "about": one.about,
            "command": list(one.commands),
            "machine": machine_of(one, found),
            **date_of(one, found, kept),
            "figure": [
                {"what": what, "value": value if isinstance(value, dict) else {"zh": value, "en": value}}
                for what, value in one.figures()
            ],
            "line": lines(one.id),
            "sheet": sheets(one.id),
            "data": list(data(one)),
        }
        if one.plot_alt:
            section |= {"plot": f"plots/{one.id}.svg", "plot_alt": one.plot_alt}
        made.append(section)
    return made


def main() -> int:
    text = json.dumps({"section": numbers()}, ensure_ascii=False, indent=1)
    (HOME / "data").mkdir(parents=True, exist_ok=True)
    (HOME / "plots").mkdir(exist_ok=True)
    for one in SECTIONS:
        for place, written in data(one).items():
            (HOME / place).write_bytes(written)
        if one.plot_alt:
            research_plots.save(one.id, HOME / "plots" / f"{one.id}.svg")
    part = HOME / ".numbers.part"
    part.write_text(text + "\n", "utf-8")
    os.replace(part, NUMBERS)
    print(f"{len(SECTIONS)} sections, {len(text) / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
