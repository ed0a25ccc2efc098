"""What a baked garment was measured to be, against what it must be: the table of `hall check --garments`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hall_app.check.garments.limits import Worn, limits_of, writer
from hall_app.check.garments.measurement import Measured, measured_again
from hall_app.content.bakes.record import FILES
from hall_app.content.bakes.steps import beneath_budget, hall_budget
from hall_app.content.bakes.store import bake_fault, baked_here, key_now, layer_files, read_record
from hall_app.content.files import BAKED, MOTION
from hall_app.content.folder import Content, Exhibit
from hall_app.content.loading import load
from hall_app.content.schema.exhibit import Show

__all__ = ["Line", "figure_lines", "garment_lines", "garments_checked", "table"]

Numbers = Mapping[str, Any]
SAME = 2e-3  # share by which a figure measured again may differ
ALIKE = 0.35  # the same of a distance of two surfaces, which is measured again on a seventh of the samples


@dataclass(frozen=True)
class Line:
    """One figure of one garment: its value, the limit in words, and whether it keeps it. Without a value: what is
    wrong with the garment's files."""

    exhibit: str
    name: str
    value: float | None
    limit: str
    kept: bool

    def as_json(self) -> dict[str, Any]:
        """The line as plain values."""
        return dict(self.__dict__)


def garment_lines(content: Content) -> list[Line]:
    """The figures of every garment's bake beside its exhibit; a line without a value for each fault of its files."""
    lines = []
    for problem in content.problems:
        if problem.file.startswith("exhibits/"):  # one that cannot be read may hold a garment
            lines.append(Line(problem.file.split("/")[1], "exhibit", None, str(problem), False))
    for exhibit in content.exhibits:
        if exhibit.file.outfit is not None:
            lines += _of(content, exhibit)
    return lines


def _of(content: Content, exhibit: Exhibit) -> list[Line]:
    folder, fix = baked_here(exhibit), f"run: hall build --exhibit {exhibit.id}"

    def wrong(name: str, what: str) -> Line:
        return Line(exhibit.id, name, None, f"{what} – {fix}", False)

    record = read_record(folder)
    if record is None:
        return [wrong("bake", "has not been baked, or not whole")]
    lines = []
    if record.get("key") != key_now(content, exhibit):
        lines.append(wrong("bake", "is stale: an input or the engine changed since"))
    if fault := bake_fault(folder):
        return [*lines, wrong("files", f"baked/{fault[0]} {fault[1]}")]
    layers = record.get("layers")
    if not isinstance(layers, list) or not layers:
        return [*lines, wrong("bake", "does not tell its layers")]
    try:
        again = measured_again(folder, len(layers))
    except Exception as error:  # files of whatever kind, whose digests are right
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        return [*lines, wrong("files", f"cannot be measured ({reason})")]
    told = [layer.get("digest") if isinstance(layer, dict) else None for layer in layers]
    for name, digest, noted in zip(layer_files(len(layers)), again.digests, told, strict=True):
        if digest != noted:
            lines.append(wrong("digest", f"{name} is not the garment that bake.json tells of"))
    lines += [wrong("files", fault) for fault in again.faults]
    return lines + figure_lines(exhibit.id, exhibit.file.show, record, again)


def figure_lines(exhibit: str, show: Show, record: Numbers, again: Measured) -> list[Line]:
    """Each limit of the layers, the outermost first, against the record's figure; that is believed only where measuring
    again agrees."""
    told, lines = _told(record), []
    files = record.get(FILES)
    moving = isinstance(files, dict) and MOTION.removeprefix(BAKED) in files
    asked = [
        limits_of(worn, _deviation(worn, show, moving), again.worn, moving=moving)
        for worn in again.worn[::-1]
    ]
    for limit in [limit for limits in asked for limit in limits]:
        value, found = told.get(limit.name), again.figures.get(limit.name)
        if value is None:
            value = found
        if not isinstance(value, int | float) or isinstance(value, bool):
            what = "not measured" if value is None else f"{str(value)[:40]!r} is no number"
            lines.append(Line(exhibit, limit.name, None, f"{what} – bake it again", False))
        elif found is not None and not _agree(limit.name, value, found):
            what = f"measured again, bake.json says {writer(limit.name)(value)} – bake it again"
            lines.append(Line(exhibit, limit.name, float(found), what, False))
        else:
            lines.append(Line(exhibit, limit.name, float(value), limit.words(), limit.keeps(value)))
    return lines


def _told(record: Numbers) -> dict[str, Any]:
    """The record's figures by the limits' names."""
    errors, seconds, stages = (
        part if isinstance(part, dict) else {} for part in map(record.get, ("errors", "seconds", "stages"))
    )
    return {**errors, "drape_s": seconds.get("drape"), "drape_cpu_s": stages.get("drape_cpu")}


def _deviation(worn: Worn, show: Show, moving: bool) -> float:
    """How far a garment's hall model may be from the close one [m], p99: what it was thinned to."""
    if worn.beneath:
        return beneath_budget(show)
    return hall_budget(show.nearest, show.hall_error_px, moving=moving)


def _agree(name: str, told: float, found: float) -> bool:
    """Whether a figure of the record is what measuring again finds."""
    if "hausdorff" in name:
        return abs(told - found) <= ALIKE * found + 2e-4
    if "strain" in name or name.endswith("_m"):
        return abs(told - found) <= SAME * found + 1e-5
    return told == found


def table(lines: list[Line]) -> str:
    """The lines as text, one garment below the other."""
    rows, last = [], ""
    for line in lines:
        if line.exhibit != last:
            rows.append(line.exhibit)
            last = line.exhibit
        value = "–" if line.value is None else writer(line.name)(line.value)
        rows.append(f"  {'  ' if line.kept else '! '}{line.name:<24} {value:>12}   {line.limit}".rstrip())
    broken = sum(not line.kept for line in lines)
    rows.append("all limits kept" if not broken else f"{broken} of {len(lines)} figures break their limit")
    return "\n".join(rows) + "\n"


def garments_checked(folder: Path, *, as_json: bool) -> tuple[str, int]:
    """What `hall check --garments` writes, and its exit status."""
    lines = garment_lines(load(folder))
    if as_json:
        text = json.dumps(
            {"folder": str(folder), "figures": [line.as_json() for line in lines]},
            ensure_ascii=False,
            indent=1,
        )
        return text + "\n", int(not all(line.kept for line in lines))
    return table(lines), int(not all(line.kept for line in lines))
