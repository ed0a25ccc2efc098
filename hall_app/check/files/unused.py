"""Files nobody names: leftovers that only make the folder heavier, or a misspelt name."""

from __future__ import annotations

import posixpath

from hall_app.content.bakes.inputs import scan_files
from hall_app.content.files import (
    BAKED,
    SHEET,
    TEXTS,
    exhibit_files,
    hall_files,
    plan_files,
    tracked_beside,
    walk_files,
)
from hall_app.content.folder import Content, Exhibit
from hall_app.content.problems import Problem
from hall_app.content.schema.plan import PAINTED
from hall_app.content.views.markdown import pictures_in


def unused_problems(content: Content) -> list[Problem]:
    """Files in the exhibits' folders and in media/ that no text and no table refers to."""
    found = []
    hung = {path for _, path in plan_files(content.plan)}
    for exhibit in content.exhibits:
        if exhibit.toml in {problem.file for problem in content.problems}:
            continue  # its last good version is shown: what the new one names is not known
        used = _used(exhibit) | {path.removeprefix(f"exhibits/{exhibit.id}/") for path in hung}
        for path in walk_files(exhibit.folder):
            name = path.relative_to(exhibit.folder).as_posix()
            if name not in used and not (exhibit.file.baked_key and _built(name)):
                found.append(_unused(f"exhibits/{exhibit.id}/{name}", "exhibit.toml"))
    media = content.folder / "media"
    if media.is_dir():
        named = hung | {path for _, path in hall_files(content.hall)}
        for path in walk_files(media):
            name = path.relative_to(content.folder).as_posix()
            if name not in named:
                table = "plan.toml" if path.suffix.lower() in PAINTED else "hall.toml"
                found.append(_unused(name, table))
    return found


def _built(name: str) -> bool:
    """Whether `hall build` writes it for an exhibit with an outfit or a scan, shown by a text or not."""
    return name.startswith(BAKED) or name == SHEET


def _used(exhibit: Exhibit) -> set[str]:
    used = {"exhibit.toml", "LICENCE.txt", *TEXTS.values()}
    used.update(path for _, path in exhibit_files(exhibit.file))
    if exhibit.file.scan:
        beside = scan_files(exhibit.folder.parents[1], exhibit.folder, exhibit.file.scan)
        used.update(
            path.relative_to(exhibit.folder).as_posix()
            for path in beside
            if path.is_relative_to(exhibit.folder)
        )
    if exhibit.file.motion:
        used.add(tracked_beside(exhibit.file.motion))
    texts = (exhibit.text_zh, exhibit.text_en)
    used.update(posixpath.normpath(path) for text in texts for path in pictures_in(text))
    return used


def _unused(name: str, table: str) -> Problem:
    return Problem(name, "", "the file is not used", f"name it in {table}, or remove it")
