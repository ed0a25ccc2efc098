"""The arrows of the house: sim_core <- hall_app -> survey, and heavy packages stay where they are needed."""

import ast
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest
from bench.house import Arrows, Tree, floors, nodes_of, within

pytestmark = pytest.mark.door
ROOT = Path(__file__).parent.parent
ROOMS = ("sim_core", "survey", "hall_app")
ALLOWED = {"sim_core": {"sim_core"}, "survey": {"survey"}, "hall_app": set(ROOMS)}
HEAVY = {"torch", "pandas", "factor_analyzer", "viser", "moderngl", "av", "matplotlib", "embreex"}
NETWORKS = ROOT / "sim_core" / "learn" / "networks"
DOZEN = 12
FEW = 8
# Of sim_core, from the ground up: a room may import those of lower lines, skipping as many as it likes.
LINES = (
    ("errors",),
    ("validation",),
    ("metrics", "picture"),
    ("gltf",),
    ("weave", "mesh"),
    ("cloth",),
    ("body",),
    ("track",),
    ("garment",),
    ("learn",),
    ("cli",),
)


def modules(room: str) -> list[Path]:
    return sorted((ROOT / room).rglob("*.py"))


def inside(path: Path) -> tuple[ast.AST, ...]:
    return nodes_of(path.read_text("utf-8"))


def imported(nodes: Iterable[ast.AST]) -> set[str]:
    names = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names


def at_module_top(path: Path) -> list[ast.stmt]:
    module = inside(path)[0]
    assert isinstance(module, ast.Module)
    return module.body


@pytest.mark.parametrize("room", ROOMS)
def test_arrows(room):
    assert modules(room)
    for path in modules(room):
        ours = imported(inside(path)) & set(ROOMS)
        assert ours <= ALLOWED[room], f"{path.relative_to(ROOT)} imports {ours - ALLOWED[room]}"


@pytest.fixture(scope="module")
def house() -> Tree:
    return Tree.of(None)


@pytest.mark.parametrize("room", ROOMS)
def test_no_circle_between_modules(house, room):
    assert floors(house.arrows(room))[1] == 0


def turned(arrows: Arrows) -> list[str]:
    """Arrows between rooms of sim_core that do not lead to a lower line; and rooms that stand on none."""
    height = {room: number for number, line in enumerate(LINES) for room in line}
    wrong = set()
    for module, targets in arrows.items():
        for target in targets:
            start, end = (name.split(".")[1:2] for name in (module, target))
            if (
                start
                and end
                and start != end
                and not height.get(end[0], len(LINES)) < height.get(start[0], -1)
            ):
                wrong.add(f"{module} -> {target}")
    return sorted(wrong)


def test_no_arrow_turns_back_in_sim_core(house):
    assert turned(house.arrows("sim_core")) == []


def test_a_turned_arrow_is_found():
    tree = {
        "sim_core/__init__.py": "",
        "sim_core/weave/__init__.py": "from sim_core.weave.yarn import Yarn\n",
        "sim_core/weave/yarn.py": "def f():\n    from sim_core.garment.dress import dress\n",
        "sim_core/mesh/panel.py": "import sim_core.weave.yarn\n",
        "sim_core/cloth/sheet.py": "from sim_core.errors import SimCoreError\nfrom sim_core.mesh import panel\n",
        "sim_core/errors.py": "",
        "sim_core/garment/dress.py": "from sim_core.weave import Yarn\nfrom sim_core.attic import old\n",
        "sim_core/garment/__init__.py": "from .. import errors\n",
        "sim_core/mesh/__init__.py": "",
        "sim_core/attic/old.py": "",
    }
    assert turned(Tree("made up", tree).arrows("sim_core")) == [
        "sim_core.garment.dress -> sim_core.attic.old",  # a room that has no line yet
        "sim_core.mesh.panel -> sim_core.weave.yarn",  # of one line
        "sim_core.weave.yarn -> sim_core.garment.dress",
    ]


@pytest.mark.parametrize("room", ROOMS)
def test_a_dozen_lie_side_by_side(house, room):
    crowded = {folder: house.side_by_side(folder) for folder in house.folders(room)}
    assert {folder: count for folder, count in crowded.items() if count > DOZEN} == {}


@pytest.mark.parametrize("room", ROOMS)
def test_no_arrow_upwards_in_a_folder(house, room):
    arrows = house.arrows(room)
    assert [folder for folder in house.folders(room) if floors(within(arrows, folder))[1]] == []


def test_tests_go_through_public_faces(house):
    """A regrouping within a package touches no test: they import packages, rooms of one file and a `cli`."""
    packages = {folder for room in ROOMS for folder in house.folders(room)}
    inner = set()
    for path in sorted((ROOT / "tests").rglob("*.py")):
        for node in inside(path):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] in ROOMS:
                alone = node.module.count(".") == 1 or node.module.endswith(".cli")
                if node.module not in packages and not alone:
                    inner.add(f"{path.relative_to(ROOT)}: {node.module}")
    assert not inner, "\n".join(sorted(inner))


def test_a_test_is_collected_without_other_rooms_tests():
    """What it imports of the tests lies beside it or above all: another room's folder is on no path of its own."""
    tests = ROOT / "tests"
    folders = [folder for folder in tests.iterdir() if folder.is_dir() and any(folder.glob("test_*.py"))]
    helpers = {folder: {path.stem for path in folder.glob("*.py")} for folder in folders}
    shared = {path.stem for path in tests.glob("*.py")}
    strange = []
    for folder in folders:
        elsewhere = set().union(*helpers.values()) - helpers[folder] - shared
        for path in folder.glob("*.py"):
            names = imported(inside(path)) & elsewhere
            strange += [f"{path.relative_to(ROOT)}: {name}" for name in names]
    assert len(folders) >= 4
    assert not strange


@pytest.mark.parametrize("room", ROOMS)
def test_heavy_packages_are_imported_where_needed(room):
    for path in modules(room):
        own = {"torch"} if path.is_relative_to(NETWORKS) else set()
        top = imported(at_module_top(path)) & (HEAVY - own)
        assert not top, f"{path.relative_to(ROOT)} imports {top} at its top"


def test_networks_are_imported_by_nobody_who_has_no_torch():
    """They are classes of torch's, so their package needs it; others import it where they train."""
    name = ".".join(NETWORKS.relative_to(ROOT).parts)
    for path in (path for room in ROOMS for path in modules(room) if not path.is_relative_to(NETWORKS)):
        top = [node.module or "" for node in at_module_top(path) if isinstance(node, ast.ImportFrom)]
        assert not [one for one in top if one.startswith(name)], path.relative_to(ROOT)


@pytest.mark.parametrize("room", ROOMS)
def test_modules_stay_short(room):
    for path in modules(room):
        assert len(path.read_text("utf-8").splitlines()) <= 400, path.relative_to(ROOT)


@pytest.mark.parametrize("room", ROOMS)
def test_functions_take_few_arguments(room):
    """What belongs together is a record, and has names; in cloth compiled loops take few things, too."""
    long = []
    for path in modules(room):
        for node in inside(path):
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
                continue
            given = [arg.arg for arg in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)]
            if len(set(given) - {"self", "cls"}) > FEW and not (compiled(node) and "cloth" not in path.parts):
                long.append(f"{path.relative_to(ROOT)}:{node.lineno}: {len(given)}")
    assert not long, "\n".join(long)


def compiled(node: ast.AST) -> bool:
    return any("jit" in ast.unparse(decorator) for decorator in getattr(node, "decorator_list", ()))


def test_what_ships_is_small():
    """A house of a curator's own may hold far more."""
    sizes = {path: path.stat().st_size for path in (ROOT / "assets").rglob("*") if path.is_file()}
    assert sum(sizes.values()) <= 60_000_000
    assert max(sizes.values()) <= 10_000_000


@pytest.mark.parametrize(
    ("module", "forbidden"),
    [
        ("sim_core", {"numba", "scipy", "torch", "trimesh", "PIL"}),
        ("hall_app.cli", {"torch", "viser", "pandas", "factor_analyzer", "numba", "embreex"}),
        ("hall_app.room", {"numba", "embreex"}),
        ("survey.cli", {"torch", "pandas", "factor_analyzer", "sklearn"}),
        ("sim_core.cli", {"torch", "pandas", "viser", "numba"}),
    ],
)
def test_import_stays_light(module, forbidden):
    code = f"import sys, {module}; print(' '.join(sorted({forbidden!r} & set(sys.modules))))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.strip() == ""


@pytest.mark.parametrize("package", ROOMS)
def test_public_face(package):
    module = __import__(package)
    assert module.__all__
    for name in module.__all__:
        assert getattr(module, name) is not None
