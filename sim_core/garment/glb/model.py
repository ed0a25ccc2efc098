"""Our own GLB writer: the garment, its stand or figure as a further node, the weave's maps at true scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from sim_core.cloth import Cylinder
from sim_core.cloth.contact.solid_meshes import solid_mesh
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Colour, Garment
from sim_core.garment.glb.cloth_material import cloth_close, cloth_hall, plain
from sim_core.garment.pattern import unsided
from sim_core.gltf import GlbFile
from sim_core.picture import normals, split_along
from sim_core.validation.files import written_whole
from sim_core.weave import Loom, Weave
from sim_core.weave.maps import SHEER, MapsLike, coverage, linear

Precision = Literal["close", "hall"]
LACQUER = (0.28, 0.165, 0.145)  # sRGB #482A25
LINEN = (0.84, 0.80, 0.73)  # sRGB
WHITE = (1.0, 1.0, 1.0)
FIGURE_ROUGH, WORN_ROUGH = 0.9, 0.6  # a figure is matt, light, without colour of its own
ROUND = {"close": (32, 48), "hall": (12, 28), "afar": (6, 14)}  # sides of a stand's bars and of a base


@dataclass(frozen=True)
class Part:
    """What a figure wears by itself: its name, its colour (sRGB), and which of the faces (F,) bool it is."""

    name: str
    dye: Colour
    faces: np.ndarray


@dataclass(frozen=True)
class Shown:
    """What is shown of a figure: vertices (V, 3) [m], faces (F, 3), normals (V, 3); base: its radius and height [m];
    worn: what it wears by itself."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    base: tuple[float, float]
    worn: tuple[Part, ...] = ()


@dataclass(frozen=True)
class Clothed:
    """A garment and how its cloth looks: maps of its weave, and those of panels that have one of their own."""

    garment: Garment
    maps: MapsLike
    panels: Mapping[str, MapsLike] = field(default_factory=dict)

    def of(self, panel: int) -> MapsLike:
        """The maps of a panel, of both halves of a mirrored pattern alike."""
        return self.panels.get(unsided(self.garment.panels[panel]), self.maps)

    @staticmethod
    def woven(garment: Garment, pixels: int = 512, *, loom: Loom | None = None) -> Clothed:
        """With the maps of its own weaves, `pixels` wide, each drawn once; loom: what was woven for it before.

        Raises SimCoreError where it does not tell its weave.
        """
        if not garment.weave:
            raise SimCoreError(f"garment {garment.name}: does not tell its weave – bake it again")
        loom = loom or Loom()

        def drawn(told: dict[str, Any]) -> MapsLike:
            return loom.maps(Weave.from_dict(told), pixels)

        return Clothed(garment, drawn(garment.weave), {name: drawn(w) for name, w in garment.weaves.items()})


@dataclass(frozen=True)
class Afar:
    """How a model looks from afar: coarser garments from the skin outwards, the figure; distance [m] from which on."""

    layers: Sequence[Clothed]
    figure: Shown | None
    distance: float


def opaque(layers: Sequence[Clothed]) -> tuple[np.ndarray, np.ndarray]:
    """Positions (P, 3) [m] of all layers, and the faces (F, 3) that nothing is seen through."""
    points, faces, count = [], [], 0
    for layer in layers:
        garment = layer.garment
        dense = [k for k in range(len(garment.panels)) if coverage(layer.of(k)) >= SHEER]
        points.append(garment.positions)
        faces.append(garment.faces[np.isin(garment.panel, dense)] + count)
        count += len(garment.positions)
    return np.concatenate(points), np.concatenate(faces)


def write_glb(
    path: Path,
    layers: Sequence[Clothed],
    *,
    precision: Precision = "close",
    figure: Shown | None = None,
    afar: Afar | None = None,
) -> int:
    """Writes garments, from the skin outwards, and their stand or figure; returns the size in bytes.

    afar: a second level for far eyes, see `GlbFile.levels`; its nodes' names end with " afar".

    Panels of one look are one node: the garment's name, then its name and a number. Twins on a seam share place and
    normal, so that no seam shows but for its change of colour. A figure and what it wears stand on its base.

    Maps: tileable, uint8, size [m] of the tile. TEXCOORD_0 is pattern millimetres from the weave's origin, v downwards;
    KHR_texture_transform brings it to tiles. close: the weave itself; hall: its mean colour and coverage and a coarser
    relief, since single yarns vanish beyond a hand's breadth. A figured cloth shows its repeat in both. Highlights are
    narrow along the yarns and wide across (KHR_materials_anisotropy), of a figured cloth by a texture of directions.
    """
    if precision not in ("close", "hall"):
        raise SimCoreError(f"precision: {precision!r} – give 'close' or 'hall'")
    if not layers:
        raise SimCoreError("glb: no garment – give one or more")
    for layer in layers:
        for maps in (layer.maps, *layer.panels.values()):
            if maps.albedo.shape[:2] != maps.opacity.shape or min(maps.size) <= 0:
                raise SimCoreError(
                    f"maps: albedo {maps.albedo.shape}, opacity {maps.opacity.shape} – sizes must agree"
                )
    textures: dict[int, dict[str, Any]] = {}
    glb = GlbFile()
    _write_level(glb, layers, figure, precision, textures)
    if afar is not None:
        near = len(glb.meshes)
        _write_level(glb, afar.layers, afar.figure, "afar", textures)
        for mesh in glb.meshes[near:]:
            mesh["name"] += " afar"
        glb.levels(range(near), range(near, len(glb.meshes)), afar.distance)
    outermost = layers[-1].garment
    used = {name for material in glb.materials for name in material.get("extensions", ())}
    data = glb.bytes(outermost.name, sorted(used | {"KHR_texture_transform"}))
    with written_whole(Path(path)) as stream:
        stream.write(data)
    return len(data)


def _write_level(
    glb: GlbFile,
    layers: Sequence[Clothed],
    figure: Shown | None,
    precision: Precision | Literal["afar"],
    textures: dict[int, dict[str, Any]],
) -> None:
    """Garments and what bears them; of what is seen from afar cloth looks as in the hall."""
    look: Precision = "close" if precision == "close" else "hall"
    lift = np.array([0.0, figure.base[1] if figure else 0.0, 0.0])
    for layer in layers:
        raised = replace(layer.garment, positions=layer.garment.positions + lift)
        _write_panels(glb, replace(layer, garment=raised), look, textures)
    outermost = layers[-1].garment
    if outermost.settled is not None and outermost.settled.beneath.stand is not None:
        stand = outermost.settled.beneath.stand.mesh(ROUND[precision][0])
        glb.mesh("stand", *stand, glb.material(_lacquer()))
    if figure is not None:
        _write_figure(glb, figure, lift, apart=precision == "close")
        base = Cylinder((0.0, 0.0, 0.0), (0.0, figure.base[1], 0.0), figure.base[0], 0.4 * figure.base[1])
        glb.mesh("base", *solid_mesh(base, ROUND[precision][1]), glb.material(_lacquer()))


def _write_figure(glb: GlbFile, figure: Shown, lift: np.ndarray, *, apart: bool) -> None:
    """Who wears the garments, and what they wear by themselves: nodes apart, or in the hall, where a renderer pays for
    every node, one that has its colours at its corners."""
    part = np.zeros(len(figure.faces), int)
    for number, worn in enumerate(figure.worn, 1):
        part[worn.faces] = number
    dyes = [LINEN, *(worn.dye for worn in figure.worn)]

    def node(name: str, own: np.ndarray, material: dict[str, Any], colours: np.ndarray | None = None) -> None:
        """These faces; colours: linear, one a part."""
        corners = np.column_stack([figure.faces[own].ravel(), np.repeat(part[own], 3)])
        used, index = np.unique(corners, axis=0, return_inverse=True)
        glb.mesh(
            name,
            figure.vertices[used[:, 0]] + lift,
            index.reshape(-1, 3).astype(np.int32),
            glb.material(material),
            colours=None if colours is None else colours[used[:, 1]],
            shading=figure.normals[used[:, 0]],
        )

    if not apart:
        white = plain("linen", WHITE, FIGURE_ROUGH)
        node("figure", np.ones(len(part), bool), white, linear(np.array(dyes)))
        return
    looks = [("figure", plain("linen", LINEN, FIGURE_ROUGH))]
    looks += [(worn.name, plain(worn.name, worn.dye, WORN_ROUGH)) for worn in figure.worn]
    for number, (name, material) in enumerate(looks):
        if (own := part == number).any():
            node(name, own, material)


def _write_panels(
    glb: GlbFile, layer: Clothed, precision: Precision, textures: dict[int, dict[str, Any]]
) -> None:
    """One mesh per look (dye and weave), in the order of the panels; textures: those stored already, by weave."""
    garment = layer.garment
    split, welded = split_along(garment.faces, garment.creases())
    shading = normals(garment.positions[welded], split)
    places = garment.cloth_places() * 1000.0
    looks: dict[Any, list[int]] = {}
    for number in range(len(garment.panels)):
        looks.setdefault((garment.dye_of(number), id(layer.of(number))), []).append(number)
    for count, ((dye, weave), own) in enumerate(looks.items()):
        mine = np.isin(garment.panel, own)
        corners = np.column_stack([garment.pattern_faces[mine].ravel(), split[mine].ravel()])
        used, index = np.unique(corners, axis=0, return_inverse=True)
        make = cloth_close if precision == "close" else cloth_hall
        name = garment.name if count == 0 else f"{garment.name} {count + 1}"
        glb.mesh(
            name,
            garment.positions[welded[used[:, 1]]],
            index.reshape(-1, 3).astype(np.int32),
            make(glb, dye, layer.of(own[0]), textures.setdefault(weave if precision == "close" else 0, {})),
            places[used[:, 0]],
            shading=shading[used[:, 1]],
        )


def _lacquer() -> dict[str, Any]:
    return plain("lacquer", LACQUER, 0.38)
