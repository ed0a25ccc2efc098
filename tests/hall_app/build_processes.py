"""A hall with something to bake, and the processes that bake it, as the system lists them."""

from __future__ import annotations

from pathlib import Path

from content_house import write_outfit
from plain_hall import write_plain_hall

SCARF = """
title = { zh = "帔", en = "Scarf" }
outfit = "outfits/scarf.toml"
place = { x = -2.5, z = 3.0 }
body = { shape = "round", radius = 0.4 }
licence = "CC0-1.0"
"""


def with_scarf(folder: Path) -> Path:
    """A plain hall with an outfit that has not been baked."""
    write_plain_hall(folder)
    write_outfit(folder)
    home = folder / "exhibits/scarf"
    home.mkdir()
    (home / "exhibit.toml").write_text(SCARF, "utf-8")
    for name in ("text.zh.md", "text.en.md"):
        (home / name).write_text("A scarf.", "utf-8")
    return folder


def processes() -> dict[int, tuple[int, int]]:
    """Process -> (parent, session) of all that live."""
    found = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                state, parent, _, session = (
                    (entry / "stat").read_text("utf-8", "replace").rpartition(")")[2].split()[:4]
                )
            except OSError:
                continue
            if state not in "ZX":
                found[int(entry.name)] = (int(parent), int(session))
    return found


def builds_of(server: int) -> set[int]:
    """Processes of all builds that a server has started: each build is a session of its own."""
    children = {pid for pid, (parent, _) in processes().items() if parent == server}
    return {pid for pid, (_, session) in processes().items() if session in children}
