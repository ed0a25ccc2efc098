"""Blender's cloth modifier in bpy: springs on the edges, implicit Euler with one linear solve a step, single precision.

Numbers by `mapping.blender_numbers`; all its dampings and its air are zero. Bending springs are angular, of which its
matrix holds no derivative: they are explicit and want about 24 steps a frame at the sizes of our scenes. Its quality
is the number of steps a frame; only those are run for which it takes that number (`mapping.blender_steps`).
The time of a frame includes reading the mesh back through the modifier, as any user of bpy pays it.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import bpy
import numpy as np
from mapping import blender_numbers

VERSION = f"bpy {bpy.app.version_string}"
DAMPINGS = ("tension_damping", "compression_damping", "shear_damping", "bending_damping", "air_damping")


class BlenderCloth:
    """One run; setting: substeps (its quality)."""

    def __init__(self, given, setting: dict) -> None:
        numbers = blender_numbers(
            given["rest"],
            given["faces"],
            float(given["mass"].sum()),
            float(given["stretch"]),
            float(given["bend"]),
            float(given["gravity"]),
        )
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene, self.now = bpy.context.scene, 1
        self.scene.render.fps = 25
        self.scene.gravity = (0.0, -numbers["gravity"], 0.0)
        mesh = bpy.data.meshes.new("cloth")
        mesh.from_pydata(given["positions"].tolist(), [], given["faces"].tolist())
        mesh.update()
        self.object = bpy.data.objects.new("cloth", mesh)
        self.scene.collection.objects.link(self.object)
        self.object.vertex_groups.new(name="pins").add(given["pins"].tolist(), 1.0, "REPLACE")
        modifier = self.object.modifiers.new("cloth", "CLOTH")
        cloth = modifier.settings
        cloth.quality, cloth.mass, cloth.bending_model = setting["substeps"], numbers["mass"], "ANGULAR"
        for name in ("tension", "compression", "shear"):
            setattr(cloth, f"{name}_stiffness", numbers["tension"])
        cloth.bending_stiffness = numbers["bending"]
        for name in DAMPINGS:
            setattr(cloth, name, 0.0)
        cloth.vertex_group_mass, cloth.pin_stiffness = "pins", 1.0
        modifier.collision_settings.use_collision = False
        modifier.collision_settings.use_self_collision = False
        if (
            abs(cloth.tension_stiffness / numbers["tension"] - 1) > 1e-5
            or cloth.quality != setting["substeps"]
        ):
            raise ValueError("Blender clamps the numbers of this scene")
        self.scene.frame_set(1)

    def warm(self) -> None:
        """Nothing is compiled at run time."""

    def frame(self) -> None:
        """One frame of 1/25 s."""
        self.now += 1
        self.scene.frame_set(self.now)

    def positions(self) -> np.ndarray:
        """(V, 3) [m]."""
        made = self.object.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        flat = np.zeros(3 * len(made.vertices), np.float32)
        made.vertices.foreach_get("co", flat)
        return flat.reshape(-1, 3).astype(float)
