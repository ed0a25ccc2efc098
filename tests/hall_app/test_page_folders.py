"""The page's folders: few things side by side, arrows one way, viser's inside known in one place only."""

import posixpath
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

from hall_app.web.pages import PAGE_FOLDER

HALL = PAGE_FOLDER.parent
DOZEN = 12
IMPORT = re.compile(r'^import\s[^"]*"(\.[^"]+)";', re.MULTILINE)
FOLDERS = sorted({PAGE_FOLDER, *(path.parent for path in PAGE_FOLDER.rglob("*.js"))})


def imports() -> Iterator[tuple[Path, Path]]:
    for script in PAGE_FOLDER.rglob("*.js"):
        for named in IMPORT.findall(script.read_text("utf-8")):
            yield script, Path(posixpath.normpath(script.parent / named))


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_few_things_side_by_side(folder: Path):
    assert len(list(folder.iterdir())) <= DOZEN


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_no_arrow_upwards_between_the_children_of_a_folder(folder: Path):
    below: dict[str, set[str]] = defaultdict(set)
    for script, target in imports():
        assert target.is_file(), f"{script}: {target}"
        if script.is_relative_to(folder) and target.is_relative_to(folder):
            child, other = (path.relative_to(folder).parts[0] for path in (script, target))
            below[child] |= {other} - {child}
    while ground := [child for child, others in below.items() if not others & set(below)]:
        for child in ground:
            del below[child]
    assert not below, f"these stand on one another: {', '.join(sorted(below))}"


def test_one_folder_of_the_page_knows_the_inside_of_viser():
    knowing = {
        script.relative_to(PAGE_FOLDER).parts[0]
        for script in PAGE_FOLDER.rglob("*")
        if script.is_file()
        and re.search(r"__viser|__r3f|poseUpdateState|\.viser\b", script.read_text("utf-8"))
    }
    assert knowing == {"viser"}
    modules = {script for script, target in imports() if target.parent.name == "viser"}
    assert {target.name for _, target in imports() if target.parent.name == "viser"} == {"viser_adapter.js"}
    assert len(modules) > 3


def test_one_module_of_the_hall_knows_the_inside_of_viser():
    private = re.compile(r"from viser import _|viser\._(?!_)|\._websock")
    knowing = {
        path.relative_to(HALL).as_posix()
        for path in HALL.rglob("*.py")
        if private.search(path.read_text("utf-8"))
    }
    assert knowing == {"show/viser_adapter.py"}
