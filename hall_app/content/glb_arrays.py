"""Numbers of a GLB: an accessor of its document as an array."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["accessor"]

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def accessor(document: dict[str, Any], binary: bytes, number: int) -> NDArray[np.float64]:
    """(N, width) an accessor's numbers; fractions where they are normalised. Raises what a broken file brings about."""
    entry = document["accessors"][number]
    view = document["bufferViews"][entry["bufferView"]]
    kind, width = np.dtype(_COMPONENTS[entry["componentType"]]), _WIDTH[entry["type"]]
    start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
    stride = view.get("byteStride", width * kind.itemsize)
    rows = np.ndarray((entry["count"], width), kind, binary, start, (stride, kind.itemsize))
    values = rows.astype(float)
    return values / np.iinfo(kind).max if entry.get("normalized") else values
