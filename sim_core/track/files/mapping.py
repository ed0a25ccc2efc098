"""Which joints of a source are which of a Kinect's: mapping files (TOML), by name or found by their marks."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import FileProblem
from sim_core.track.recording import Recording
from sim_core.track.skeletons import KINECT
from sim_core.validation import finite, integer
from sim_core.validation.files import read_toml, shown

__all__ = ["MAPPINGS", "JointMapping", "load_mapping", "mapping_for"]

FOLDER = Path(__file__).with_name("mappings")
MAPPINGS = ("default", "cmu", "mixamo", "figure")
"""Mappings by name; any other is the path of a file."""
KEYS = ("words", "marks", "unit", "skip", "joints")
SIDES = ({"Side": "Left", "S": "L", "s": "l"}, {"Side": "Right", "S": "R", "s": "r"})
UNITS = (1.0, 0.01, 0.0254, 0.001, 0.056444)  # [m]: metres, centimetres, inches, millimetres, cgspeed's
TALL = 1.35  # [m] of a person from ankle to head, by which a unit is told


@dataclass(frozen=True)
class JointMapping:
    """name; words; marks: beginnings of names that all must be there; unit [m] of the source, None: told by stature;
    skip: frames at the start that are no motion; joints: for each of the Kinect's the sources in the order in which
    they are tried, "A", "A + B" (the mean of both) or "A + B if C"."""

    name: str
    words: str
    marks: tuple[str, ...]
    unit: float | None
    skip: int
    joints: Mapping[str, tuple[str, ...]]

    def fits(self, names: Sequence[str]) -> bool:
        """Whether every mark begins a name."""
        return bool(self.marks) and all(
            any(name.lower().startswith(mark.lower()) for name in names) for mark in self.marks
        )

    def applied(
        self, names: Sequence[str], places: np.ndarray, time: np.ndarray, unit: float | None = None
    ) -> Recording:
        """A recording of places (T, N, 3) of the named joints at time (T,) [s]; unit [m]: in place of the mapping's.

        What the mapping leaves out lies at the joint it hangs on, and is named.
        """
        known = {plain(name): number for number, name in reversed(list(enumerate(names)))}
        told: list[str] = []
        skip = self.skip if len(places) > self.skip else 0
        if skip:
            told.append(f"frames at the start left out: {skip}, no motion, as mapping {self.name!r} says")
        elif self.skip:
            told.append(
                f"no frame behind the first {self.skip}, no motion as mapping {self.name!r} says: all kept"
            )
        places, time = places[skip:], time[skip:]
        out = np.zeros((len(places), len(KINECT.joints), 3))
        left_out, order = [], [KINECT.root, *(int(child) for child in KINECT.bones[:, 1])]
        for joint in order:
            sources = _first(self.joints.get(KINECT.joints[joint], ()), known)
            if sources:
                out[:, joint] = places[:, sources].mean(1)
            elif joint == KINECT.root:
                out[:, joint] = places[:, 0]
                told.append(
                    f"{KINECT.joints[joint]} is {shown(names[0])}, the first joint: none has a name for it"
                )
            else:
                out[:, joint] = out[:, KINECT.parents[joint]]
                left_out.append(KINECT.joints[joint])
        scale = unit if unit is not None else self.unit if self.unit is not None else unit_of(out)
        if left_out:
            told.append(
                f"mapping {self.name!r} finds no {', '.join(left_out)}: each lies at the joint it hangs on"
            )
        joints = out * scale
        return Recording(KINECT, time, joints, joints.copy(), tuple(left_out), tuple(told))


def plain(name: str) -> str:
    """A name without case, signs and what stands before a colon; an end site keeps its mark."""
    tail = name.rsplit(":", 1)[-1].lower()
    return re.sub(r"[^a-z0-9/#]", "", tail)


def _first(choices: Sequence[str], known: Mapping[str, int]) -> list[int]:
    for choice in choices:
        names, _, condition = choice.partition(" if ")
        wanted = [plain(part) for part in names.split("+")]
        if all(one in known for one in wanted) and (not condition or plain(condition) in known):
            return [known[one] for one in wanted]
    return []


def unit_of(joints: np.ndarray) -> float:
    """The unit [m] in which a person of joints (T, J, 3) is nearest to a grown one, by bones from ankle to head."""
    chain = ("AnkleLeft", "KneeLeft", "HipLeft", "SpineBase", "SpineMid", "SpineShoulder", "Neck", "Head")
    there = joints[:, [KINECT.joints.index(name) for name in chain]]
    size = float(np.median(np.linalg.norm(np.diff(there, axis=1), axis=2).sum(1)))
    if not size > 0.0:
        return 1.0
    return min(UNITS, key=lambda unit: abs(np.log(size * unit / TALL)))


@lru_cache(maxsize=16)
def load_mapping(name: str) -> JointMapping:
    """The mapping of that name, or of the file at that path.

    Raises FileProblem naming file, key, what is wrong and the remedy.
    """
    path = FOLDER / f"{name}.toml" if name in MAPPINGS else Path(name)
    if name not in MAPPINGS and path.suffix.lower() != ".toml":
        raise FileProblem(f"{name}: no mapping – there are {', '.join(MAPPINGS)}, or give a file (.toml)")
    table = read_toml(path, "a mapping file (TOML)")
    if unknown := [key for key in table if key not in KEYS]:
        raise FileProblem(f"{path}: {unknown[0]}: unknown key – there are {', '.join(KEYS)}")
    joints = table.get("joints")
    if not isinstance(joints, dict):
        raise FileProblem(f"{path}: joints: missing – give a table of SpineBase = [names of the source]")
    marks = _texts(path, "marks", table.get("marks", []))
    unit = None if "unit" not in table else finite(f"{path}: unit", table["unit"], least=1e-9, most=1e6)
    skip = integer(f"{path}: skip", table.get("skip", 0), 0, "give frames at the start, 0 or more")
    return JointMapping(path.stem, str(table.get("words", "")), marks, unit, skip, _both_sides(path, joints))


def _both_sides(path: Path, table: Mapping[str, Any]) -> dict[str, tuple[str, ...]]:
    out: dict[str, tuple[str, ...]] = {}
    for key, value in table.items():
        choices = _texts(path, f"joints.{key}", value)
        for side in SIDES if "{" in key else ({},):
            joint, *filled = (_filled(text, side) for text in (key, *choices))
            for text in filled:
                names, given, condition = text.partition(" if ")
                if not all(map(plain, [*names.split("+"), *([condition] if given else [])])):
                    raise FileProblem(
                        f"{path}: joints.{key}: {shown(text)} – a name is missing: "
                        "'A', 'A + B' or 'A + B if C' is meant"
                    )
            if joint not in KINECT.joints:
                raise FileProblem(f"{path}: joints.{key}: no joint – there are {', '.join(KINECT.joints)}")
            out[joint] = tuple(filled)
    return out


def _filled(text: str, side: Mapping[str, str]) -> str:
    for name, word in side.items():
        text = text.replace(f"{{{name}}}", word)
    return text


def _texts(path: Path, key: str, value: object) -> tuple[str, ...]:
    if isinstance(value, str):
        value = [value]
    if not isinstance(value, list) or not all(isinstance(one, str) and one for one in value):
        raise FileProblem(f"{path}: {key}: {shown(value)} – a name or a list of names is meant")
    return tuple(value)


def mapping_for(names: Sequence[str]) -> JointMapping:
    """The mapping whose marks the names bear; the default one for others."""
    for name in MAPPINGS:
        if (mapping := load_mapping(name)).fits(names):
            return mapping
    return load_mapping("default")
