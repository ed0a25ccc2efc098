"""What a cloth meets: solids and their distances, itself, and what holds it."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from sim_core.cloth.contact.collisions import Push, collide_samples, collide_vertices, contact_samples
from sim_core.cloth.contact.constraints import Holds
from sim_core.cloth.contact.distance import distances
from sim_core.cloth.contact.layers.closing import hold_apart, listed_close
from sim_core.cloth.contact.layers.crossings import crossings_of, faces_at_edges, no_crossings, none_crosses
from sim_core.cloth.contact.layers.foresight import unsure_pairs
from sim_core.cloth.contact.layers.jerks import feel, jerks_of, stand_by
from sim_core.cloth.contact.layers.near_pairs import Near, NearPairs, begin_pairs, near_pairs_of, renew_pairs
from sim_core.cloth.contact.layers.pairs import Mesh, Search, finder_of, hash_points
from sim_core.cloth.contact.layers.patches import Patches, patches_of, shapes_of
from sim_core.cloth.contact.layers.repulsion import CLOSE, LEVER, PARTING, Shell, repel
from sim_core.cloth.contact.layers.untangling import Memory, Untangling, untangle
from sim_core.cloth.contact.solid_meshes import solid_mesh
from sim_core.cloth.contact.solids import Box, Capsule, Cylinder, GridSdf, HalfSpace, Solid, Union

if TYPE_CHECKING:
    from sim_core.cloth.contact.distance_field import (
        DistanceField,
        closed,
        field_of,
        hull_faces,
        hull_mesh,
        united,
    )
    from sim_core.cloth.contact.moving_grid import MovingGrid, moving_mesh

__all__ = [
    "CLOSE",
    "PARTING",
    "Box",
    "Capsule",
    "Cylinder",
    "DistanceField",
    "GridSdf",
    "HalfSpace",
    "Holds",
    "LEVER",
    "Memory",
    "Mesh",
    "MovingGrid",
    "Near",
    "NearPairs",
    "Patches",
    "Push",
    "Search",
    "Shell",
    "Solid",
    "Union",
    "Untangling",
    "begin_pairs",
    "closed",
    "collide_samples",
    "collide_vertices",
    "contact_samples",
    "crossings_of",
    "distances",
    "faces_at_edges",
    "feel",
    "field_of",
    "finder_of",
    "hash_points",
    "hold_apart",
    "hull_faces",
    "hull_mesh",
    "jerks_of",
    "listed_close",
    "moving_mesh",
    "near_pairs_of",
    "no_crossings",
    "none_crosses",
    "patches_of",
    "renew_pairs",
    "repel",
    "shapes_of",
    "stand_by",
    "solid_mesh",
    "united",
    "unsure_pairs",
    "untangle",
]

_LATE = {
    "DistanceField": "distance_field",
    "MovingGrid": "moving_grid",
    "closed": "distance_field",
    "field_of": "distance_field",
    "hull_faces": "distance_field",
    "hull_mesh": "distance_field",
    "moving_mesh": "moving_grid",
    "united": "distance_field",
}


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
