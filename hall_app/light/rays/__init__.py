"""Rays: embree, what they meet; sights, lines to points on lamps; sampling, where rays are sent."""

from hall_app.light.rays.embree import Tree, blocked, build_tree, cast

__all__ = ["Tree", "blocked", "build_tree", "cast"]
