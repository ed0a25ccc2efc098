"""Who is whose neighbour in a triangle mesh: edges, rings in order, the border."""

from sim_core.learn.topology.rings import (
    Rings,
    border_edges,
    border_vertices,
    checked_sheet,
    edges,
    rings,
    unsigned,
)

__all__ = ["Rings", "border_edges", "border_vertices", "checked_sheet", "edges", "rings", "unsigned"]
