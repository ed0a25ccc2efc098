"""One scan, from its file to what the hall shows: both models, their measured deviation, its colours drawn anew."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.content.bakes.record import FILES, publish, seal, text_of
from hall_app.content.bakes.steps import budget, hall_budget
from hall_app.content.bakes.store import RECORD, SCAN
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.scans import Finding, findings, refuse, scan_cleaned
from sim_core.validation.files import written_whole

if TYPE_CHECKING:
    from sim_core.mesh.scan import Chosen, Condition, Fine, Level, Scan

__all__ = ["bake_scan"]

Progress = Callable[[float, str], None]

CLOSE_NEAREST = 0.5  # [m] from which a pixel of the close-up is reckoned
MOST = {"close": 80_000, "hall": 15_000}  # triangles
FEWEST, STEP = 2_000, 0.8  # of the levels: the coarsest, and each of the one before
PIXELS = {"close": 2048, "hall": 1024}  # a side of the pictures
PLAIN = 64  # of a scan without colours
REACH = 4.0  # times its deviation (p99) that a colour is looked for on the same side of cloth
SPAN = {"close": (0.5, 0.85), "hall": (0.85, 0.97)}  # of the progress


def bake_scan(
    content: Content, exhibit: Exhibit, *, key: str, target: Path, work: Path, progress: Progress
) -> dict[str, Any]:
    """Bake the exhibit's scan into `target` and return the record that is kept beside it.

    work: where an interrupted bake left what it had finished, and where this one does; gone after success. Raises
    ScanError, naming file and remedy, for a scan that cannot be shown as it is, OSError for one that cannot be read.
    """
    from sim_core.mesh.scan import ScanError

    clock, began = time.perf_counter(), time.perf_counter()
    seconds: dict[str, float] = {}

    def lap(name: str) -> None:
        nonlocal clock
        now = time.perf_counter()
        seconds[name], clock = round(now - clock, 2), now

    assert exhibit.file.scan is not None
    (work / "out").mkdir(parents=True, exist_ok=True)
    progress(0.0, "reading")
    try:
        scan, condition = scan_cleaned(exhibit.folder / exhibit.file.scan, content.folder)
    except ScanError as error:
        raise ScanError(f"{exhibit.toml}: scan: {exhibit.file.scan}: {error.what}", error.fix) from error
    found = findings(condition, exhibit.file.scanned, exhibit.file.size_range)
    refuse(found, exhibit.toml)
    workshop = _Workshop(_upright(scan, exhibit), work)
    lap("reading")
    levels = workshop.levels(lambda share: progress(0.15 + 0.35 * share, "thinning"))
    lap("thinning")
    told = {}
    for name, fine in _budgets(exhibit).items():
        begin, end = SPAN[name]
        told[name] = workshop.model(
            name, levels, fine, lambda share, what, b=begin, e=end: progress(b + (e - b) * share, what)
        )
        lap(name)
    seconds["all"] = round(time.perf_counter() - began, 2)
    record = _record(key, condition, found, told, seconds)
    record[FILES] = seal(work / "out", RECORD)
    (work / "out" / RECORD).write_text(text_of(record), "utf-8")
    publish(work / "out", target, RECORD)
    shutil.rmtree(work, ignore_errors=True)
    progress(1.0, "done")
    return record


def _budgets(exhibit: Exhibit) -> dict[str, float]:
    """How far (p99) each model may deviate [m]: a pixel at its nearest view."""
    show = exhibit.file.show
    return {"close": budget(CLOSE_NEAREST, 1.0), "hall": hall_budget(show.nearest, show.hall_error_px)}


def _upright(scan: Scan, exhibit: Exhibit) -> Scan:
    from sim_core.mesh.scan import largest_part, stood

    scanned = exhibit.file.scanned
    kept = largest_part(scan) if scanned.keep == "largest" else scan
    return stood(kept, scanned.metres, scanned.up or "y")


@dataclass(frozen=True)
class _Workshop:
    """An upright scan, and the folder in which what is finished is kept."""

    scan: Scan
    work: Path

    @cached_property
    def fine(self) -> Fine:
        """Sorted once, when it is first measured against."""
        from sim_core.mesh.scan import Fine

        return Fine(self.scan.vertices, self.scan.faces)

    def levels(self, progress: Callable[[float], None]) -> list[Level]:
        """Coarser and coarser meshes, the finest first; read back where they were finished before."""
        from sim_core.mesh.scan import Level, coarsened

        path = self.work / "levels.npz"
        if path.exists():
            with np.load(path) as kept:
                count = len(kept.files) // 3
                return [Level(*(kept[f"{what}{k}"] for what in ("v", "f", "n"))) for k in range(count)]
        many = len(self.scan.faces)
        counts = [MOST["close"]]
        while counts[-1] * STEP >= FEWEST:
            counts.append(int(counts[-1] * STEP))
        counts.append(MOST["hall"])
        found: list[Level] = []
        whole = np.log(max(many / FEWEST, 2.0))
        for left, level in coarsened(self.scan.vertices, self.scan.faces, counts):
            progress(min(1.0, float(np.log(many / left) / whole)))
            if level is not None and (not found or len(level.faces) < len(found[-1].faces)):
                found.append(level)
        arrays: dict[str, Any] = {
            f"{what}{k}": array
            for k, level in enumerate(found)
            for what, array in (("v", level.vertices), ("f", level.faces), ("n", level.normals))
        }
        with written_whole(path) as file:
            np.savez(file, **arrays)
        return found

    def model(
        self, name: str, levels: list[Level], allowed: float, progress: Callable[[float, str], None]
    ) -> dict[str, Any]:
        """Writes out/NAME.glb and returns what was measured of it; read back where it was finished before."""
        from sim_core.mesh.scan import chosen_level

        note, path = self.work / f"{name}.json", self.work / "out" / f"{name}.glb"
        if note.exists() and path.exists():
            return json.loads(note.read_text("utf-8"))
        few = [level for level in levels if len(level.faces) <= MOST[name]] or levels[-1:]
        chosen = chosen_level(self.fine, few, allowed, lambda share: progress(0.25 * share, "measuring"))
        data = self._drawn(name, chosen, lambda share: progress(0.25 + 0.75 * share, "texture"))
        with written_whole(path) as file:
            file.write(data)
        told = {**chosen.as_json(), "bytes": len(data), "pixels": self._pixels(name)}
        with written_whole(note) as file:
            file.write(json.dumps(told).encode())
        return told

    def _pixels(self, name: str) -> int:
        return PIXELS[name] if self.scan.coloured else PLAIN

    def _drawn(self, name: str, chosen: Chosen, progress: Callable[[float], None]) -> bytes:
        from sim_core.mesh.scan import Colours, laid_out, painted, scan_glb

        level = chosen.level
        layout = laid_out(level.vertices, level.faces, self._pixels(name))
        colours = Colours(self.scan, self.fine.surface)
        picture = painted(level, layout, colours, REACH * max(chosen.deviation.p99, 1e-4), progress)
        return scan_glb(level, layout, picture, "scan")


def _record(
    key: str,
    condition: Condition,
    found: tuple[Finding, ...],
    told: dict[str, dict[str, Any]],
    seconds: dict[str, float],
) -> dict[str, Any]:
    """What the hall tells of this bake; every number comes from a measurement."""
    errors: dict[str, float] = {"scan_triangles": condition.triangles}
    for name in ("close", "hall"):
        errors[f"{name}_triangles"] = told[name]["triangles"]
        for figure, value in told[name]["deviation"].items():
            errors[f"{name}_hausdorff_{figure.removesuffix('_m')}"] = value
    return {
        "key": key,
        SCAN: {**told, "condition": condition.as_json(), "remarks": [str(finding) for finding in found]},
        "errors": errors,
        "seconds": seconds,
        "hall_budget_m": told["hall"]["budget_m"],
    }
