"""Rays: bvh, the tree over the triangles; tracing, the way through it; sampling, where rays are sent."""

from hall_app.light.rays.bvh import Tree, build_tree
from hall_app.light.rays.tracing import cast

__all__ = ["Tree", "build_tree", "cast"]
