"""How an outfit and its garments look: what film and stills show of them, and what their models hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.build.film import Look, Part, Piece
from hall_app.content.bakes.accessories import cloth_area, garment_at

if TYPE_CHECKING:
    from sim_core.body import Mannequin
    from sim_core.garment import Garment, Layer, Outfit, Played
    from sim_core.garment.glb import Clothed
    from sim_core.weave.maps import MapsLike

__all__ = ["Wardrobe"]

FIGURE = {"close": None, "hall": 1600, "afar": 400}  # triangles of a figure, None: all
AFAR = 3.0  # times the nearest view: from there on a coarser level is seen, which may deviate as much more
THINNEST = 0.3  # of a cloth's cover in pictures: what stops less light than that would hardly be seen
MOMENT = 5  # frames of a motion from one look at what is seen of its wearer to the next
TREAD = 0.06  # [m] above the ground that feet are looked at
ROUND = 0.04  # [m] of its base round the feet of who walks
PIXELS = 512  # of the weaves' maps
FILM_PIXEL = 0.002  # [m] of a repeat in films and stills, whose pixels see about as much


@dataclass(frozen=True)
class Wardrobe:
    """An outfit with the maps of its cloth, each weave drawn once."""

    outfit: Outfit

    @cached_property
    def maps(self) -> tuple[tuple[MapsLike, dict[str, MapsLike]], ...]:
        """Of each layer: its cloth's maps, and those of panels that have a weave of their own."""

        def of(layer: Layer, panel: str = "") -> MapsLike:
            return layer.loom.maps(layer.weave_of(panel), PIXELS)

        return tuple(
            (of(layer), {panel: of(layer, panel) for panel in layer.weaves}) for layer in self.outfit.layers
        )

    @cached_property
    def filmed(self) -> int:
        """The layer with which the film begins: the garment one comes to see, whose accessories follow."""
        return garment_at(
            [
                (cloth_area(layer.cloth.vertices, layer.cloth.faces), layer.accessory)
                for layer in self.outfit.layers
            ]
        )

    def film(self) -> Look:
        """What the film shows, what moves first: layers, the outermost first, and the wearer.

        Layers from `filmed` on are as they are cut, since they are seen as they are sewn. Vertices of the cloth are
        those of its pattern, as frames of a dressing give them.
        """
        pieces = []
        for number, layer in enumerate(self.outfit.layers):
            cloth = layer.cloth
            weld = (
                cloth.joined if number >= self.filmed else cloth.closed
            )  # beneath, all has been sewn already
            _, first, index = np.unique(weld, return_index=True, return_inverse=True)
            faces = first[index.reshape(-1)][cloth.faces].astype(np.int32)
            places = (cloth.vertices - np.array(layer.panel_origins())[cloth.panel_of])[cloth.faces]
            parts = self._parts(number, faces, places, (cloth.panel, cloth.names))
            pieces.append(Piece(np.zeros((len(cloth.vertices), 3)), parts))
        return self._look(pieces)

    def still(self, garments: Sequence[Garment]) -> Look:
        """What the stills show: the garments at rest."""
        from sim_core.picture import split_along

        pieces = []
        for number, garment in enumerate(garments):
            faces, welded = split_along(garment.faces, garment.creases())
            places = garment.cloth_places()[garment.pattern_faces]
            parts = self._parts(number, faces, places, (garment.panel, garment.panels))
            pieces.append(Piece(garment.positions[welded], parts))
        return self._look(pieces)

    def write_models(
        self,
        garments: Sequence[Garment],
        folder: Path,
        budgets: tuple[float, float],
        nearest: float,
        played: Played | None = None,
    ) -> tuple[tuple[Garment, ...], tuple[Garment, ...]]:
        """Writes close.glb, and hall.glb with each layer's cheapest level and the one for far eyes; returns these.

        budgets [m]: how far (p99) what is worn beneath may deviate in the hall, seen from `nearest` [m], and how far
        the outermost; played: how they move, which shows more of their wearer, and bends what hangs flat. What moves
        has no level for far eyes.
        """
        from sim_core.garment.glb import Afar, write_glb

        dressed = self._clothed(garments)
        close = self._figure(dressed, "close", played)
        write_glb(folder / "close.glb", dressed, precision="close", figure=close)
        levels = _levels(garments, budgets, played)
        near = self._clothed(levels)
        figure = self._figure(near if played is None else dressed, "hall", played)
        coarse: tuple[Garment, ...] = ()
        afar = None
        if played is None:
            coarse = _levels(garments, (AFAR * budgets[0], AFAR * budgets[1]), None)
            far = self._clothed(coarse)
            afar = Afar(far, self._figure(far, "afar", None), AFAR * nearest)
        write_glb(folder / "hall.glb", near, precision="hall", figure=figure, afar=afar)
        return levels, coarse

    def _clothed(self, garments: Sequence[Garment]) -> list[Clothed]:
        from sim_core.garment import Clothed

        return [Clothed(garment, *maps) for garment, maps in zip(garments, self.maps, strict=True)]

    def _figure(self, layers: Sequence[Clothed], precision: str, played: Played | None) -> Any:
        """The wearer as far as no dense cloth hides it, as they stand and as they move."""
        from sim_core.garment import opaque
        from sim_core.garment.levels import shown_figure

        wearer = self.outfit.wearer
        if wearer is None:
            return None
        body = wearer.posed(self.outfit.pose), wearer.faces
        moments = [] if played is None else _moments(played, wearer)
        shown = shown_figure(
            *body, *opaque(layers), triangles=FIGURE[precision], moments=moments, worn=wearer.worn()
        )
        reach = max((_reach(figure) for figure, _ in moments), default=0.0)
        radius, height = shown.base
        return replace(shown, base=(max(radius, reach + ROUND), height))

    def _parts(
        self,
        number: int,
        faces: np.ndarray,
        places: np.ndarray,
        panels: tuple[np.ndarray, Sequence[str]],
    ) -> tuple[Part, ...]:
        """The looks of a layer's cloth: one for each colour, cover and repeat.

        faces (F, 3); places (F, 3, 2) [m] where they lie in their cloth; panels: numbers (F,) and names of theirs.
        """
        from sim_core.garment.pattern import unsided
        from sim_core.weave.maps import SHEER, coverage

        layer, (maps, own), (panel, names) = self.outfit.layers[number], self.maps[number], panels
        dyes = {cut.name: cut.dye for cut in layer.pattern.panels}
        looks: dict[Any, list[int]] = {}
        for k, name in enumerate(map(unsided, names)):
            dye = None if layer.weave_of(name).several else dyes.get(name) or layer.pattern.dye
            looks.setdefault((dye, name if name in own else ""), []).append(k)
        parts = []
        for (dye, name), which in looks.items():
            woven, mine = own.get(name, maps), np.isin(panel, which)
            cover = coverage(woven)
            colour, fabric = _far(woven, dye)
            alpha = max(cover, THINNEST) if cover < SHEER else 1.0
            woven_in = {} if fabric is None else {"fabric": fabric, "corners": places[mine]}
            parts.append(Part(faces[mine], colour, alpha, sheen=0.5, **woven_in))
        return tuple(parts)

    def _look(self, cloth: Sequence[Piece]) -> Look:
        """Cloth, given from the skin outwards, and what bears it."""
        from sim_core.cloth import Cylinder
        from sim_core.cloth.contact.solid_meshes import solid_mesh
        from sim_core.garment.glb import LACQUER, LINEN
        from sim_core.garment.levels.figure import BASE

        if self.outfit.wearer is None:
            assert self.outfit.stand is not None
            vertices, faces = self.outfit.stand.mesh()
            stand = Piece(vertices, (Part(faces, LACQUER, gloss=0.35),))
            return Look((*cloth[::-1], stand), float(vertices[:, 1].max()))
        radius, lift = BASE
        vertices = self.outfit.wearer.posed(self.outfit.pose)
        disc, around = solid_mesh(Cylinder((0, 0, 0), (0, lift, 0), radius, 0.4 * lift), 48)
        wearer, faces = self.outfit.wearer, self.outfit.wearer.faces
        worn = [Part(faces[piece.faces(faces)], piece.dye, gloss=0.1) for piece in wearer.worn()]
        body = Piece(vertices, (Part(faces[wearer.bare()], LINEN, gloss=0.05), *worn), lift)
        base = Piece(disc, (Part(around, LACQUER, gloss=0.35),))
        raised = [replace(piece, lift=lift) for piece in cloth[::-1]]
        return Look((*raised, body, base), float(vertices[:, 1].max()) + lift)


def _levels(
    garments: Sequence[Garment], budgets: tuple[float, float], played: Played | None
) -> tuple[Garment, ...]:
    """Each layer's cheapest level; budgets [m]: of what is worn beneath, and of the outermost."""
    from sim_core.garment import choose_detail

    moved = [() if played is None else tuple(played.frames[k]) for k in range(len(garments))]
    levels = [choose_detail(one, budgets[0], moments=moved[k]) for k, one in enumerate(garments[:-1])]
    solid = _worn(garments[-1], levels)
    return (*levels, choose_detail(garments[-1], budgets[1], solid=solid, moments=moved[-1]))


def _moments(played: Played, wearer: Mannequin) -> list[tuple[np.ndarray, np.ndarray]]:
    """Where wearer and cloth are at some times of a motion."""
    return [
        (wearer.posed(played.poses[k]), np.concatenate([frames[k] for frames in played.frames]))
        for k in range(0, len(played.poses), MOMENT)
    ]


def _reach(figure: np.ndarray) -> float:
    """How far from the middle a figure (V, 3) steps [m]."""
    low = figure[:, 1] < TREAD
    return float(np.hypot(figure[low, 0], figure[low, 2]).max(initial=0.0))


def _worn(garment: Garment, beneath: Sequence[Garment]) -> Any:
    """The solid that a coarser mesh is moved out of: the wearer in these levels. None: as the garment knows,
    which on a stand touches no other."""
    from sim_core.garment.dressing import capped

    if not beneath or garment.settled is None or garment.settled.beneath.stand is not None:
        return None
    lain = garment.settled.beneath
    body, *worn = lain.surfaces
    surfaces = []
    for surface, level in zip(worn, beneath, strict=True):
        vertices, faces = capped(level.positions, level.faces)
        surfaces.append(replace(surface, vertices=vertices, faces=faces))
    return replace(lain, surfaces=(body, *surfaces)).solid()


def _far(maps: MapsLike, dye: tuple[float, float, float] | None) -> tuple[tuple[float, float, float], Any]:
    """The colour [sRGB] of cloth seen from afar, and the repeat that is seen then; None where there is none."""
    from sim_core.picture import Fabric
    from sim_core.weave.maps import seen_afar, srgb

    picture, factor = seen_afar(maps, dye, FILM_PIXEL)
    red, green, blue = srgb(factor)
    fabric = None if picture is None else Fabric(picture, maps.size)
    return (float(red), float(green), float(blue)), fabric
