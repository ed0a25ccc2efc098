"""From a content folder to values: hall, plan, exhibits, and the problems met on the way."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from hall_app.content.bakes.inputs import outfit_problems
from hall_app.content.files import (
    LEAVES,
    TEXTS,
    exhibit_files,
    file_problem,
    hall_files,
    leaves,
    made_by_build,
    revision,
)
from hall_app.content.floor.footprints import body_footprint
from hall_app.content.floor.placement import place_faults, plan_problems, start_problems
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.glb import GlbError, read_glb
from hall_app.content.problems import ContentError, Problem
from hall_app.content.schema.complaints import schema_problems, toml_problem
from hall_app.content.schema.exhibit import ExhibitFile
from hall_app.content.schema.hall import HallFile
from hall_app.content.schema.plan import PlanFile
from hall_app.content.schema.values import Table

RESERVED = ("hall",)  # /media/hall/ is the hall's own
ID_FORM = "abcdefghijklmnopqrstuvwxyz0123456789-"

T = TypeVar("T", bound=Table)


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
    for home in _exhibit_folders(folder):
        exhibit, found = _whatever_it_holds(folder, home.name, (hall, plan))
        problems += found
        if exhibit is None and last_good is not None:
            exhibit = last_good.exhibit(home.name)
        if exhibit is not None:
            exhibits.append(exhibit)
    return Content(folder, hall, plan, tuple(exhibits), tuple(problems), revision(folder))


def load_exhibit_problems(folder: Path) -> list[Problem]:
    """Problems of the exhibits' own files, where there is no hall to put them in."""
    found: list[Problem] = []
    for home in _exhibit_folders(folder):
        found += _whatever_it_holds(folder, home.name, None)[1]
    return found


def _whatever_it_holds(
    root: Path, identity: str, house: tuple[HallFile, PlanFile] | None
) -> tuple[Exhibit | None, list[Problem]]:
    """load_exhibit, with every fault nobody foresaw as a problem: one exhibit never takes the hall with it."""
    try:
        return load_exhibit(root, identity, house)
    except Exception as error:
        return None, [_unforeseen(f"exhibits/{identity}/exhibit.toml", error)]


def _unforeseen(file: str, error: Exception) -> Problem:
    reason = " ".join(str(error).split())[:200] or type(error).__name__
    fix = "undo the last change there, and report it with the file"
    return Problem(file, "", f"cannot be read ({reason})", fix)


def _exhibit_folders(folder: Path) -> list[Path]:
    home = folder / "exhibits"
    if not home.is_dir():
        return []
    return sorted(path for path in home.iterdir() if path.is_dir() and not path.name.startswith((".", "_")))


def _load_house(folder: Path) -> tuple[HallFile | None, PlanFile | None, list[Problem]]:
    """hall.toml and plan.toml, which stand or fall together."""
    hall, hall_problems = read_table(folder, "hall.toml", HallFile)
    plan, problems = read_table(folder, "plan.toml", PlanFile)
    problems = hall_problems + problems
    if plan is not None:
        try:
            problems += plan_problems(plan)
        except Exception as error:  # geometry of whatever was written
            problems.append(_unforeseen("plan.toml", error))
    if hall is not None:
        named = [file_problem("hall.toml", key, folder, path, root=folder) for key, path in hall_files(hall)]
        problems += [problem for problem in named if problem]
    if hall is not None and plan is not None and not problems:
        problems += start_problems(hall, plan)
    return (None, None, problems) if problems else (hall, plan, problems)


def read_table(root: Path, name: str, model: type[T]) -> tuple[T | None, list[Problem]]:
    """Read the TOML file `name` under `root` as `model`: the value, or None and its problems."""
    path = root / name
    try:
        if leaves(path, root):
            return None, [Problem(name, "", f"it {LEAVES[0]}", LEAVES[1])]
        data = path.read_bytes()
        if not data.strip():
            return None, [Problem(name, "", "the file is empty", "write it anew (its form: README.md)")]
        # Notepad writes a byte order mark.
        return model.model_validate(tomllib.loads(data.decode("utf-8-sig"))), []
    except FileNotFoundError:
        return None, [Problem(name, "", "missing file", "add it (its form: README.md)")]
    except OSError as error:
        return None, [Problem(name, "", f"cannot be read ({error.strerror})", "check the file's permissions")]
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        return None, [toml_problem(name, error)]
    except ValidationError as error:
        return None, schema_problems(name, model, error)
    except (ValueError, RecursionError, ArithmeticError) as error:
        # A number of thousands of digits, thousands of brackets: tomllib gives up in its own ways.
        what = f"cannot be read ({type(error).__name__})"
        return None, [Problem(name, "", what, "shorten its numbers and lists")]


def load_exhibit(
    root: Path, identity: str, house: tuple[HallFile, PlanFile] | None
) -> tuple[Exhibit | None, list[Problem]]:
    """Read one exhibit's folder: the exhibit, or None and everything that is wrong with it.

    house: hall and plan it stands in; without them its place is not looked at.
    """
    toml = f"exhibits/{identity}/exhibit.toml"
    folder = root / "exhibits" / identity
    if identity in RESERVED or set(identity) - set(ID_FORM):
        fix = f"rename the folder with a-z, 0-9 and -, other than {', '.join(RESERVED)}"
        return None, [Problem(toml, "", f"{identity!r} cannot be the name of an exhibit", fix)]
    file, problems = read_table(root, toml, ExhibitFile)
    texts = {language: _text(root, identity, name, problems) for language, name in TEXTS.items()}
    if file is None:
        return None, problems
    problems += _file_problems(root, folder, toml, file)
    if house is not None:
        problems += _place_problems(house, identity, toml, file)
    if problems:
        return None, problems
    return Exhibit(identity, folder, file, texts["zh"], texts["en"]), []


def _place_problems(
    house: tuple[HallFile, PlanFile], identity: str, toml: str, file: ExhibitFile
) -> list[Problem]:
    """Whether it stands in the hall, clear of the plan's solids and of the visitors' start."""
    faults = place_faults(house[1], identity, file)
    if not faults and start_problems(*house, [body_footprint(identity, file)]):
        fix = "move it with place.x, place.z, or make its body smaller"
        faults = [("place", "stands where visitors begin (hall.toml: start)", fix)]
    return [Problem(toml, *fault) for fault in faults]


def _text(root: Path, identity: str, name: str, problems: list[Problem]) -> str:
    """The Markdown text, its faults added to `problems`."""
    path = f"exhibits/{identity}/{name}"
    try:
        if leaves(root / path, root):
            problems.append(Problem(path, "", f"it {LEAVES[0]}", LEAVES[1]))
            return ""
        text = (root / path).read_text("utf-8-sig")
    except FileNotFoundError:
        problems.append(Problem(path, "", "missing text", "write it: every exhibit has both languages"))
    except (OSError, UnicodeDecodeError):
        problems.append(Problem(path, "", "the text cannot be read", "save it with the encoding UTF-8"))
    else:
        if not text.strip():
            problems.append(
                Problem(path, "", "the text is empty", "write it: every exhibit has both languages")
            )
        return text
    return ""


def _file_problems(root: Path, folder: Path, toml: str, file: ExhibitFile) -> list[Problem]:
    """Files named but missing, empty or, if models or outfits, unreadable; and those that an outfit names."""
    named = [(key, folder, path) for key, path in exhibit_files(file) if not made_by_build(file, path)]
    named += [("outfit", root, file.outfit)] if file.outfit else []
    problems = []
    for key, base, path in named:
        problem = file_problem(toml, key, base, path, root=root)
        if problem is None and key.startswith("models."):
            problem = _model_problem(toml, key, folder / path)
        if problem is not None:
            problems.append(problem)
        elif key == "outfit":
            problems += outfit_problems(root, path)
    return problems


def _model_problem(toml: str, key: str, path: Path) -> Problem | None:
    try:
        read_glb(path)
    except GlbError as error:
        return Problem(toml, key, f"{path.name}: {error}", error.fix)
    return None
