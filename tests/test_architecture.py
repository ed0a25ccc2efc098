"""The arrows of the house: sim_core <- hall_app -> survey, and heavy packages stay where they are needed."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROOMS = ("sim_core", "survey", "hall_app")
ALLOWED = {"sim_core": {"sim_core"}, "survey": {"survey"}, "hall_app": set(ROOMS)}
HEAVY = {"torch", "pandas", "factor_analyzer", "viser", "moderngl", "av", "matplotlib"}
DOZEN = 12
UNCOUNTED = {"__init__.py", "__init__.pyi", "__main__.py", "__pycache__", "cli.py", "README.md"}


def modules(room: str) -> list[Path]:
    return sorted((ROOT / room).rglob("*.py"))


def imported(tree: ast.AST) -> set[str]:
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names


def at_module_top(tree: ast.Module) -> set[str]:
    return imported(ast.Module([n for n in tree.body if isinstance(n, ast.Import | ast.ImportFrom)], []))


@pytest.mark.parametrize("room", ROOMS)
def test_arrows(room):
    assert modules(room)
    for path in modules(room):
        ours = imported(ast.parse(path.read_text("utf-8"))) & set(ROOMS)
        assert ours <= ALLOWED[room], f"{path.relative_to(ROOT)} imports {ours - ALLOWED[room]}"


def named(path: Path) -> str:
    """The dotted name of a module."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imports_within(room: str) -> dict[str, set[str]]:
    """Module -> modules of the same package that it imports, at its top, within functions or for its types."""
    names = {named(path): path for path in modules(room)}
    arrows: dict[str, set[str]] = {}
    for name, path in names.items():
        home = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
        arrows[name] = set()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                arrows[name] |= {alias.name for alias in node.names} & set(names)
            elif isinstance(node, ast.ImportFrom):
                base = home[: len(home) - node.level + 1] if node.level else []
                source = ".".join([*base, *filter(None, [node.module])])
                for alias in node.names:  # a name of a package, or a module in it
                    inner = f"{source}.{alias.name}"
                    arrows[name] |= {inner if inner in names else source} & set(names)
        arrows[name].discard(name)
    return arrows


@pytest.mark.parametrize("room", ROOMS)
def test_no_circle_between_modules(room):
    arrows = {name: set(targets) for name, targets in imports_within(room).items()}
    while ground := [name for name, targets in arrows.items() if not targets & set(arrows)]:
        for name in ground:
            del arrows[name]
    assert not arrows, f"these import one another, or stand on such: {', '.join(sorted(arrows))}"


def folders(room: str) -> list[Path]:
    return sorted({path.parent for path in modules(room)})


@pytest.mark.parametrize("room", ROOMS)
def test_a_dozen_lie_side_by_side(room):
    crowded = {}
    for folder in folders(room):
        inside = [path.name for path in folder.iterdir() if path.name not in UNCOUNTED]
        if len(inside) > DOZEN:
            crowded[str(folder.relative_to(ROOT))] = len(inside)
    assert not crowded


@pytest.mark.parametrize("room", ROOMS)
def test_no_arrow_upwards_in_a_folder(room):
    arrows = imports_within(room)
    for folder in folders(room):
        home = named(folder / "__init__.py")
        depth = home.count(".") + 2
        floors: dict[str, set[str]] = {}
        for name, targets in arrows.items():
            if name.startswith(f"{home}."):
                child = ".".join(name.split(".")[:depth])
                below = {".".join(t.split(".")[:depth]) for t in targets if t.startswith(f"{home}.")}
                floors.setdefault(child, set()).update(below - {child})
        while ground := [child for child, below in floors.items() if not below & set(floors)]:
            for child in ground:
                del floors[child]
        assert not floors, f"{home}: these stand on one another: {', '.join(sorted(floors))}"


def test_tests_go_through_public_faces():
    """A regrouping within a package touches no test: they import packages, rooms of one file and a `cli`."""
    packages = {named(folder / "__init__.py") for room in ROOMS for folder in folders(room)}
    inner = set()
    for path in sorted((ROOT / "tests").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] in ROOMS:
                alone = node.module.count(".") == 1 or node.module.endswith(".cli")
                if node.module not in packages and not alone:
                    inner.add(f"{path.relative_to(ROOT)}: {node.module}")
    assert not inner, "\n".join(sorted(inner))


@pytest.mark.parametrize("room", ROOMS)
def test_heavy_packages_are_imported_where_needed(room):
    for path in modules(room):
        top = at_module_top(ast.parse(path.read_text("utf-8"))) & HEAVY
        assert not top, f"{path.relative_to(ROOT)} imports {top} at its top"


@pytest.mark.parametrize("room", ROOMS)
def test_modules_stay_short(room):
    for path in modules(room):
        assert len(path.read_text("utf-8").splitlines()) <= 400, path.relative_to(ROOT)


@pytest.mark.parametrize(
    ("module", "forbidden"),
    [
        ("sim_core", {"numba", "scipy", "torch", "trimesh", "PIL"}),
        ("hall_app.cli", {"torch", "viser", "pandas", "factor_analyzer", "numba"}),
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
