"""Stills of meshes without a graphics card: smooth two-sided shading, shadows, sky occlusion, sheer cloth."""

from sim_core.picture.raster import depth_map
from sim_core.picture.shading import (
    Camera,
    Light,
    Lighting,
    Surface,
    fan,
    lighting,
    normals,
    render,
    save_png,
)

__all__ = [
    "Camera",
    "Light",
    "Lighting",
    "Surface",
    "depth_map",
    "fan",
    "lighting",
    "normals",
    "render",
    "save_png",
]
