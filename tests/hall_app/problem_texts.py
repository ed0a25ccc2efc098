"""The texts of problems as the sources have them: what fills a text is written {} in it.

Read from the syntax trees alone. A text may be a string, an f-string, a sum of them, a choice between them, or the name
of one, in the function, in its module or in the module it is imported from.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from pathlib import Path

ROOT = Path(__file__).parents[2]
GAP = "{}"
DEEPEST = 9  # names of names that are followed

# Whoever is called so is given texts: (place among the arguments, name as a keyword).
SPEAKERS: Mapping[str, Sequence[tuple[int, str]]] = {
    "Problem": ((2, "what"), (3, "fix")),
    "problem": ((0, "what"), (1, "remedy")),  # of clips
    "Finding": ((1, "what"), (2, "fix")),
    "ScanError": ((0, "what"), (1, "fix")),
    "GlbError": ((0, "what"), (1, "fix")),
    "TrackedError": ((0, "what"),),
    "PictureError": ((0, "what"),),
    "EditError": ((0, "what"),),
    "PydanticCustomError": ((1, "message_template"),),
    "PeopleError": ((9, "why"),),
    "_RefusedError": ((9, "why"),),  # of a recording
    "read_text": ((2, "what"),),  # whose text is missing
    "progress": ((1, "label"),),  # of a bake, told in the office
}

# Functions that hand texts to one of these: the places of the texts in the tuples they give, None: they give a text.
TELLERS: Mapping[tuple[str, str], Sequence[int] | None] = {
    ("hall_app/check/files/media.py", "_sound_fault"): (0, 1),
    ("hall_app/check/files/models.py", "_drawing_fault"): None,
    ("hall_app/check/hall/fittings.py", "_above"): (1, 2),
    ("hall_app/check/hall/fittings.py", "_curtains"): (1, 2),
    ("hall_app/check/hall/fittings.py", "_unheld"): (0, 1),
    ("hall_app/check/hall/room.py", "_texture_fault"): None,
    ("hall_app/check/hall/room.py", "_unopened"): (1,),
    ("hall_app/check/hall/signs.py", "_inside"): (1, 2),
    ("hall_app/check/hall/signs.py", "_misplaced"): (1, 2),
    ("hall_app/check/hall/signs.py", "_on_opening"): (1, 2),
    ("hall_app/check/hall/signs.py", "_unread"): (0, 1),
    ("hall_app/check/hall/signs.py", "sign_faults"): (1, 2),
    ("hall_app/content/bakes/record.py", "_file_fault"): None,
    ("hall_app/content/bakes/record.py", "seal_fault"): (1,),
    ("hall_app/content/floor/placement.py", "place_faults"): (1, 2),
    ("hall_app/content/floor/placement.py", "ring_fault"): None,
    ("hall_app/content/loading/exhibits.py", "_place_problems"): (1, 2),
    ("hall_app/content/models/pictures.py", "_drawing_fault"): (0, 1),
    ("hall_app/content/models/pictures.py", "picture_fault"): (0, 1),
    ("hall_app/content/models/scans.py", "_unit"): None,
    ("hall_app/content/schema/complaints.py", "_remedy"): None,
    ("hall_app/house/baking/preparation.py", "outcome"): None,
    ("hall_app/show/exhibits.py", "_fix"): None,
}

# These are given what is wrong and its remedy in one, and whoever catches them parts it there; ValueError in CHECKED.
_FAILURES = (
    *(
        "AllEqual",
        "ConstantItem",
        "CrossCheckFailed",
        "DependentItems",
        "LoneItem",
        "NoComponents",
        "NotConverged",
    ),
    *("NotFinite", "NotPositiveDefinite", "TooFewItems", "TooFewRows", "UnknownItem", "WrongShape"),
)  # of an analysis
PARTED = dict.fromkeys(("ArchiveError", "MissingFontError", *_FAILURES), " – ") | {"ValueError": "; "}
CHECKED = "survey/questionnaire/definition.py"

# Tables of texts, also in functions: all strings that are their values.
TABLES = (
    ("hall_app/content/models/scans.py", "lost"),
    ("hall_app/content/models/scans.py", "many"),
    ("hall_app/house/baking/queue.py", "STOPPED"),
    ("hall_app/house/house.py", "slow"),
    ("hall_app/content/files.py", "LEAVES"),
    ("hall_app/content/schema/complaints.py", "FORMER"),
    ("hall_app/content/schema/complaints.py", "REMEDIES"),
    ("sim_core/mesh/scan/files/glb.py", "PACKED"),
)

# Texts that come from elsewhere: from those above, from a library, or from an engine, whose errors stay English.
PASSED_ON = {
    ("hall_app/build/outfit.py", "_dress"),  # what the engine is doing
    ("hall_app/build/outfit.py", "models"),
    ("hall_app/build/scan.py", "bake_scan"),  # of a ScanError
    ("hall_app/check/files/bakes.py", "_fault"),  # as the engine says it
    ("hall_app/check/files/media.py", "_problem"),  # of picture_fault
    ("hall_app/check/files/scans.py", "_problem"),  # of a Finding
    ("hall_app/check/files/scans.py", "_told"),  # of a ScanError
    ("hall_app/check/files/writing.py", "_pictures"),  # of picture_fault
    ("hall_app/check/hall/fittings.py", "fitting_problems"),  # of the functions above
    ("hall_app/check/hall/questionnaires.py", "questionnaire_problems"),  # of the survey's Problem
    ("hall_app/check/hall/questionnaires.py", "unstated"),
    ("hall_app/check/hall/room.py", "room_problems"),  # of _unopened
    ("hall_app/content/floor/placement.py", "plan_problems"),  # of ring_fault
    ("hall_app/content/loading/exhibits.py", "_model_problem"),  # of a GlbError
    ("hall_app/content/loading/exhibits.py", "_place_problems"),  # of place_faults
    ("hall_app/content/models/scans.py", "_standing"),  # of _unit
    ("hall_app/content/models/scans.py", "refuse"),  # of a Finding
    ("hall_app/content/schema/complaints.py", "_problem"),  # of pydantic, and of REMEDIES
    ("hall_app/house/drafts/intake.py", "_model"),  # of a GlbError
    ("hall_app/house/drafts/publication.py", "_put"),  # of the system
    ("hall_app/house/drawing/elements.py", "_tree"),
    ("hall_app/house/drawing/elements.py", "redrawn"),
    ("hall_app/house/drawing/raster.py", "drawn_anew"),  # of Pillow
    ("hall_app/house/house.py", "problems"),  # of the survey's Problem
    ("hall_app/house/house.py", "room_problems"),  # of MissingFontError
    ("hall_app/media/make.py", "make_media"),
    ("hall_app/room/bake/build.py", "bake_room"),  # what the light is doing
    ("hall_app/show/exhibits.py", "drawn_exhibits"),  # of a GlbError
    ("hall_app/web/platform/office/backups.py", "make"),  # of the databases
    ("hall_app/web/platform/office/backups.py", "remove_house"),  # of the system
    ("hall_app/web/platform/office/backups.py", "restore"),
    ("hall_app/web/platform/office/collection/desk.py", "_write"),  # of the system
    ("sim_core/mesh/scan/files/glb.py", "_refuse"),  # of PACKED
    ("sim_core/mesh/scan/files/glb.py", "read_glb_scan"),  # of a GlbError
    ("survey/questionnaire/files.py", "problem_of"),  # of pydantic
    ("survey/web/mounting.py", "problems"),  # of the database
}


@dataclass(frozen=True)
class Said:
    """A text, None where the source does not tell it, and the function that says it."""

    text: str | None
    file: str
    function: str
    line: int


@dataclass
class _Module:
    name: str
    tree: ast.Module

    def constants(self) -> dict[str, list[ast.expr]]:
        return _assigned(self.tree.body)


@lru_cache
def _module(name: str) -> _Module:
    return _Module(name, ast.parse((ROOT / name).read_text("utf-8")))


def said(folders: Sequence[str]) -> Iterator[Said]:
    """Every text that the modules in these folders, or these modules, say."""
    for folder in folders:
        paths = [ROOT / folder] if folder.endswith(".py") else sorted((ROOT / folder).rglob("*.py"))
        for path in paths:
            yield from _of_module(_module(path.relative_to(ROOT).as_posix()))


def _of_module(module: _Module) -> Iterator[Said]:
    for function, holder in _functions(module.tree):
        scope = _Scope(module, holder)
        teller = TELLERS.get((module.name, function), ())
        for node in _own_nodes(holder):
            for given in _given(node):
                yield from scope.told(given, function)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in PARTED:
                if node.func.id != "ValueError" or module.name == CHECKED:
                    for one in scope.told(node.args[0], function):
                        parts = (one.text or "").split(PARTED[node.func.id])
                        if node.func.id in _FAILURES:  # after the names of items, however many
                            parts = [part.removeprefix(f"{GAP}: ") for part in parts]
                        yield from (replace(one, text=part) for part in parts)
            if teller != () and isinstance(node, ast.Return | ast.Yield) and node.value is not None:
                yield from scope.handed(node.value, teller, function)
            if teller and isinstance(node, ast.Tuple) and len(node.elts) == max(teller) + 1:
                told = (one for place in teller for one in scope.told(node.elts[place], function))
                yield from (one for one in told if one.text is not None and " " in one.text)
        for name, values in (scope.own if function else module.constants()).items():
            if (module.name, name) in TABLES:
                yield from (one for value in values for one in _table(value, scope, name))


def _table(value: ast.expr, scope: _Scope, name: str) -> Iterator[Said]:
    parts = value.values if isinstance(value, ast.Dict) else [value]
    for node in (one for part in parts for one in _strings(part)):
        yield from (one for one in scope.told(node, name) if one.text is not None and " " in one.text)


def _strings(node: ast.AST) -> Iterator[ast.expr]:
    if isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str)):
        yield node
    else:
        yield from (one for child in ast.iter_child_nodes(node) for one in _strings(child))


def _functions(tree: ast.Module) -> Iterator[tuple[str, ast.AST]]:
    yield "", tree
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, node


def _own_nodes(holder: ast.AST) -> Iterator[ast.AST]:
    """The nodes in a function, those of functions in it left out."""
    for node in ast.iter_child_nodes(holder):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node
            yield from _own_nodes(node)


def _given(node: ast.AST) -> Iterator[ast.expr]:
    """The texts a call is given."""
    name = node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""
    if not isinstance(node, ast.Call) or name not in SPEAKERS:
        return
    named = {one.arg: one.value for one in node.keywords}
    starred = [number for number, one in enumerate(node.args) if isinstance(one, ast.Starred)]
    for place, keyword in SPEAKERS[name]:
        if starred and place >= starred[0]:
            yield node.args[starred[0]]
        elif place < len(node.args):
            yield node.args[place]
        elif keyword in named:
            yield named[keyword]


def _assigned(body: Sequence[ast.AST]) -> dict[str, list[ast.expr]]:
    """Name -> what is assigned to it; of `a, b = x, y` each its own."""
    found: dict[str, list[ast.expr]] = {}
    for node in body:
        if isinstance(node, ast.For):  # unknown, whatever else it stands for
            names = [one for one in ast.walk(node.target) if isinstance(one, ast.Name)]
            found |= {one.id: [*found.get(one.id, ()), ast.Constant(...)] for one in names}
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is not None:
            found.setdefault(node.target.id, []).append(node.value)
        if not isinstance(node, ast.Assign):
            continue
        for target in node.targets:
            pairs = [(target, node.value)]
            if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                pairs = list(zip(target.elts, node.value.elts, strict=True))
            for one, value in pairs:
                if isinstance(one, ast.Name):
                    found.setdefault(one.id, []).append(value)
    return found


class _Scope:
    """What names stand for in a function, or in a module's own lines."""

    def __init__(self, module: _Module, holder: ast.AST) -> None:
        nodes = list(_own_nodes(holder)) if not isinstance(holder, ast.Module) else []
        self._module, self._holder, self.own = module, holder, _assigned(nodes)
        self._more: dict[str, list[ast.expr]] = {}
        for node in nodes:
            if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
                self._more.setdefault(node.target.id, []).append(node.value)

    def told(self, given: ast.expr, function: str) -> Iterator[Said]:
        texts = self.texts(given)
        for text in texts if texts is not None else [None]:
            text = re.sub(r"(\{[a-z]*\})+", GAP, text or GAP)  # pydantic's gaps have names
            yield Said(None if text == GAP else text, self._module.name, function, given.lineno)

    def handed(self, value: ast.expr, places: Sequence[int] | None, function: str) -> Iterator[Said]:
        """What a teller returns; what another one tells, it tells itself."""
        for choice in _choices(value):
            if places is None:
                texts = self.texts(choice)
                yield from (Said(one, self._module.name, function, value.lineno) for one in texts or ())

    def texts(self, node: ast.expr, depth: int = 0) -> list[str] | None:
        """All that it may say; None where the source does not tell."""
        if depth > DEEPEST:
            return None
        if isinstance(node, ast.Constant):
            return [node.value] if isinstance(node.value, str) else [] if node.value is None else None
        if isinstance(node, ast.JoinedStr):
            parts = [self._part(one, depth) for one in node.values]
            return ["".join(parts) for parts in product(*parts)]
        if isinstance(node, ast.IfExp | ast.BoolOp):
            found = [self.texts(one, depth + 1) or [GAP] for one in _choices(node)]
            return [text for texts in found for text in texts]
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            left, right = (self.texts(one, depth + 1) for one in (node.left, node.right))
            if left is None and right is None:
                return None
            return ["".join(pair) for pair in product(left or [GAP], right or [GAP])]
        if isinstance(node, ast.Subscript):
            whole = self._named(node.value)
            if len(whole) == 1 and isinstance(whole[0], ast.Tuple) and isinstance(node.slice, ast.Constant):
                return self.texts(whole[0].elts[int(str(node.slice.value))], depth + 1)
            return self.texts(node.value, depth + 1)  # whole, though its end may be cut off
        if isinstance(node, ast.Name):
            values = self._named(node)
            if not values:
                return self._brought(node.id, depth)
            found = [self.texts(value, depth + 1) for value in values]
            if any(one is None for one in found):
                return None
            texts = [text for one in found for text in one or ()]
            more = [
                text for one in self._more.get(node.id, ()) for text in self.texts(one, depth + 1) or [GAP]
            ]
            return texts + [first + second for first in texts for second in more]
        return None

    def _brought(self, name: str, depth: int) -> list[str] | None:
        """What the module's own calls give the function under that name."""
        if not isinstance(self._holder, ast.FunctionDef):
            return None
        names = [one.arg for one in self._holder.args.args]
        found: list[str] = []
        for _, caller in _functions(self._module.tree) if name in names else ():
            for node in _own_nodes(caller):
                if not isinstance(node, ast.Call) or names.index(name) >= len(node.args):
                    continue
                if isinstance(node.func, ast.Name) and node.func.id == self._holder.name:
                    given = _Scope(self._module, caller).texts(node.args[names.index(name)], depth + 1)
                    if given is None:
                        return None
                    found += given
        return list(dict.fromkeys(found)) or None

    def _part(self, node: ast.expr, depth: int) -> list[str]:
        if isinstance(node, ast.Constant):
            return [str(node.value)]
        assert isinstance(node, ast.FormattedValue)
        if node.conversion != -1 or node.format_spec is not None:
            return [GAP]
        return self.texts(node.value, depth + 1) or [GAP]

    def _named(self, node: ast.expr) -> list[ast.expr]:
        if not isinstance(node, ast.Name):
            return []
        if node.id in self.own:
            return self.own[node.id]
        constants = self._module.constants()
        if node.id in constants:
            return constants[node.id]
        for line in self._module.tree.body:
            if isinstance(line, ast.ImportFrom) and any(one.name == node.id for one in line.names):
                name = f"{(line.module or '').replace('.', '/')}.py"
                return _module(name).constants().get(node.id, []) if (ROOT / name).is_file() else []
        return []


def _choices(node: ast.expr) -> Iterator[ast.expr]:
    if isinstance(node, ast.IfExp):
        yield from (*_choices(node.body), *_choices(node.orelse))
    elif isinstance(node, ast.BoolOp):
        yield from (one for value in node.values for one in _choices(value))
    else:
        yield node
