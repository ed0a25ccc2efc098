"""What a GLB's accessors claim: no more than its bytes hold, and no more than memory is for.

An accessor says itself how many rows it has. Whoever reads it makes room for them first, so a few hundred bytes that
nobody held against what is there would fill the server.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from sim_core.gltf import GlbError, GlbParts, row_size

MOST = 2**32  # rows of one accessor: their indices have 32 bits
MOST_TRIANGLES = 300_000  # of a model
MOST_BYTES = 128_000_000  # of all that is made room for: a model of 15 MB, its shapes unfolded, stays below


def see_that_it_is_held(parts: GlbParts) -> None:
    """Raises GlbError for claims beyond what is there, and what an inconsistent document brings about."""
    document = parts.document
    views = [_view_size(parts, view) for view in document.get("bufferViews", ())]
    sizes = [_size(document, views, number) for number in range(len(document.get("accessors", ())))]
    # A mesh has its own copy of what it names, shown or not.
    room = sum(views) + sum(sizes) + sum(sizes[number] for number in _named(document))
    if room > MOST_BYTES:
        raise GlbError(
            f"takes {room // 1_000_000} MB of memory to read, at most {MOST_BYTES // 1_000_000} MB",
            "reduce the mesh, and export it without shape keys",
        )


def whole(value: Any) -> int:
    """A count, a length or an offset. Raises ValueError for what cannot be one."""
    if type(value) is not int or not 0 <= value <= MOST:
        raise ValueError("a count, length or offset is out of range")
    return value


def _named(document: dict[str, Any]) -> Iterator[int]:
    """Every accessor as often as a mesh is made of it. Raises GlbError where one of them holds nothing at all."""
    for mesh in document.get("meshes", ()):
        for primitive in mesh["primitives"]:
            for number in (*primitive["attributes"].values(), *_indices(primitive)):
                accessor = document["accessors"][number]
                if "bufferView" not in accessor and "sparse" not in accessor:
                    raise GlbError(f"accessor {number} holds nothing", "export the model again")
                yield number


def _indices(primitive: dict[str, Any]) -> tuple[int, ...]:
    return (primitive["indices"],) if "indices" in primitive else ()


def _view_size(parts: GlbParts, view: dict[str, Any]) -> int:
    buffer = parts.document["buffers"][view["buffer"]]
    there = len(buffer["uri"]) if "uri" in buffer else len(parts.data) - parts.begin
    size = whole(view["byteLength"])
    if whole(view.get("byteOffset", 0)) + size > there:
        raise ValueError("a bufferView goes beyond its buffer")
    return size


def _size(document: dict[str, Any], views: list[int], number: int) -> int:
    """Bytes of an accessor as it is read."""
    accessor = document["accessors"][number]
    row, count = row_size(accessor), whole(accessor["count"])
    if "bufferView" in accessor:
        fits = _fits(document, views, accessor, row, count)
    else:  # zeros, a shape that changes few of them or none: exporters write such
        fits = count <= 3 * MOST_TRIANGLES
    if (sparse := accessor.get("sparse")) is not None:
        changed, indices = whole(sparse["count"]), sparse["indices"]
        fits = (
            fits
            and changed <= count
            and _fits(document, views, indices, row_size({**indices, "type": "SCALAR"}), changed)
            and _fits(document, views, sparse["values"], row, changed)
        )
    if not fits:
        raise GlbError(f"accessor {number} claims more than the file holds", "export the model again")
    return row * count


def _fits(document: dict[str, Any], views: list[int], place: dict[str, Any], row: int, count: int) -> bool:
    """Whether as many rows lie in the view from the place on."""
    stride = whole(document["bufferViews"][place["bufferView"]].get("byteStride", row))
    if stride < row:
        raise ValueError("an accessor's rows overlap")
    end = whole(place.get("byteOffset", 0)) + (count - 1) * stride + row if count else 0
    return end <= views[place["bufferView"]]
