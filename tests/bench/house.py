"""The house in figures: what lies side by side in each folder, its floors, its arrows, what stands in a circle.

    python tests/bench/house.py                     the tree as it is
    python tests/bench/house.py REVISION REVISION   these revisions side by side
    python tests/bench/house.py --folders           every folder that holds code, not the rooms alone

Side by side: files and folders of a folder, besides __init__, __main__, cli and README. Floors: the longest way of
imports down from one of them to one that imports none of the others. Circles: how many of them stand on themselves.
Between modules: arrows between all modules of the package, and how many of these stand in a circle. Lines: of Python.
"""

from __future__ import annotations

import argparse
import ast
import io
import subprocess
import tarfile
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("sim_core", "survey", "hall_app")
UNCOUNTED = {"__init__.py", "__init__.pyi", "__main__.py", "cli.py", "README.md"}
Arrows = dict[str, set[str]]


@dataclass(frozen=True)
class Tree:
    """The files of the three packages at one revision: path -> text (of Python) or empty."""

    name: str
    files: dict[str, str]

    @staticmethod
    def of(revision: str | None) -> Tree:
        """A revision's files; None: those of the working tree."""
        if revision is None:
            there = [path for name in PACKAGES for path in (ROOT / name).rglob("*") if path.is_file()]
            kept = [path for path in there if "__pycache__" not in path.parts]
            read = {
                p.relative_to(ROOT).as_posix(): p.read_text("utf-8") if p.suffix == ".py" else ""
                for p in kept
            }
            return Tree("now", read)
        files: dict[str, str] = {}
        with tarfile.open(fileobj=io.BytesIO(_git("archive", revision, *PACKAGES))) as archive:
            for member in archive:
                stream = archive.extractfile(member) if member.isfile() else None
                if stream is not None:
                    files[member.name] = stream.read().decode() if member.name.endswith(".py") else ""
        return Tree(revision, files)

    def arrows(self, package: str) -> Arrows:
        """Module -> modules of the same package that it imports anywhere."""
        paths = {_dotted(name): name for name in self.files if _of(name, package) and name.endswith(".py")}
        found: Arrows = {}
        for module, name in paths.items():
            home = module.split(".") if name.endswith("__init__.py") else module.split(".")[:-1]
            found[module] = set(_imported(self.files[name], home, set(paths))) - {module}
        return found

    def folders(self, package: str) -> list[str]:
        """Every folder of a package that holds Python, dotted."""
        names = [name for name in self.files if _of(name, package) and name.endswith(".py")]
        return sorted({".".join(PurePosixPath(name).parent.parts) for name in names})

    def side_by_side(self, folder: str) -> int:
        """Files and folders directly in a folder, the uncounted ones left out."""
        top = folder.replace(".", "/") + "/"
        inside = {name.removeprefix(top).split("/")[0] for name in self.files if name.startswith(top)}
        return len(inside - UNCOUNTED)

    def lines(self, package: str) -> int:
        """Lines of Python in a package."""
        return sum(len(text.splitlines()) for name, text in self.files.items() if _of(name, package))


def _git(*words: str) -> bytes:
    return subprocess.run(("git", *words), cwd=ROOT, capture_output=True, check=True).stdout


def _of(name: str, package: str) -> bool:
    return name.startswith(f"{package}/")


def _dotted(name: str) -> str:
    return ".".join(PurePosixPath(name).with_suffix("").parts).removesuffix(".__init__")


@cache
def nodes_of(text: str) -> tuple[ast.AST, ...]:
    """All nodes of a module, itself first; of one text once, since many questions are asked of the same files."""
    return tuple(ast.walk(ast.parse(text)))


def _imported(text: str, home: list[str], known: set[str]) -> Iterable[str]:
    for node in nodes_of(text):
        if isinstance(node, ast.Import):
            yield from {alias.name for alias in node.names} & known
        elif isinstance(node, ast.ImportFrom):
            base = home[: len(home) - node.level + 1] if node.level else []
            source = ".".join([*base, *filter(None, [node.module])])
            for alias in node.names:
                inner = f"{source}.{alias.name}"
                yield from {inner if inner in known else source} & known


def within(arrows: Arrows, folder: str) -> Arrows:
    """The arrows between the children of a folder."""
    depth = folder.count(".") + 2
    found: Arrows = {}
    for module, targets in arrows.items():
        if module.startswith(f"{folder}."):
            child = ".".join(module.split(".")[:depth])
            below = {".".join(t.split(".")[:depth]) for t in targets if t.startswith(f"{folder}.")}
            found.setdefault(child, set()).update(below - {child})
    return found


def floors(arrows: Arrows) -> tuple[int, int]:
    """How many floors there are, and how many stand in a circle or on one."""
    left, count = {name: set(targets) for name, targets in arrows.items()}, 0
    while ground := [name for name, targets in left.items() if not targets & set(left)]:
        count += 1
        for name in ground:
            del left[name]
    return count, len(left)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("revisions", nargs="*", metavar="REVISION", help="as git names them")
    parser.add_argument("--folders", action="store_true", help="every folder that holds code")
    args = parser.parse_args()
    try:
        trees = [Tree.of(revision) for revision in args.revisions] or [Tree.of(None)]
    except subprocess.CalledProcessError as error:
        parser.error(error.stderr.decode().strip().splitlines()[-1])
    for tree in trees:
        print(f"{tree.name}\n  {'folder':<34}{'side by side':>13}{'floors':>8}{'arrows':>8}{'circles':>9}")
        for package in PACKAGES:
            arrows = tree.arrows(package)
            for folder in tree.folders(package):
                if folder.count(".") > 1 and not args.folders:
                    continue
                inside = within(arrows, folder)
                height, circling = floors(inside)
                many = sum(map(len, inside.values()))
                print(f"  {folder:<34}{tree.side_by_side(folder):>13}{height:>8}{many:>8}{circling:>9}")
            height, circling = floors(arrows)
            many = sum(map(len, arrows.values()))
            print(
                f"  {package}, between modules: {len(arrows)} modules, {many} arrows, {height} floors, "
                f"{circling} in circles; {tree.lines(package):,} lines\n"
            )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
