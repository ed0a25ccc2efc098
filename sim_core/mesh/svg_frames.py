"""Where elements of an SVG file stand: transforms, and the viewports of nested <svg> and <symbol>."""

import re
from math import cos, radians, sin, tan

import numpy as np

__all__ = ["NUMBER", "shifted", "transform_frame", "viewport_frame"]

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
ALIGNED = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}


def transform_frame(text: str) -> np.ndarray:
    """The (3, 3) matrix of a transform attribute; raises ValueError."""
    frame = np.eye(3)
    for name, inner in re.findall(r"([a-zA-Z]+)\s*\(([^)]*)\)", text):
        v = [float(n) for n in NUMBER.findall(inner)]
        step = np.eye(3)
        if name == "matrix" and len(v) == 6:
            step[:2] = [[v[0], v[2], v[4]], [v[1], v[3], v[5]]]
        elif name == "translate" and v:
            step[:2, 2] = v[0], v[1] if len(v) > 1 else 0
        elif name == "scale" and v:
            step[0, 0], step[1, 1] = v[0], v[-1]
        elif name == "rotate" and v:
            c, s = cos(radians(v[0])), sin(radians(v[0]))
            x, y = v[1:3] if len(v) > 2 else (0.0, 0.0)
            step[:2] = [[c, -s, x - c * x + s * y], [s, c, y - s * x - c * y]]
        elif name in ("skewX", "skewY") and v:
            step[(0, 1) if name == "skewX" else (1, 0)] = tan(radians(v[0]))
        else:
            raise ValueError(f"transform {name[:20]}({inner[:30]}) cannot be read")
        frame = frame @ step
    return frame


def shifted(x: float, y: float) -> np.ndarray:
    """The (3, 3) matrix of a shift."""
    return np.array([[1.0, 0, x], [0, 1, y], [0, 0, 1]])


def viewport_frame(
    view_box: str, aspect: str, size: tuple[float, float]
) -> tuple[np.ndarray, tuple[float, float]]:
    """The (3, 3) matrix from a viewBox to a viewport of `size`, and the size in its units (SVG 2, chapter 8).

    aspect: the preserveAspectRatio attribute.  Without a viewBox nothing changes. Raises ValueError for a box of no
    size, or a viewport whose size nothing tells.
    """
    box = [float(v) for v in NUMBER.findall(view_box)]
    if len(box) != 4:
        return np.eye(3), size
    if not (box[2] > 0 and box[3] > 0 and np.isfinite(size).all()):
        raise ValueError(f"viewBox {view_box[:40]!r} of a nested drawing without a size")
    scale = np.array(size) / box[2:]
    words = (aspect.split() or ["xMidYMid"])[:2]
    found = re.fullmatch(r"x(Min|Mid|Max)Y(Min|Mid|Max)", words[0])
    if words[0] != "none":
        scale[:] = scale.max() if words[1:] == ["slice"] else scale.min()
    align = np.array([ALIGNED[k] for k in found.groups()]) if found else np.zeros(2)
    frame = shifted(*(align * (size - scale * box[2:]) - scale * box[:2]))
    frame[0, 0], frame[1, 1] = scale
    return frame, (box[2], box[3])
