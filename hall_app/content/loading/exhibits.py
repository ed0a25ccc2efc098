"""An exhibit's folder as a value, or everything that is wrong with it."""

from __future__ import annotations

from pathlib import Path

from hall_app.content.bakes.inputs import outfit_problems
from hall_app.content.files import TEXTS, exhibit_files, file_problem, made_by_build
from hall_app.content.floor.footprints import body_footprint
from hall_app.content.floor.placement import place_faults, start_problems
from hall_app.content.folder import Exhibit
from hall_app.content.loading.tables import folders_in, read_table, read_text, unforeseen
from hall_app.content.models.glb import GlbError, read_glb
from hall_app.content.problems import Problem
from hall_app.content.schema.exhibit import ExhibitFile
from hall_app.content.schema.hall import HallFile
from hall_app.content.schema.plan import PlanFile

RESERVED = ("hall", "articles", "weaves", "research")  # /media/hall/ and so on are not an exhibit's
ID_FORM = "abcdefghijklmnopqrstuvwxyz0123456789-"


def load_exhibit_problems(folder: Path) -> list[Problem]:
    """Problems of the exhibits' own files, where there is no hall to put them in."""
    found: list[Problem] = []
    for home in folders_in(folder / "exhibits"):
        found += whatever_it_holds(folder, home.name, None)[1]
    return found


def whatever_it_holds(
    root: Path, identity: str, house: tuple[HallFile, PlanFile] | None
) -> tuple[Exhibit | None, list[Problem]]:
    """load_exhibit, with every fault nobody foresaw as a problem: one exhibit never takes the hall with it."""
    try:
        return load_exhibit(root, identity, house)
    except Exception as error:
        return None, [unforeseen(f"exhibits/{identity}/exhibit.toml", error)]


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
    texts = {
        language: read_text(root, f"exhibits/{identity}/{name}", "every exhibit", problems)
        for language, name in TEXTS.items()
    }
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
