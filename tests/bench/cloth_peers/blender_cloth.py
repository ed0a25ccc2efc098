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
from mapping import FRAME, blender_numbers

VERSION = f"bpy {bpy.app.version_string}"
MASS = 0.25  # of a vertex where the air brakes: its number ends at 10
OUTER, ROUND = 0.001, 64  # [m] least that a collider keeps; corners of the bar
DAMPINGS = ("tension_damping", "compression_damping", "shear_damping", "bending_damping", "air_damping")


def meet(run, modifier, given, setting: dict) -> None:
    """What the cloth meets: nothing, or itself and the bar, a mesh of a cylinder; its shape without strain is flat."""
    touch = modifier.collision_settings
    layered = "thickness" in given
    touch.use_collision = touch.use_self_collision = layered
    if not layered:
        return
    touch.collision_quality = setting["passes"]
    touch.self_distance_min, touch.distance_min = float(given["thickness"]), float(given["clearance"]) - OUTER
    touch.friction = touch.self_friction = touch.damping = 0.0
    run.object.shape_key_add(name="begin")
    flat = run.object.shape_key_add(name="flat")
    rest = np.column_stack([given["rest"], 0 * given["rest"][:, 0]])
    flat.data.foreach_set("co", rest.astype(np.float32).ravel())
    flat.value = 0.0
    modifier.settings.rest_shape_key = flat
    ends, radius = given["bar"], float(given["bar_radius"])
    bpy.ops.mesh.primitive_cylinder_add(
        vertices=ROUND,
        radius=radius,
        depth=float(np.linalg.norm(ends[1] - ends[0])),
        location=ends.mean(0).tolist(),
        rotation=(0.0, float(np.pi / 2), 0.0),
    )
    bar = bpy.context.object
    bar.modifiers.new("bar", "COLLISION")
    bar.collision.thickness_outer, bar.collision.cloth_friction, bar.collision.damping = OUTER, 0.0, 0.0


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
            MASS if "damping" in given else 1.0,
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
        meet(self, modifier, given, setting)
        if "damping" in given:
            cloth.air_damping = (
                100 * MASS * float(given["damping"]) * FRAME
            )  # 0.01 of it brakes a vertex, per frame
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
