"""The tables that the READMEs publish, as the research page holds them: every row, with the command for it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cloth_peer_tables as peers
import mesh_figures
import readme_cloth
import readme_figures as front
import readme_learn
import readme_survey
import readme_weave

ROOT = Path(__file__).parents[2]
CLOTH, BESIDE = "simcore bench cloth", "simcore bench cloth -- --peers"

# section -> its rows of the project's README
LINES: dict[str, Callable[[], list[tuple[str, str, str]]]] = {
    "walking": front.walking,
    "crowd": front.crowd,
    "page": front.page,
    "look": front.look,
    "garments": lambda: front.garments() + front.robe(),
    "scan": front.scans,
    "mesh": mesh_figures.summary,
    "light": front.room,
}


@dataclass(frozen=True)
class Sheet:
    """What a README's figures are, in Markdown, and how they are measured again."""

    file: str
    command: str
    text: Callable[[], str]


def standing(file: str, mark: str) -> Callable[[], str]:
    """What stands after a mark: of benches that write their rows there case by case and keep no file."""

    def text() -> str:
        begun = (ROOT / file).read_text("utf-8").split(f"<!-- {mark}")[1]
        return begun.split("-->", 1)[1].split("<!--")[0]

    return text


def figures(name: str):
    return json.loads((ROOT / f"docs/figures/{name}.json").read_text("utf-8"))


ROOM, DETAILS = "sim_core/cloth/README.md", "sim_core/cloth/DETAILS.md"
SHEETS: dict[str, tuple[Sheet, ...]] = {
    "weave": (
        Sheet(
            "sim_core/weave/README.md", "simcore bench weave", lambda: readme_weave.table(figures("weave"))
        ),
    ),
    "mesh": (
        Sheet("sim_core/mesh/README.md", "simcore bench mesh -- --peers --large", mesh_figures.details),
    ),
    "cloth": (
        Sheet(ROOM, CLOTH, lambda: readme_cloth.headline(readme_cloth.figures())),
        Sheet(ROOM, BESIDE, lambda: peers.short(peers.measured())),
        Sheet(ROOM, "python tests/bench/cloth_hard.py", standing(ROOM, "hard cases")),
        Sheet(DETAILS, CLOTH, lambda: readme_cloth.tables(readme_cloth.figures())),
        Sheet(DETAILS, BESIDE, lambda: peers.tables(peers.measured(published=False))),
        Sheet(
            "tests/bench/cloth_peers/README.md", BESIDE, lambda: peers.tables(peers.measured(published=True))
        ),
        Sheet(
            DETAILS,
            "python tests/bench/cloth_cantilever.py",
            standing(DETAILS, "cantilever"),
        ),
        Sheet(DETAILS, "python tests/bench/cloth_table.py", standing(DETAILS, "fidelity")),
    ),
    "learn": (
        Sheet(
            "sim_core/learn/README.md",
            "python tests/bench/bench_learn.py FOLDER",
            lambda: "\n".join(readme_learn.tables(figures("learn"))),
        ),
    ),
    "survey": (Sheet("survey/README.md", "survey bench", readme_survey.table),),
}


def lines(section: str) -> list[dict[str, str]]:
    """Its rows of the project's README."""
    rows = LINES[section]() if section in LINES else []
    return [dict(zip(("what", "value", "command"), map(plain, row), strict=True)) for row in rows]


def sheets(section: str) -> list[dict]:
    """Its tables in the READMEs of the rooms."""
    return [
        {"file": one.file, "command": one.command, "part": parts(one.text())}
        for one in SHEETS.get(section, ())
    ]


def plain(text: str) -> str:
    """Markdown's marks taken off."""
    return text.replace("**", "").replace("`", "")


def cells(line: str) -> list[str]:
    """Of a row of a table."""
    return [plain(cell.strip()) for cell in line.strip()[1:-1].split("|")]


def parts(text: str) -> list[dict]:
    """Tables and the words between them, in their order."""
    blocks: list[list[str]] = [[]]
    for line in text.splitlines():
        last = blocks[-1]
        other = last and line.startswith("|") != last[0].startswith("|")
        if not line.strip() or line.startswith("- ") or other:
            blocks.append([])
        if line.strip():
            blocks[-1].append(line.strip())
    return [
        {"head": cells(block[0]), "row": [cells(row) for row in block[2:]]}
        if block[0].startswith("|")
        else {"text": plain(" ".join(block)).removeprefix("- ")}
        for block in blocks
        if block
    ]
