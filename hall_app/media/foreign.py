"""A ready-made exhibit as a museum's scan would come: bronze mirror on a lacquer stand, two plain GLBs.

It is modelled with trimesh and written by trimesh's own exporter, on purpose without any part of sim_core: what the
hall can show must not depend on who made it. Only its indices are shortened afterwards.
"""

from __future__ import annotations

import json
import struct
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

RADIUS = 0.125  # [m] of the mirror
CENTRE = 0.475  # [m] height of its middle
TILT = np.radians(-9.0)  # the face leans back, to look up at whoever sits before it
ARCS = 16
LONG, SHORT = 5125, 5123  # of a component in glTF: unsigned, of 32 and of 16 bits

BRONZE = ((0.13, 0.20, 0.155), (0.68, 0.46, 0.22))  # patina in the hollows, worn metal on the heights, linear
LACQUER, RED, GOLD = "#2a1a18", "#8e2620", "#c49a52"  # sRGB


@dataclass(frozen=True)
class Fineness:
    """back, face: radii of the rings of the mirror's two faces, of its own, ascending to 1; sectors of both; sections
    of turned parts, points along their profiles, sides of a fillet."""

    back: tuple[float, ...]
    face: tuple[float, ...]
    sectors: int
    sections: int
    smooth: int
    sides: int


def _even(rings: int) -> tuple[float, ...]:
    return tuple((np.arange(1, rings + 1) / rings).tolist())


# Rings where the relief changes its slope: fewer than half as many as evenly spread ones, and closer to it.
_EDGES = (0.06, 0.10, 0.12, 0.17, 0.22, 0.27, 0.30, 0.33, 0.35, 0.565, 0.60, 0.64, 0.69, 0.72, 0.755, 0.79)
_EDGES += (0.81, 0.84, 1.0)

FINENESS = {
    "hall": Fineness(_EDGES, _even(2), 96, 28, 1, 5),
    "close": Fineness(_even(78), _even(4), 300, 48, 3, 11),
    "afar": Fineness((0.12, 0.27, 0.30, 0.345, 0.565, 0.64, 0.70, 0.82, 1.0), (1.0,), 48, 10, 1, 3),
}
AFAR = 3.0  # [m] from which on the hall shows the coarsest: the mirror is 50 pixels high there


def write_mirror(folder: Path) -> None:
    """Write mirror_hall.glb and mirror_close.glb into `folder`."""
    (folder / "mirror_hall.glb").write_bytes(mirror_glb(FINENESS["hall"], FINENESS["afar"]))
    (folder / "mirror_close.glb").write_bytes(mirror_glb(FINENESS["close"]))


def mirror_glb(fineness: Fineness, afar: Fineness | None = None) -> bytes:
    """The exhibit as GLB: metres, y up, foot at y = 0, its face to +z.

    afar: how fine it is beyond AFAR; as `hall build` writes two levels, so that the hall shows the one it needs.
    """
    import trimesh

    scene = trimesh.Scene()
    for name, mesh in _parts(fineness).items():
        scene.add_geometry(mesh, name, name, metadata=None if afar is None else {"until": AFAR})
    for part, mesh in ({} if afar is None else _parts(afar)).items():
        name = f"{part} afar"
        scene.add_geometry(mesh, name, name, metadata={"from": AFAR})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # trimesh's exporter may warn about numpy's deprecations
        data = scene.export(file_type="glb", include_normals=True)
    assert isinstance(data, bytes)  # trimesh gives other types for other file types
    return tightened(data)


def _parts(fineness: Fineness) -> dict[str, Any]:
    return {"mirror": _mirror(fineness), **_stand(fineness)}


def tightened(data: bytes) -> bytes:
    """A GLB whose indices have 16 bits where its vertices are few enough: trimesh writes 32, a fifth of a file; nodes
    for far eyes get no size, so that readers who know nothing of levels show the near one alone."""
    (size,) = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20 : 20 + size])
    binary, views = data[28 + size :], document["bufferViews"]
    parts = [
        binary[view.get("byteOffset", 0) : view.get("byteOffset", 0) + view["byteLength"]] for view in views
    ]
    for accessor in document["accessors"]:
        if accessor["componentType"] == LONG and max(accessor["max"]) < 2**16 - 1:
            accessor["componentType"] = SHORT
            at = accessor["bufferView"]
            parts[at] = np.frombuffer(parts[at], "<u4").astype("<u2").tobytes()
    for node in document["nodes"]:
        if "from" in node.get("extras", {}):
            node["scale"] = [0.0, 0.0, 0.0]
    begin = 0
    for number, (view, part) in enumerate(zip(views, parts, strict=True)):
        view |= {"byteOffset": begin, "byteLength": len(part)}
        parts[number] = part + bytes(-len(part) % 4)
        begin += len(parts[number])
    document["buffers"] = [{"byteLength": begin}]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = b"".join(
        struct.pack("<I4s", len(chunk), kind) + chunk
        for chunk, kind in ((text, b"JSON"), (b"".join(parts), b"BIN\0"))
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def back_height(radius: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Relief [m] of the mirror's back at polar places; knob, inward linked arcs, ring, plain rim."""
    share = radius / RADIUS

    def step(low: float | np.ndarray, width: float = 0.012) -> np.ndarray:
        t = np.clip((share - low) / width + 0.5, 0.0, 1.0)
        return t * t * (3 - 2 * t)

    knob = 0.013 * np.sqrt(np.clip(1 - (share / 0.12) ** 2, 0, 1))
    petals = 0.0016 * (1 - step(0.27)) * step(0.17) * (0.5 + 0.5 * np.cos(12 * angle))
    ring = 0.0022 * (step(0.30) - step(0.345))
    # Within each sector u runs -1 … 1; the arc bulges to the middle and meets its neighbours in a point.
    u = 2 * ((angle * ARCS / (2 * np.pi)) % 1) - 1
    arc = 0.64 - 0.075 * np.sqrt(np.clip(1 - u * u, 0, 1))
    arcs = 0.0024 * (step(arc) - step(0.70))
    hatching = 0.0007 * (step(0.72) - step(0.79)) * (0.5 + 0.5 * np.cos(96 * angle))
    rim = 0.0034 * step(0.82, 0.03)
    return 0.0022 + knob + petals + ring + arcs + hatching + rim


def _mirror(fineness: Fineness) -> Any:
    """The disc with relief on its back, coloured by height; the back, which museums show, to +z."""
    import trimesh

    sectors = fineness.sectors
    front, back = _polar(fineness.face, sectors), _polar(fineness.back, sectors)
    height = back_height(*back)
    face = 0.0030 - 0.0035 * (front[0] / RADIUS) ** 2  # slightly convex: it shows the whole head
    grids = [
        np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)
        for (radius, angle), z in ((front, face), (back, -height))
    ]
    middles = [[0, 0, 0.0030], [0, 0, -float(back_height(np.zeros(1), np.zeros(1))[0])]]
    parts = [
        _disc(grid, middle, flip) for grid, middle, flip in zip(grids, middles, (False, True), strict=True)
    ]
    parts.append(_edge(grids[0][-1], grids[1][-1]))
    tones = [np.full(face.size + 1, 0.92), _tone(height), np.full(2 * sectors, 0.6)]
    vertices = np.concatenate([part[0] for part in parts])
    starts = np.cumsum([0, *(len(part[0]) for part in parts)])
    faces = np.concatenate([part[1] + start for part, start in zip(parts, starts, strict=False)])
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi, [0, 1, 0]))
    mesh.apply_transform(trimesh.transformations.rotation_matrix(TILT, [1, 0, 0]))
    mesh.apply_translation([0, CENTRE, 0])
    tone = np.concatenate(tones)[:, None]
    colour = (1 - tone) * np.array(BRONZE[0]) + tone * np.array(BRONZE[1])
    return _dressed(mesh, "bronze", "#ffffff", metallic=0.35, rough=0.32, colour=colour)


def _polar(shares: tuple[float, ...], sectors: int) -> tuple[np.ndarray, np.ndarray]:
    """Radius [m] and angle [rad], each (rings, sectors), without the middle; shares: of the mirror's radius."""
    radius, angle = RADIUS * np.array(shares), 2 * np.pi * np.arange(sectors) / sectors
    shape = len(radius), sectors
    return np.broadcast_to(radius[:, None], shape), np.broadcast_to(angle, shape)


def _tone(height: np.ndarray) -> np.ndarray:
    """0 in the hollows, 1 on the heights, the middle first."""
    tone = np.clip((height - 0.0020) / 0.0040, 0.0, 1.0) ** 0.7
    return np.concatenate([[1.0], tone.ravel()])


def _disc(grid: np.ndarray, middle: list[float], flip: bool) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of a polar grid (rings, sectors, 3) closed by its middle."""
    rings, sectors = grid.shape[:2]
    index = 1 + np.arange(rings * sectors).reshape(rings, sectors)
    after = np.roll(index, -1, axis=1)
    fan = np.stack([np.zeros(sectors, int), index[0], after[0]], axis=1)
    a, b, c, d = index[:-1].ravel(), index[1:].ravel(), after[1:].ravel(), after[:-1].ravel()
    faces = np.concatenate([fan, np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return np.concatenate([[middle], grid.reshape(-1, 3)]), faces[:, ::-1] if flip else faces


def _edge(front: np.ndarray, back: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The band between the two rims, each (sectors, 3)."""
    count = len(front)
    here = np.arange(count)
    after = np.roll(here, -1)
    faces = [np.stack([here, here + count, after + count], 1), np.stack([here, after + count, after], 1)]
    return np.concatenate([front, back]), np.concatenate(faces)


def _stand(fineness: Fineness) -> dict[str, Any]:
    """Foot, post, the crescent that holds the rim, gold fillets; [radius, height] profiles in metres."""
    foot = [[0, 0], [0.150, 0], [0.152, 0.012], [0.140, 0.026], [0.118, 0.032], [0.060, 0.050]]
    foot += [[0.030, 0.078], [0.021, 0.105]]
    post = [[0.021, 0.105], [0.019, 0.150], [0.026, 0.170], [0.019, 0.190], [0.015, 0.285], [0.020, 0.308]]
    post += [[0.027, 0.326], [0.024, 0.332], [0, 0.333]]
    parts = {
        "foot": _dressed(_turned(foot, fineness), "lacquer", LACQUER, metallic=0.0, rough=0.22),
        "post": _dressed(_turned(post, fineness), "red", RED, metallic=0.0, rough=0.25),
        "arm": _dressed(_crescent(fineness), "lacquer", LACQUER, metallic=0.0, rough=0.22),
    }
    for name, radius, height in (("fillet-low", 0.1415, 0.026), ("fillet-high", 0.0275, 0.170)):
        ring = _ring(radius, height, 0.0026, fineness)
        parts[name] = _dressed(ring, "gold", GOLD, metallic=0.4, rough=0.35)
    return parts


def _turned(profile: list[list[float]], fineness: Fineness) -> Any:
    """A profile [radius, height] smoothed and turned about the upright axis."""
    import trimesh
    from scipy.interpolate import PchipInterpolator

    points = np.array(profile)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    fine = np.unique(
        np.concatenate(
            [np.linspace(a, b, fineness.smooth + 1) for a, b in zip(along, along[1:], strict=False)]
        )
    )
    smooth = np.stack([PchipInterpolator(along, points[:, k])(fine) for k in (0, 1)], axis=1)
    mesh = trimesh.creation.revolve(smooth, sections=fineness.sections)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    return mesh


def _crescent(fineness: Fineness) -> Any:
    """A horned arm round the lower third of the rim, thick below and pointed above, in the mirror's plane."""
    import trimesh

    steps, sides = fineness.sections // 2, max(min(10, 2 * fineness.sides), fineness.sections // 6)
    turn = np.radians(np.linspace(-168, -12, steps + 1))
    taper = np.clip(np.sin(turn + np.pi), 0, 1) ** 0.6
    thick = 0.0035 + 0.0105 * taper
    round_ = 2 * np.pi * np.arange(sides) / sides
    reach = RADIUS + 0.004 + thick[:, None] * (1 + np.cos(round_))[None, :] - 0.003
    lift = 0.028 * (1 - taper[:, None])  # the horns open a little outwards
    x, y = (reach + lift) * np.cos(turn)[:, None], (reach + lift) * np.sin(turn)[:, None]
    z = 1.25 * thick[:, None] * np.sin(round_)[None, :]
    grid = np.stack([x, y, z], axis=-1)
    index = np.arange((steps + 1) * sides).reshape(steps + 1, sides)
    after = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1].ravel(), index[1:].ravel(), after[1:].ravel(), after[:-1].ravel()
    faces = [np.stack([a, b, c], 1), np.stack([a, c, d], 1)]
    count = len(grid.reshape(-1, 3))
    for ring, middle, order in ((index[0], count, 1), (index[-1], count + 1, -1)):
        faces.append(np.stack([np.full(sides, middle), ring, np.roll(ring, -1)], 1)[:, ::order])
    vertices = np.concatenate([grid.reshape(-1, 3), grid[[0, -1]].mean(axis=1)])
    mesh = trimesh.Trimesh(vertices, np.concatenate(faces), process=False)
    mesh.fix_normals()
    mesh.apply_transform(trimesh.transformations.rotation_matrix(TILT, [1, 0, 0]))
    mesh.apply_translation([0, CENTRE, 0])
    return mesh


def _ring(radius: float, height: float, thick: float, fineness: Fineness) -> Any:
    import trimesh

    mesh = trimesh.creation.torus(
        radius, thick, major_sections=fineness.sections, minor_sections=fineness.sides
    )
    mesh.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    mesh.apply_translation([0, height, 0])
    return mesh


def _dressed(
    mesh: Any, name: str, base: str, *, metallic: float, rough: float, colour: np.ndarray | None = None
) -> Any:
    """Give the mesh a material; base: sRGB; `colour` (V, 3) linear 0..1 goes into the vertices (COLOR_0)."""
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    srgb = np.array([int(base[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)  # as glTF wants it
    material = PBRMaterial(
        name=name,
        baseColorFactor=[*linear, 1.0],
        metallicFactor=metallic,
        roughnessFactor=rough,
        doubleSided=False,
    )
    mesh.visual = TextureVisuals(material=material)
    if colour is not None:
        rgba = np.column_stack([colour, np.ones(len(colour))])
        mesh.visual.vertex_attributes["color"] = (255 * np.clip(rgba, 0, 1)).round().astype(np.uint8)
    return mesh
