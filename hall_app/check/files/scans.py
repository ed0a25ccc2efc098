"""Scans: can they be read, are they whole, in metres and upright, and do their models lie ready?"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from hall_app.check.files.bakes import bake_state
from hall_app.content.bakes.store import SCAN, baked_here, key_now, read_record
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.scans import Finding, condition_of, findings
from hall_app.content.problems import Problem

if TYPE_CHECKING:
    from sim_core.mesh.scan import Condition

__all__ = ["scan_problems", "scan_remarks"]


def scan_problems(content: Content) -> list[Problem]:
    """Scans of which no model can be made; those that can, but are not baked, or from older inputs."""
    found = []
    for exhibit in _scanned(content):
        told = _told(content, exhibit)
        faults = (
            [told] if isinstance(told, Problem) else [_problem(exhibit, one) for one in told if one.stops]
        )
        found += faults or bake_state(content, exhibit)
    return found


def scan_remarks(content: Content) -> list[Problem]:
    """What is to be known of scans and is no fault: holes, loose parts, what was left out."""
    found = []
    for exhibit in _scanned(content):
        told = _told(content, exhibit)
        if not isinstance(told, Problem) and not any(one.stops for one in told):  # lengths are known by then
            found += [_problem(exhibit, one) for one in told]
    return found


def _scanned(content: Content) -> Iterator[Exhibit]:
    return (exhibit for exhibit in content.exhibits if exhibit.file.scan is not None)


def _problem(exhibit: Exhibit, finding: Finding) -> Problem:
    return Problem(exhibit.toml, finding.key, finding.what, finding.fix)


def _told(content: Content, exhibit: Exhibit) -> tuple[Finding, ...] | Problem:
    """What there is to say of a scan, or why it cannot be read."""
    from sim_core.mesh.scan import ScanError

    assert exhibit.file.scan is not None
    try:
        condition = _baked_condition(content, exhibit) or condition_of(
            exhibit.folder / exhibit.file.scan, content.folder
        )
    except ScanError as error:
        return Problem(exhibit.toml, "scan", f"{exhibit.file.scan}: {error.what}", error.fix)
    except OSError as error:
        return Problem(exhibit.toml, "scan", f"cannot be read ({error.strerror})", "check the file")
    except MemoryError:
        return Problem(
            exhibit.toml, "scan", "needs more memory than there is", "decimate it in the scanning software"
        )
    return findings(condition, exhibit.file.scanned, exhibit.file.size_range)


def _baked_condition(content: Content, exhibit: Exhibit) -> Condition | None:
    """What its bake noted of this very scan, so that millions of triangles are not looked through again."""
    from sim_core.mesh.scan import Condition

    record = read_record(baked_here(exhibit))
    if record is None or record.get("key") != key_now(content, exhibit):
        return None
    try:
        return Condition.from_json(record[SCAN]["condition"])
    except (KeyError, TypeError, ValueError):
        return None
