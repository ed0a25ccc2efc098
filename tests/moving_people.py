"""People who move as told, for tests of tracking: joints by scipy's rotations, and the same as a BVH file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

OFFSETS: dict[str, tuple[str, tuple[float, float, float]]] = {
    "Hips": ("", (0.0, 0.95, 0.0)),
    "Spine": ("Hips", (0.0, 0.10, -0.01)),
    "Spine1": ("Spine", (0.0, 0.15, -0.01)),
    "Spine2": ("Spine1", (0.0, 0.14, 0.01)),
    "Neck": ("Spine2", (0.0, 0.12, 0.0)),
    "Head": ("Neck", (0.0, 0.10, 0.02)),
    "HeadTop": ("Head", (0.0, 0.15, 0.0)),
}
for _side, _x in (("Left", 1.0), ("Right", -1.0)):
    OFFSETS |= {
        f"{_side}Shoulder": ("Spine2", (0.03 * _x, 0.08, 0.02)),
        f"{_side}Arm": (f"{_side}Shoulder", (0.14 * _x, 0.01, -0.01)),
        f"{_side}ForeArm": (f"{_side}Arm", (0.27 * _x, 0.0, 0.0)),
        f"{_side}Hand": (f"{_side}ForeArm", (0.24 * _x, 0.0, 0.0)),
        f"{_side}HandMiddle1": (f"{_side}Hand", (0.08 * _x, 0.0, 0.0)),
        f"{_side}HandMiddle3": (f"{_side}HandMiddle1", (0.06 * _x, 0.0, 0.0)),
        f"{_side}HandThumb3": (f"{_side}Hand", (0.06 * _x, -0.01, 0.06)),
        f"{_side}UpLeg": ("Hips", (0.09 * _x, -0.06, 0.0)),
        f"{_side}Leg": (f"{_side}UpLeg", (0.0, -0.42, 0.0)),
        f"{_side}Foot": (f"{_side}Leg", (0.0, -0.41, 0.0)),
        f"{_side}ToeBase": (f"{_side}Foot", (0.0, -0.05, 0.13)),
    }
NAMES = tuple(OFFSETS)
PARENTS = tuple(NAMES.index(parent) if parent else -1 for parent, _ in OFFSETS.values())
KINDS = ("rest", "walk", "turn", "salute", "dance")


@dataclass(frozen=True)
class Person:
    """vectors (T, N, 3) rotation vectors [rad] of the joints NAMES, ways (T, 3) [m] of the hips, rate [Hz]."""

    vectors: np.ndarray
    ways: np.ndarray
    rate: float

    def places(self) -> np.ndarray:
        """Where the joints are, (T, N, 3) [m]."""
        count = len(self.ways)
        out = np.zeros((count, len(NAMES), 3))
        turns: list[Rotation] = []
        for joint, (parent, (_, offset)) in enumerate(zip(PARENTS, OFFSETS.values(), strict=True)):
            own = Rotation.from_rotvec(self.vectors[:, joint])
            if parent < 0:
                turns.append(own)
                out[:, joint] = np.array(offset) + self.ways
            else:
                turns.append(turns[parent] * own)
                out[:, joint] = out[:, parent] + turns[parent].apply(np.tile(offset, (count, 1)))
        return out

    def bvh(
        self, order: str = "ZYX", *, unit: float = 0.01, everywhere: bool = False, decimals: int = 9
    ) -> str:
        """The same as a BVH file: rotation channels in that order, lengths in that unit [m]; everywhere: position
        channels on every joint; joints without children become end sites, but those that would turn."""
        lines = ["HIERARCHY"]
        columns: list[np.ndarray] = []
        self._write(lines, columns, 0, 0, (order, unit, everywhere))
        rows = np.concatenate(columns, axis=1)
        lines += ["MOTION", f"Frames: {len(rows)}", f"Frame Time: {1.0 / self.rate:.9f}"]
        lines += [" ".join(f"{value:.{decimals}f}" for value in row) for row in rows]
        return "\n".join(lines) + "\n"

    def _write(
        self, lines: list[str], columns: list, joint: int, depth: int, how: tuple[str, float, bool]
    ) -> None:
        order, unit, everywhere = how
        pad, offset = "\t" * depth, np.array(OFFSETS[NAMES[joint]][1])
        shown = " ".join(f"{value:.9f}" for value in offset / unit)
        lines += [f"{pad}{'JOINT' if joint else 'ROOT'} {NAMES[joint]}", pad + "{", f"{pad}\tOFFSET {shown}"]
        moves = everywhere or joint == 0
        channels = [f"{axis}position" for axis in "XYZ"] if moves else []
        channels += [f"{axis}rotation" for axis in order]
        lines.append(f"{pad}\tCHANNELS {len(channels)} {' '.join(channels)}")
        if moves:
            way = self.ways if joint == 0 else np.zeros(self.ways.shape)
            columns.append((offset + way) / unit)
        columns.append(Rotation.from_rotvec(self.vectors[:, joint]).as_euler(order.upper(), degrees=True))
        children = [child for child, parent in enumerate(PARENTS) if parent == joint]
        for child in children:
            self._write(lines, columns, child, depth + 1, how)
        if not children:
            lines += [f"{pad}\tEnd Site", pad + "\t{", f"{pad}\t\tOFFSET 0 0 0", pad + "\t}"]
        lines.append(pad + "}")


def person(kind: str, seconds: float = 4.0, rate: float = 30.0, seed: int = 0) -> Person:
    """Somebody who rests, walks, turns about, salutes, or dances (every joint its own way, from a seed)."""
    time = np.arange(max(1, round(seconds * rate))) / rate
    vectors, ways = np.zeros((len(time), len(NAMES), 3)), np.zeros((len(time), 3))

    def turn(name: str, axis: int, degrees: np.ndarray | float) -> None:
        vectors[:, NAMES.index(name), axis] += np.radians(degrees)

    swing = np.sin(2.0 * np.pi * 0.95 * time)
    for side, x in (("Left", 1.0), ("Right", -1.0)):
        turn(f"{side}Arm", 2, -72.0 * x)
        turn(f"{side}ForeArm", 1, -15.0 * x)
    if kind in ("walk", "turn"):
        ways[:, 2] = 1.2 * time if kind == "walk" else 0.0
        ways[:, 1] = 0.02 * np.cos(4.0 * np.pi * 0.95 * time)
        turn("Hips", 1, 5.0 * swing + (75.0 * time if kind == "turn" else 0.0))
        turn("Spine1", 1, -6.0 * swing)
        for side, x in (("Left", 1.0), ("Right", -1.0)):
            turn(f"{side}UpLeg", 0, -25.0 * x * swing)
            turn(f"{side}Leg", 0, 25.0 - 25.0 * np.cos(2.0 * np.pi * 0.95 * time - x))
            turn(f"{side}Arm", 1, -22.0 * swing)
            turn(f"{side}ForeArm", 1, -10.0 * x * (1.0 + swing))
    if kind == "salute":
        share = 0.5 - 0.5 * np.cos(2.0 * np.pi * time / 4.0)
        turn("Spine1", 0, 20.0 * share)
        turn("Spine2", 0, 15.0 * share)
        for side, x in (("Left", 1.0), ("Right", -1.0)):
            turn(f"{side}Shoulder", 1, -14.0 * x * share)
            turn(f"{side}Shoulder", 2, 20.0 * x * share)
            turn(f"{side}Arm", 1, -52.0 * x * share)
            turn(f"{side}Arm", 2, 60.0 * x * share)
            turn(f"{side}ForeArm", 1, -58.0 * x * share)
    if kind == "dance":
        random = np.random.default_rng(seed)
        for joint in range(len(NAMES)):
            for hertz in (0.4, 0.9, 1.6):
                size, phase = random.normal(0.0, 0.1 / hertz**0.5, 3), random.uniform(0.0, 2.0 * np.pi, 3)
                vectors[:, joint] += size * np.sin(2.0 * np.pi * hertz * time[:, None] + phase)
        vectors[:, 0, 1] += 0.8 * time
        ways[:, 0], ways[:, 1] = 0.6 * np.sin(time), 0.06 * np.sin(9.0 * time)
    return Person(vectors, ways, rate)
