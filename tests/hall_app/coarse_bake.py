"""Outfits on coarse meshes, and `hall build` of one: what is dear is baked once for all tests that only look at it."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

ASSETS = Path(__file__).parents[2] / "assets"
STAND, LAYERED = "pibo", "pibo-figure"  # the exhibits that are kept: a scarf on a stand, a scarf over a robe


def coarse(place: Path) -> Path:
    """The shipped content with two coarse outfits, not baked, and no others: each takes seconds to check."""
    home = place / "content"
    others = {path.name for path in (ASSETS / "exhibits").iterdir()} - {STAND, LAYERED, "mirror"}
    shutil.copytree(ASSETS, home, ignore=shutil.ignore_patterns("baked", *others))
    for outfit in (home / "outfits").glob("*.toml"):
        if outfit.stem not in (STAND, LAYERED):
            outfit.unlink()
    for name, steps in (("pibo", (0.06,)), ("pibo-figure", (0.05, 0.04))):
        outfit = home / f"outfits/{name}.toml"
        lines = [
            line for line in outfit.read_text("utf-8").splitlines() if not line.startswith(("study", "edge"))
        ]
        layers = [k for k, line in enumerate(lines) if line == "[[layer]]"]
        for at, edge in reversed(list(zip(layers, steps, strict=True))):
            lines.insert(at + 1, f"edge = {edge}")
        outfit.write_text("\n".join(lines) + "\n", "utf-8")
    return home


def build_command(folder: Path, *options: str, exhibit: str = STAND, film: bool = False) -> list[str]:
    """`hall build` of one exhibit (the room's light would take longer than all of these tests)."""
    where = ("--content", str(folder), "--data", str(folder.parent / "data"))
    what = ("--json", "--exhibit", exhibit, *(() if film else ("--no-film",)))
    return [sys.executable, "-m", "hall_app", "build", *where, *what, *options]


def build(
    folder: Path, *options: str, exhibit: str = STAND, film: bool = False
) -> subprocess.CompletedProcess[str]:
    """Runs it to its end."""
    command = build_command(folder, *options, exhibit=exhibit, film=film)
    return subprocess.run(command, capture_output=True, text=True)


def last_line(done: subprocess.CompletedProcess[str]) -> dict:
    """What a build that succeeded said last."""
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.strip().splitlines()[-1])
