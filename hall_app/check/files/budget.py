"""Budgets: what a visitor's connection and graphics card are asked to carry."""

from __future__ import annotations

from pathlib import Path

from hall_app.content.bakes.inputs import scan_files
from hall_app.content.files import is_there, walk_files
from hall_app.content.folder import Content
from hall_app.content.models.accessors import MOST_TRIANGLES
from hall_app.content.models.glb import GlbError, read_glb
from hall_app.content.problems import Problem

MB = 1_000_000
TRIANGLES = {"hall": 15_000, "close": MOST_TRIANGLES}
BYTES = {"hall": 1.5 * MB, "close": 15 * MB}
TEXTURE = 2048  # [pixels]
FILE, FOLDER = 10 * MB, 2_000 * MB


def budget_problems(content: Content) -> list[Problem]:
    """Models with too many triangles, bytes or pixels; files and a folder that are too large; empty files."""
    found = []
    for exhibit in content.exhibits:
        for precision, (key, path) in exhibit.own_models().items():
            found += _model(exhibit.toml, key, precision, path)
        if (compared := exhibit.compared_path()) is not None:
            found += _model(exhibit.toml, "comparison.model", "close", compared)
    total = 0
    scans = _scans(content)
    for path in walk_files(content.folder):
        if path in scans:
            continue  # no visitor loads it; what reads it has a limit of its own
        name, size = path.relative_to(content.folder).as_posix(), path.stat().st_size
        total += size
        if size == 0:
            found.append(
                Problem(name, "", "the file is empty (0 bytes)", "replace it by the whole file or remove it")
            )
        if size > FILE:
            what = f"the file has {size / MB:.1f} MB, at most {FILE / MB:g} MB"
            found.append(
                Problem(name, "", what, "make it smaller: fewer pixels, fewer triangles, a lower bit rate")
            )
    if total > FOLDER:
        what = f"the folder has {total / MB:.1f} MB, at most {FOLDER / MB:g} MB"
        found.append(Problem(".", "", what, "remove or shrink the largest files"))
    return found


def _scans(content: Content) -> set[Path]:
    """Scans, and the pictures that belong to them: what models are made of."""
    found: set[Path] = set()
    for exhibit in content.exhibits:
        if exhibit.file.scan is not None and is_there(exhibit.folder / exhibit.file.scan):
            found.update(scan_files(content.folder, exhibit.folder, exhibit.file.scan))
    return found


def _model(toml: str, key: str, precision: str, path: Path) -> list[Problem]:
    try:
        info = read_glb(path)
    except (GlbError, OSError):
        return []  # another check names it
    found = []
    if info.triangles > TRIANGLES[precision]:
        what = f"{info.triangles} triangles, at most {TRIANGLES[precision]}"
        found.append(Problem(toml, key, what, "reduce the mesh (decimate) and export it again"))
    if info.size > BYTES[precision]:
        what = f"{info.size / MB:.2f} MB, at most {BYTES[precision] / MB:g} MB"
        found.append(Problem(toml, key, what, "use fewer triangles or smaller textures"))
    for width, height in info.textures:
        if max(width, height) > TEXTURE:
            what = f"a texture has {width} x {height} pixels, at most {TEXTURE} x {TEXTURE}"
            found.append(Problem(toml, key, what, "scale the texture down and export the model again"))
    return found
