"""Samples of the cloth's surface by OpenGL (moderngl on EGL, no screen): the same tiles as `samples`, drawn as ribbons.

moderngl is no dependency of the project: where it or EGL is missing, `context` raises NoOpenGL and numba draws.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.weave.maps.samples import Samples, Tile

__all__ = ["NoOpenGL", "context", "sample_surface"]

ACROSS = 24  # quads across a yarn
VERTEX = """
#version 330
in vec3 place; in vec4 first; in vec4 second;
uniform vec2 scale; uniform vec2 shift; uniform vec2 depth;
out vec4 a; out vec4 b;
void main() {
    gl_Position = vec4((place.xy + shift) * scale - 1.0, 1.0 - 2.0 * (place.z - depth.x) * depth.y, 1.0);
    a = first; b = second;
}
"""
FRAGMENT = """
#version 330
in vec4 a; in vec4 b;
layout(location = 0) out vec4 one; layout(location = 1) out vec4 two;
void main() { one = a; two = b; }
"""


class NoOpenGL(SimCoreError):  # noqa: N818 - a state of the machine, told by its name
    """moderngl or an EGL device is missing."""


@cache
def context():
    """A moderngl context without a screen; raises NoOpenGL where there is none."""
    try:
        import moderngl  # pyright: ignore[reportMissingImports] - optional

        return moderngl.create_context(standalone=True, backend="egl")
    except Exception as error:  # whatever a driver may raise
        raise NoOpenGL(f"OpenGL: {' '.join(str(error).split())} – install moderngl and libegl1") from error


def sample_surface(tiles: list[Tile], shape: tuple[int, int], size: tuple[float, float]) -> Samples:
    """As `samples.sample_surface`, by OpenGL. Raises NoOpenGL."""
    import moderngl  # pyright: ignore[reportMissingImports] - optional

    gl = context()
    program = gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
    rows, columns = shape
    low = min(float((t.height - t.tall).min()) for t in tiles)
    high = max(float((t.height + t.tall).max()) for t in tiles)
    targets = [gl.texture((columns, rows), 4, dtype="f4") for _ in range(2)]
    frame = gl.framebuffer(targets, gl.depth_renderbuffer((columns, rows)))
    frame.use()
    frame.clear(0.0, 0.0, 0.0, 0.0)
    gl.enable(moderngl.DEPTH_TEST)
    program["scale"].value = (2 / size[0], 2 / size[1])
    program["depth"].value = (low, 1 / (high - low) * 0.98)
    for tile in tiles:
        vertices, index = _ribbons(tile, shape, size)
        buffer, order = gl.buffer(vertices.astype("f4").tobytes()), gl.buffer(index.astype("i4").tobytes())
        array = gl.vertex_array(program, [(buffer, "3f 4f 4f", "place", "first", "second")], order)
        for x in (-size[0], 0.0, size[0]):  # what leaves the tile comes in on the other side
            for y in (-size[1], 0.0, size[1]):
                program["shift"].value = (x, y)
                array.render()
        for thing in (array, buffer, order):
            thing.release()
    one, two = (np.frombuffer(t.read(), "f4").reshape(rows, columns, 4)[::-1] for t in targets)
    for thing in (frame, *targets, program):
        thing.release()
    there = two[..., 3] > 0.5
    return Samples(
        np.where(there, one[..., 0], -np.inf).astype(np.float32),
        np.where(there, np.rint(two[..., 0]), -1).astype(np.int32),
        np.ascontiguousarray(one[..., 1]), np.ascontiguousarray(one[..., 2]), np.ascontiguousarray(one[..., 3]),
        np.where(there, np.rint(two[..., 1]), -1).astype(np.int16), np.ascontiguousarray(two[..., 2]),
    )  # fmt: skip


def _ribbons(tile: Tile, shape: tuple[int, int], size: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 11) and triangles of all yarns of a tile; one ribbon section each second sample."""
    yarns, places = tile.centre.shape
    length = size[1] if tile.along == 0 else size[0]
    keep = np.append(np.arange(0, places, 2), places)  # the last is the first, a tile further
    along = (keep + 0.5) / places * length
    at = keep % places
    offset = np.sin(np.linspace(-np.pi / 2, np.pi / 2, ACROSS + 1))  # closer at the steep flanks
    top = np.sqrt(np.maximum(1 - np.abs(offset) ** tile.power, 0))
    fall = tile.power / 2 * np.abs(offset) ** (tile.power - 1) / np.maximum(top, 0.1)
    c, h, wide, tall = (v[:, at, None] for v in (tile.centre, tile.height, tile.half, tile.tall))
    slope, lean, taper, tint = (
        np.broadcast_to(v[:, at, None], (yarns, len(at), ACROSS + 1))
        for v in (tile.slope, tile.lean, tile.taper, tile.colour)
    )
    lean = lean + offset * taper
    across, z = c + wide * offset, h + tall * top
    steep = -tall / wide * fall * np.sign(offset)
    other = slope - steep * lean
    lengthwise = np.broadcast_to(along[None, :, None], z.shape)
    number = np.broadcast_to(tile.first + np.arange(yarns)[:, None, None], z.shape)
    o = np.broadcast_to(offset, z.shape)
    if tile.along == 0:
        columns = (
            across,
            lengthwise,
            z,
            z,
            steep,
            other,
            np.pi / 2 - np.arctan(lean),
            number,
            tint,
            o,
            np.ones_like(z),
        )
    else:
        columns = (lengthwise, across, z, z, other, steep, np.arctan(lean), number, tint, o, np.ones_like(z))
    vertices = np.stack([np.asarray(v, float) for v in columns], axis=-1).reshape(-1, 11)
    y, k, s = np.indices((yarns, len(at) - 1, ACROSS))
    a = (y * len(at) + k) * (ACROSS + 1) + s
    quads = np.stack([a, a + 1, a + ACROSS + 2, a, a + ACROSS + 2, a + ACROSS + 1], axis=-1)
    shown = (tile.colour[:, at[:-1]] >= 0)[..., None] & np.ones(ACROSS, bool)
    return vertices, quads[shown].reshape(-1)
