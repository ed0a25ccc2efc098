"""What lies beside a scan and belongs to it: found inside the content folder alone."""

from __future__ import annotations

from pathlib import Path

from sim_core.mesh.scan.scan import ScanError

__all__ = ["companion", "companion_path"]


def companion_path(path: Path, name: str, root: Path) -> Path:
    """Where a file that the scan at `path` names lies. Raises ScanError for one outside `root`, or not there."""
    plain = name.replace("\\", "/")
    outside = ScanError(
        f"it names a file outside the content folder, {name[:60]!r}",
        f"put that file beside {path.name} and write its bare name there",
    )
    if "\0" in plain or ":" in plain or plain.startswith("/"):
        raise outside
    full = path.parent / plain
    try:
        if not full.resolve().is_relative_to(root.resolve()):
            raise outside
        there = full.is_file()
    except OSError:
        there = False
    if not there:
        other = _otherwise(full)
        fix = f"put it beside {path.name}" if other is None else f"rename {other} to {full.name}"
        raise ScanError(f"the file it names, {name[:60]!r}, is not there", fix)
    return full


def _otherwise(full: Path) -> str | None:
    """The file there whose name differs in capitals alone, which is the same on other systems."""
    try:
        near = sorted(
            one.name for one in full.parent.iterdir() if one.name.casefold() == full.name.casefold()
        )
    except OSError:
        return None
    return near[0] if near else None


def companion(path: Path, name: str, root: Path) -> bytes:
    """The bytes of such a file."""
    return companion_path(path, name, root).read_bytes()
