"""Path data of SVG as polylines: lines, Bézier pieces and elliptic arcs."""

import re

import numpy as np

from sim_core.mesh.curves import arc_points, bezier_points

__all__ = ["path_lines"]

FLAGS = re.compile(r"\s*,?\s*([01])\s*,?\s*([01])")  # of an arc; they may stand without a space between
TOKENS = re.compile(r"[MmLlHhVvCcSsQqTtAaZz]|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
COUNTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7}


def _tokens(text: str) -> list[str]:
    """Command letters and numbers of path data; the flags of an arc are single digits, however close they stand."""
    found: list[str] = []
    at, kind, count = 0, "", 0
    while at < len(text):
        if kind == "A" and count % 7 == 3 and (flags := FLAGS.match(text, at)):
            found += flags.groups()
            at, count = flags.end(), count + 2
            continue
        match = TOKENS.search(text, at)
        if match is None:
            break
        found.append(match[0])
        at = match.end()
        kind, count = (match[0].upper(), 0) if match[0].isalpha() else (kind, count + 1)
    return found


def path_lines(text: str) -> list[tuple[np.ndarray, bool]]:
    """The subpaths of path data as polylines, curves in short steps."""
    tokens = _tokens(text)
    found: list[tuple[np.ndarray, bool]] = []
    points: list[np.ndarray] = []
    here, before, command, k = np.zeros(2), None, "", 0
    while k < len(tokens):
        if tokens[k].isalpha():
            command, k = tokens[k], k + 1
            if command in "Zz":
                if points:
                    found.append((np.array(points), True))
                    here, points = points[0], []
                continue
        kind = command.upper()
        if kind not in COUNTS or k + COUNTS[kind] > len(tokens):
            raise ValueError(f"path data end within {command or 'a number'!r}")
        v = [float(t) for t in tokens[k : k + COUNTS[kind]]]
        k += COUNTS[kind]
        if kind == "M":
            if len(points) > 1:
                found.append((np.array(points), False))
            here = np.array(v) + (here if command == "m" else 0)
            points, before, command = [here], None, "l" if command == "m" else "L"
            continue
        if not points:
            points = [here]
        steps, before = _piece(kind, v, here, here if command.islower() else np.zeros(2), before)
        points.extend(steps)
        here = points[-1]
    if len(points) > 1:
        found.append((np.array(points), False))
    return found


def _piece(kind: str, v: list[float], here, origin, before):
    """Points after `here` for one path command, and (kind, control point) for a smooth successor."""
    if kind in "HV":
        end = here.copy()
        end["HV".index(kind)] = v[0] + origin["HV".index(kind)]
        return [end], None
    if kind == "L":
        return [np.array(v) + origin], None
    if kind == "A":
        return arc_points(here, v[:2], v[2], v[3] != 0, v[4] != 0, np.array(v[5:]) + origin), None
    given = [np.array(v[i : i + 2]) + origin for i in range(0, len(v), 2)]
    family = "C" if kind in "CS" else "Q"
    if kind in "ST":
        mirrored = 2 * here - before[1] if before is not None and before[0] == family else here
        given = [mirrored, *given]
    return bezier_points([here, *given]), (family, given[-2])
