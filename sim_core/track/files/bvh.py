"""BVH files: a hierarchy of joints with channels in any order, and a row of numbers for every frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim_core.track.files.words import Words
from sim_core.track.recording import MOST_FRAMES
from sim_core.validation.files import read_text, shown

__all__ = ["END", "Bvh", "read_bvh"]

END = "/end"
"""What the name of an end site is, behind the name of the joint that it ends."""
WHAT = "a BVH file (HIERARCHY, MOTION)"
CHANNELS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")
MOST_BYTES = 200_000_000  # ten minutes of a body with all its fingers
MOST_JOINTS = 2_000
MOST_PLACES = 10_000_000  # of all joints in all frames: 1 GB of places and turns
BLOCK = 1_000_000  # characters of numbers that are read at once
MOST_CHANNELS = 64  # of one joint


@dataclass(frozen=True)
class Bvh:
    """A hierarchy and its motion, in the file's own unit of length.

    names: joints and end sites ("Head/end"), parents first; parents (N,) of each, -1 for a root; offsets (N, 3) from
    the parent; channels: of each, as CHANNELS has them, in the order of the file; frames (T, C): a number a channel
    and frame, lengths in the file's unit and angles in degrees; seconds: from frame to frame.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: np.ndarray
    channels: tuple[tuple[str, ...], ...]
    frames: np.ndarray
    seconds: float

    def _ways(self, joint: int, column: int) -> bool:
        """Whether the position channels of a joint, whose first channel has that column, are ways from its offset."""
        offset, middle = [], []
        for number, channel in enumerate(self.channels[joint]):
            if channel.endswith("position"):
                offset.append(self.offsets[joint, "XYZ".index(channel[0])])
                middle.append(np.median(self.frames[:, column + number]))
        return bool(offset) and bool(np.linalg.norm(np.subtract(middle, offset)) > np.linalg.norm(middle))

    def moved(self) -> tuple[np.ndarray, np.ndarray]:
        """Places (T, N, 3) and rotations (T, N, 3, 3) of all joints in the world, by forward kinematics.

        The rotations of a joint work in the order of the file, the first outermost. Position channels say where the
        joint lies in its parent's frame, in place of the offset; those of a joint that is no root and that stay
        nearer to nothing than to the offset are ways from it, and are added.
        """
        count, total = len(self.frames), len(self.names)
        places, turns = np.zeros((count, total, 3)), np.zeros((count, total, 3, 3))
        column = 0
        for joint, (parent, channels) in enumerate(zip(self.parents, self.channels, strict=True)):
            own = np.broadcast_to(np.eye(3), (count, 3, 3))
            shift = np.broadcast_to(self.offsets[joint], (count, 3)).copy()
            added = parent >= 0 and self._ways(joint, column)
            for channel in channels:
                values = self.frames[:, column]
                column += 1
                axis = "XYZ".index(channel[0])
                if channel.endswith("position"):
                    start = self.offsets[joint, axis] if added else 0.0
                    shift[:, axis] = start + values
                else:
                    own = own @ axis_turns(axis, np.radians(values))
            if parent < 0:
                turns[:, joint], places[:, joint] = own, shift
            else:
                turns[:, joint] = turns[:, parent] @ own
                places[:, joint] = places[:, parent] + (turns[:, parent] @ shift[..., None])[..., 0]
        return places, turns


def axis_turns(axis: int, angles: np.ndarray) -> np.ndarray:
    """Rotations (T, 3, 3) about a coordinate axis by angles (T,) [rad]."""
    cosine, sine = np.cos(angles), np.sin(angles)
    out = np.zeros((len(angles), 3, 3))
    after, last = (axis + 1) % 3, (axis + 2) % 3
    out[:, axis, axis] = 1.0
    out[:, after, after] = out[:, last, last] = cosine
    out[:, after, last], out[:, last, after] = -sine, sine
    return out


@dataclass
class _Tree:
    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[tuple[float, ...]] = field(default_factory=list)
    channels: list[tuple[str, ...]] = field(default_factory=list)
    times: dict[str, int] = field(default_factory=dict)  # that a name was given

    def named(self, name: str, parent: int) -> int:
        """A joint more, whose name is made its own; its number."""
        known = name
        while known in self.times:  # two end sites of one joint, or a file that names two joints alike
            self.times[name] += 1
            known = f"{name}#{self.times[name]}"
        self.times[known] = 1
        self.names.append(known)
        self.parents.append(parent)
        return len(self.names) - 1


def read_bvh(path: Path) -> Bvh:
    """The hierarchy and the motion of a BVH file.

    Raises FileProblem naming file, line and column of what is wrong, and what should stand there.
    """
    words = Words(path, read_text(path, WHAT, MOST_BYTES))
    words.expect("HIERARCHY")
    tree = _Tree()
    while words.expect("ROOT", "MOTION") == "ROOT":
        _joint(words, tree, -1)
    if not tree.names:
        raise words.problem("MOTION before any ROOT – a hierarchy of joints is meant")
    count, seconds = _clock(words, len(tree.names))
    frames = _numbers(words, count, sum(map(len, tree.channels)))
    return Bvh(
        tuple(tree.names),
        tuple(tree.parents),
        np.array(tree.offsets, float),
        tuple(tree.channels),
        frames,
        seconds,
    )


def _joint(words: Words, tree: _Tree, root: int) -> None:
    """One root and all that hangs on it; no recursion, so that a file may nest as deep as it likes."""
    open_joints = [_begin(words, tree, root)]
    while open_joints:
        word = words.expect("JOINT", "End", "}")
        if word == "JOINT":
            open_joints.append(_begin(words, tree, open_joints[-1]))
        elif word == "End":
            words.expect("Site")
            words.rest_of_line()  # some give it a name
            parent = open_joints[-1]
            _add(words, tree, tree.names[parent] + END, parent)
            words.expect("{")
            tree.offsets.append(_offset(words))
            tree.channels.append(())
            words.expect("}")
        else:
            open_joints.pop()


def _begin(words: Words, tree: _Tree, parent: int) -> int:
    """Reads name, offset and channels of a joint; its number."""
    name = words.rest_of_line()
    if not name:
        raise words.problem("the name of a joint is missing")
    number = _add(words, tree, name, parent)
    words.expect("{")
    tree.offsets.append(_offset(words))
    channels: list[str] = []
    if (words.peek() or "").upper() == "CHANNELS":
        words.next("CHANNELS")
        for _ in range(words.whole("the number of channels", MOST_CHANNELS)):
            channel = words.expect(*CHANNELS)
            if channel in channels:
                raise words.problem(f"{channel} a second time – each channel of a joint once")
            channels.append(channel)
    tree.channels.append(tuple(channels))
    return number


def _add(words: Words, tree: _Tree, name: str, parent: int) -> int:
    if len(tree.names) >= MOST_JOINTS:
        raise words.problem(f"more than {MOST_JOINTS} joints")
    return tree.named(name, parent)


def _offset(words: Words) -> tuple[float, ...]:
    words.expect("OFFSET")
    return tuple(words.number(f"the offset's {axis}") for axis in "xyz")


def _clock(words: Words, joints: int) -> tuple[int, float]:
    """The number of frames, of that many joints, and the seconds from one to the next."""
    words.expect("Frames:")
    count = words.whole("the number of frames", MOST_FRAMES)
    if count == 0:
        raise words.problem("no frames – a motion of one frame or more is meant")
    if count * joints > MOST_PLACES:
        told = f"{count} frames of {joints} joints, ends among them"
        raise words.problem(f"{told} – at most {MOST_PLACES // joints}; cut the motion into parts")
    words.expect("Frame")
    words.expect("Time:")
    seconds = words.number("the frame time")
    if not 1e-6 < seconds <= 1e3:
        raise words.problem(f"{seconds:g} – a frame time in seconds above 0 is meant, such as 0.0333333")
    return count, seconds


def _numbers(words: Words, count: int, columns: int) -> np.ndarray:
    """The frames (T, C); what is missing, too much or no number is found again with its place."""
    text, begin = words.rest()
    numbers = _finite(text)
    if numbers is not None and numbers.size == count * columns:
        return numbers.reshape(count, columns)
    end = text.rstrip()
    frame, at = 0, begin
    for line in end.split("\n"):
        cells = line.split()
        for number, cell in enumerate(cells):
            try:
                bad = not abs(float(cell)) < 1e12
            except ValueError:
                bad = True
            if bad:
                column = _place(line, number)
                raise words.problem(f"frame {frame}: {shown(cell)} is not a finite number", at + column)
        if cells and len(cells) != columns:
            told = f"frame {frame}: {len(cells)} numbers – the hierarchy has {columns} channels"
            raise words.problem(told, at + _place(line, min(columns, len(cells) - 1)))
        frame += bool(cells)
        at += len(line) + 1
    raise words.problem(f"{frame} frames of numbers – 'Frames:' says {count}", begin + len(end))


def _finite(text: str) -> np.ndarray | None:
    """All numbers of a text (N,), or None where one is none or not finite."""
    found, at = [np.zeros(0)], 0
    while at < len(text):
        end = text.find("\n", at + BLOCK)
        end = len(text) if end < 0 else end
        try:
            found.append(np.array(text[at:end].split(), float))
        except ValueError:
            return None
        if not (np.abs(found[-1]) < 1e12).all():  # NaN is not
            return None
        at = end
    return np.concatenate(found)


def _place(line: str, number: int) -> int:
    """Where the word of that number begins in a line."""
    at = 0
    for _ in range(number + 1):
        at += len(line[at:]) - len(line[at:].lstrip())
        begin = at
        while at < len(line) and not line[at].isspace():
            at += 1
    return begin
