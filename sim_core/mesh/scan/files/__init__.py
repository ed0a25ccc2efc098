"""Scans as files: GLB, PLY or OBJ.

glb, ply, obj: one form each; obj_lines: its text, compiled; beside: files that belong to one; pictures: decoded.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from sim_core.mesh.scan.files.beside import companion_path
from sim_core.mesh.scan.files.glb import read_glb_scan
from sim_core.mesh.scan.files.obj import obj_libraries, obj_pictures, read_obj_scan
from sim_core.mesh.scan.files.ply import ply_pictures, read_ply_scan
from sim_core.mesh.scan.scan import Scan, ScanError

__all__ = ["ENDINGS", "LARGEST", "read_scan", "scan_companions"]

ENDINGS = (".glb", ".ply", ".obj")
LARGEST = 1_000_000_000  # [bytes] of a scan


def read_scan(path: Path, root: Path) -> Scan:
    """The scan at `path`; what it names must lie beneath the folder `root`. Raises ScanError, OSError."""
    _refuse(path)
    ending = path.suffix.lower()
    if ending == ".glb":
        return read_glb_scan(path)
    return read_ply_scan(path, root) if ending == ".ply" else read_obj_scan(path, root)


def scan_companions(path: Path, root: Path) -> tuple[Path, ...]:
    """The files beside a scan that belong to it and are there: material files and pictures.

    What is missing, or lies outside `root`, is left out: whoever reads the scan is told. Raises ScanError for a scan of
    no form that is read, OSError.
    """
    _refuse(path)
    ending = path.suffix.lower()
    if ending == ".ply":
        return tuple(_there(path, ply_pictures(path), root))
    if ending != ".obj":
        return ()
    stat = path.stat()
    libraries = list(_there(path, _libraries(path, stat.st_mtime_ns, stat.st_size), root))
    pictures = [found for one in libraries for found in _there(path, obj_pictures(one), root)]
    return tuple(dict.fromkeys([*libraries, *pictures]))


@lru_cache(maxsize=64)
def _libraries(path: Path, _mtime: int, _size: int) -> tuple[str, ...]:
    """What a whole OBJ is looked through for, once as long as it stays what it is."""
    return obj_libraries(path)


def _there(path: Path, names: tuple[str, ...], root: Path) -> Iterator[Path]:
    for name in names:
        with suppress(ScanError):
            yield companion_path(path, name, root)


def _refuse(path: Path) -> None:
    if path.suffix.lower() not in ENDINGS:
        raise ScanError(f"{path.name} is no scan the hall reads", f"export it as {', '.join(ENDINGS)}")
    size = path.stat().st_size
    if size > LARGEST:
        what = f"it has {size / 1e6:.0f} MB, at most {LARGEST / 1e6:.0f} MB"
        raise ScanError(
            what, "decimate it in the scanning software, or export it in binary form (.ply, .glb)"
        )
