"""From a content folder to values: hall, plan, exhibits, what is written beside them, and the problems on the way."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from hall_app.content.files import file_problem, hall_files, plan_files, revision
from hall_app.content.floor.placement import plan_problems, start_problems
from hall_app.content.folder import Content, Exhibit
from hall_app.content.loading.exhibits import whatever_it_holds
from hall_app.content.loading.tables import folders_in, read_table, unforeseen
from hall_app.content.loading.writing import load_writing
from hall_app.content.problems import ContentError, Problem
from hall_app.content.schema.hall import HallFile
from hall_app.content.schema.plan import PlanFile


def load(folder: Path, *, last_good: Content | None = None) -> Content:
    """Read the content folder. Raises ContentError where hall.toml or plan.toml is missing or faulty.

    With `last_good`, what is faulty now keeps its last good version, and the problem is still reported.
    """
    folder = folder.resolve()
    hall, plan, problems = _load_house(folder)
    if hall is None or plan is None:
        if last_good is None:
            raise ContentError(problems)
        hall, plan = last_good.hall, last_good.plan
    exhibits: list[Exhibit] = []
    for home in folders_in(folder / "exhibits"):
        exhibit, found = whatever_it_holds(folder, home.name, (hall, plan))
        problems += found
        if exhibit is None and last_good is not None:
            exhibit = last_good.exhibit(home.name)
        if exhibit is not None:
            exhibits.append(exhibit)
    writing, found = load_writing(folder, last_good.writing if last_good else None)
    problems += found
    return Content(folder, hall, plan, tuple(exhibits), writing, tuple(problems), revision(folder))


def _load_house(folder: Path) -> tuple[HallFile | None, PlanFile | None, list[Problem]]:
    """hall.toml and plan.toml, which stand or fall together."""
    hall, hall_problems = read_table(folder, "hall.toml", HallFile)
    plan, problems = read_table(folder, "plan.toml", PlanFile)
    problems = hall_problems + problems
    if plan is not None:
        try:
            problems += plan_problems(plan)
        except Exception as error:  # geometry of whatever was written
            problems.append(unforeseen("plan.toml", error))
    if hall is not None:
        problems += _lost(folder, "hall.toml", hall_files(hall))
    if hall is not None and plan is not None and not problems:
        problems += start_problems(hall, plan)
    if hall is None or plan is None or problems:
        return None, None, problems
    # A picture that is lost keeps nobody out: its scroll hangs empty.
    return hall, plan, _lost(folder, "plan.toml", plan_files(plan))


def _lost(folder: Path, toml: str, named: Iterable[tuple[str, str]]) -> list[Problem]:
    """What keeps files that a table names, (key, path), from being used."""
    found = [file_problem(toml, key, folder, path, root=folder) for key, path in named]
    return [problem for problem in found if problem]
