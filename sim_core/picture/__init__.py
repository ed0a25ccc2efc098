"""Stills of meshes without a graphics card: smooth two-sided shading, shadows, sky occlusion, sheer cloth."""

from sim_core.picture.raster import depth_map
from sim_core.picture.shading import (
    Camera,
    Fabric,
    Light,
    Lighting,
    Surface,
    fan,
    lighting,
    normals,
    render,
    save_png,
    split_along,
)

__all__ = [
    "Camera",
    "Fabric",
    "Light",
    "Lighting",
    "Surface",
    "depth_map",
    "fan",
    "lighting",
    "normals",
    "render",
    "save_png",
    "split_along",
]
