"""The numbers of the hall's research page, from what the benches measured; nothing is typed in but words.

python tests/bench/research_page.py      writes assets/research/numbers.json, data/ and plots/
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import readme_figures as front
import readme_survey
import readme_weave
import research_plots
from research_sections import SECTIONS

ROOT = Path(__file__).parents[2]
FIGURES, HOME = ROOT / "docs" / "figures", ROOT / "assets" / "research"
MACHINE = {
    "zh": "双核 x86-64 机器，浏览器以软件绘制",
    "en": "two x86-64 cores; the browser draws in software",
}


def date_of(names: list[str]) -> str:
    """The day on which the last of the files was committed: when it was measured, or a little after."""
    paths = [f"docs/figures/{name}.json" for name in names]
    told = subprocess.run(
        ("git", "log", "-1", "--format=%cs", "--", *paths),
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return told.stdout.strip()


def machine_of(names: list[str]) -> dict[str, str]:
    """What the files say of the processor, beside what holds for all of them."""
    told = (json.loads((FIGURES / f"{name}.json").read_text("utf-8")) for name in names)
    found = [one["processor"] for one in told if isinstance(one, dict) and "processor" in one]
    more = f" ({found[0]})" if found else ""
    return {lang: words + more for lang, words in MACHINE.items()}


def lines_of(section: str) -> list[tuple[str, str, str]]:
    """What the READMEs publish of it: (what, figure, command)."""
    survey = "`survey bench`"
    made = {
        "walking": front.walking,
        "crowd": front.crowd,
        "page": front.page,
        "look": front.look,
        "mesh": front.mesh_figures.summary,
        "light": front.room,
        "garments": front.garments,
        "weave": lambda: [
            (what, value, "`simcore bench weave`")
            for what, _, value in readme_weave.rows(json.loads((FIGURES / "weave.json").read_text("utf-8")))
        ],
        "survey": lambda: [
            (what, value, survey)
            for part in (readme_survey.service, readme_survey.analysis, readme_survey.beside_r)
            for what, value, _ in part()
        ],
    }
    return made[section]() if section in made else []


def plain(text: str) -> str:
    """Markdown's marks taken off."""
    return text.replace("**", "").replace("`", "")


def numbers() -> list[dict]:
    found = []
    for one in SECTIONS:
        figures = [
            {"what": what, "value": value if isinstance(value, dict) else {"zh": value, "en": value}}
            for what, value in one.figures()
        ]
        section = {
            "id": one.id,
            "title": one.title,
            "about": one.about,
            "command": list(one.commands),
            "machine": machine_of(one.files),
            "date": date_of(one.files) if one.files else one.date(),
            "figure": figures,
            "line": [
                dict(zip(("what", "value", "command"), map(plain, row), strict=True))
                for row in lines_of(one.id)
            ],
            "data": [f"data/{name}.json" for name in one.files],
        }
        if one.plot_alt:
            section |= {"plot": f"plots/{one.id}.svg", "plot_alt": one.plot_alt}
        found.append(section)
    return found


def main() -> int:
    (HOME / "data").mkdir(parents=True, exist_ok=True)
    (HOME / "plots").mkdir(exist_ok=True)
    for name in sorted({name for one in SECTIONS for name in one.files}):
        shutil.copyfile(FIGURES / f"{name}.json", HOME / "data" / f"{name}.json")
    for one in SECTIONS:
        if one.plot_alt:
            research_plots.save(one.id, HOME / "plots" / f"{one.id}.svg")
    text = json.dumps({"section": numbers()}, ensure_ascii=False, indent=1)
    part = HOME / ".numbers.part"
    part.write_text(text + "\n", "utf-8")
    os.replace(part, HOME / "numbers.json")
    print(f"{len(SECTIONS)} sections, {len(text) / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
