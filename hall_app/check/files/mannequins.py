"""Mannequins: is it said where a figure comes from, and that it may be shown?"""

from __future__ import annotations

import re

from hall_app.content.files import walk_files
from hall_app.content.folder import Content
from hall_app.content.problems import Problem

FOLDER, NAME = "mannequins", "README.md"
LICENCE = re.compile(r"licen[cs]e|CC0|CC[ -]BY|public domain|许可|放弃权利", re.IGNORECASE)


def figure_problems(content: Content) -> list[Problem]:
    """Figures without the file that names each of them, its source and its licence."""
    figures = [path.name for path in walk_files(content.folder / FOLDER) if path.suffix == ".npz"]
    if not figures:
        return []
    file, fix = f"{FOLDER}/{NAME}", "write where each figure comes from and under which licence"
    try:
        text = (content.folder / FOLDER / NAME).read_text("utf-8-sig")
    except FileNotFoundError:
        return [
            Problem(file, "", f"missing file: nothing says whence {', '.join(figures)} may be shown", fix)
        ]
    except (OSError, UnicodeDecodeError):
        return [Problem(file, "", "the text cannot be read", "save it with the encoding UTF-8")]
    found = [Problem(file, "", f"does not name {name}", fix) for name in figures if name not in text]
    return found if LICENCE.search(text) else [*found, Problem(file, "", "names no licence", fix)]
