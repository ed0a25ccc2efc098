"""Newton's VBD and Style3D on Warp's CPU back end (one thread, single precision).

VBD: stable Neo-Hookean membrane with the Lame parameters of our plane stress, equal to ours to second order in strain;
a hinge of kappa L theta^2/2 with kappa = B L/(A1+A2) per edge. Its step is recorded once and replayed, which spares it
the launches from Python. Neither has our air: a kernel of ours presses on the triangles in every step.
Style3D: Baraff-Witkin stretch A/2 (ku (|Fu|-1)^2 + kv (|Fv|-1)^2 + ks (Fu.Fv)^2) with ku = kv = k, ks = mu; it has no
Poisson's ratio. Hinge as ours with kappa = B/3. It keeps only 0.998 of the velocity in every step, which would make
the damping grow with the number of steps: undone here after each step, since the scenes are undamped. Its contact is
switched off where there is nothing to touch. Its solver reads dot products back, so its step cannot be recorded.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import newton
import numpy as np
import warp as wp
from mapping import FRAME, hinges, lame

wp.config.quiet = True
wp.set_device("cpu")
VERSION = f"newton {newton.__version__}, warp {wp.__version__}"
KEPT = 0.998  # of the velocity, by Style3D in every step
CONTACT = 50.0  # [N/m] of a contact, as stiff as the cloth


@wp.kernel
def scale(velocity: wp.array[wp.vec3], factor: float):
    """Multiplies every velocity."""
    i = wp.tid()
    velocity[i] = velocity[i] * factor


@wp.kernel
def press(
    x: wp.array[wp.vec3],
    v: wp.array[wp.vec3],
    faces: wp.array2d[wp.int32],
    wind: wp.vec3,
    half: float,
    force: wp.array[wp.vec3],
):
    """Adds rho/2 Cd A |u.n| (u.n) n of every triangle to its vertices, u the wind less the triangle's velocity."""
    f = wp.tid()
    a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
    normal = wp.cross(x[b] - x[a], x[c] - x[a])
    doubled = wp.length(normal)
    normal = normal / doubled
    through = wp.dot(wind - (v[a] + v[b] + v[c]) / 3.0, normal)
    share = normal * (half * 0.5 * doubled * wp.abs(through) * through / 3.0)
    wp.atomic_add(force, a, share)
    wp.atomic_add(force, b, share)
    wp.atomic_add(force, c, share)


def turned(rest: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The faces with positive area in (x, y), which Style3D asks for."""
    a, b, c = (rest[faces[:, k]] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    return np.where(area[:, None] > 0, faces, faces[:, [0, 2, 1]])


def shells(given) -> dict:
    """What VBD is told of layers: the distance they keep, and a half of it more that it looks."""
    if "thickness" not in given:
        return {"particle_enable_self_contact": False}
    thickness = float(given["thickness"])
    return {
        "particle_enable_self_contact": True,
        "particle_self_contact_margin": thickness,
        "particle_self_contact_gap": thickness / 2,
    }


def add_bar(builder, ends: np.ndarray, radius: float) -> None:
    """A still capsule along x between ends (2, 3) [m]."""
    middle, half = ends.mean(0), float(np.linalg.norm(ends[1] - ends[0])) / 2
    along_x = wp.quat_from_axis_angle(wp.vec3(0.0, 1.0, 0.0), float(np.pi / 2))  # a capsule lies along its z
    place = wp.transform(wp.vec3(*map(float, middle)), along_x)
    builder.add_shape_capsule(body=-1, xform=place, radius=radius, half_height=half)


class Touch:
    """What the cloth meets: the bar, found anew in every step, and how stiffly (no friction)."""

    def __init__(self, model) -> None:
        mass = float(model.particle_mass.numpy().max())
        model.soft_contact_ke, model.soft_contact_mu = CONTACT, 0.0
        model.soft_contact_kd = float(2 * np.sqrt(CONTACT * mass))  # [N s/m] critical: layers do not bounce
        self.pipeline = newton.CollisionPipeline(model)
        self.contacts = self.pipeline.contacts()

    def met(self, state):
        """The contacts of the particles with the bar."""
        self.pipeline.collide(state, self.contacts)
        return self.contacts


class NewtonCloth:
    """One run; setting: substeps, iterations, and for Style3D linear (iterations of its conjugate gradients)."""

    def __init__(self, given, setting: dict, *, style3d: bool) -> None:
        self.style3d, self.count = style3d, setting["substeps"]
        self.positions0 = given["positions"].astype(np.float32)
        self.model = self._model(given)
        self._bending(given)
        if style3d:
            config = newton.solvers.SolverStyle3D.Config(
                iterations=setting["iterations"], linear_iterations=setting["linear"]
            )
            self.solver = newton.solvers.SolverStyle3D(self.model, config=config)
            if "thickness" in given:
                self.solver.collision.radius = float(given["thickness"]) / 2  # of each of two layers
            else:
                self.solver.collision = None
        else:
            layers = shells(given)
            self.solver = newton.solvers.SolverVBD(
                self.model, iterations=setting["iterations"], particle_enable_tile_solve=False, **layers
            )
        self.touch = Touch(self.model) if "thickness" in given else None
        self.states = [self.model.state(), self.model.state()]
        self.control = self.model.control()
        self.wind = wp.vec3(*map(float, given["wind"])) if "wind" in given else None
        self.half = float(given.get("air", 0.0)) / 2
        left = np.exp(-float(given.get("damping", 0.0)) * FRAME / self.count)
        self.kept = float(left / (KEPT if style3d else 1.0))
        self.graph = None

    def _model(self, given):
        k, nu = float(given["stretch"]), float(given["poisson"])
        mu, lam = lame(k, nu)
        rest, faces, x = given["rest"], given["faces"], given["positions"]
        flat = np.column_stack([rest, 0 * rest[:, 0]])  # VBD's shape without strain is the one it is told
        builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=(0.0, -float(given["gravity"]), 0.0))
        common = {
            "pos": wp.vec3(0.0, 0.0, 0.0),
            "rot": wp.quat_identity(),
            "vel": wp.vec3(0.0, 0.0, 0.0),
            "vertices": (x if self.style3d else flat).tolist(),
            "density": float(given["density"]),
            "tri_kd": 0.0,
            "tri_drag": 0.0,
            "tri_lift": 0.0,
            "edge_kd": 0.0,
            "particle_radius": float(given.get("clearance", 1e-3)),
        }
        if self.style3d:
            newton.solvers.SolverStyle3D.register_custom_attributes(builder)
            newton.solvers.style3d.add_cloth_mesh(
                builder,
                indices=turned(rest, faces).ravel().tolist(),
                panel_verts=rest.tolist(),
                tri_aniso_ke=wp.vec3(k, k, mu),
                edge_aniso_ke=wp.vec3(1.0, 1.0, 1.0),
                tri_ka=0.0,
                **common,
            )
        else:
            indices = faces.ravel().tolist()
            builder.add_cloth_mesh(indices=indices, scale=1.0, tri_ke=mu, tri_ka=lam, edge_ke=1.0, **common)
        if "bar" in given:
            add_bar(builder, given["bar"], float(given["bar_radius"]))
        for pin in given["pins"]:
            builder.particle_mass[pin] = 0.0
            builder.particle_flags[pin] &= ~int(newton.ParticleFlags.ACTIVE)
        if not self.style3d:
            builder.color(include_bending=True)
        model = builder.finalize()
        model.particle_q.assign(self.positions0)
        return model

    def _bending(self, given) -> None:
        """Every hinge's own stiffness, by its edge and triangles."""
        quad = self.model.edge_indices.numpy()
        inner = (quad[:, 0] >= 0) & (quad[:, 1] >= 0)
        length, area = hinges(given["rest"], quad[:, :2], quad[:, 2:])
        bend = float(given["bend"])
        stiffness = np.where(inner, bend / 3 if self.style3d else bend * length / area, 0.0)
        self.model.edge_bending_properties.assign(np.stack([stiffness, 0 * stiffness], 1).astype(np.float32))

    def _substep(self) -> None:
        now, then = self.states
        if self.wind is not None:
            now.clear_forces()
            args = [now.particle_q, now.particle_qd, self.model.tri_indices, self.wind, self.half]
            wp.launch(press, dim=len(self.model.tri_indices), inputs=[*args, now.particle_f])
        contacts = None if self.touch is None else self.touch.met(now)
        self.solver.step(now, then, self.control, contacts, FRAME / self.count)
        if self.kept != 1.0:
            wp.launch(scale, dim=len(self.positions0), inputs=[then.particle_qd, self.kept])
        self.states.reverse()

    def warm(self) -> None:
        """Compiles every kernel and records the step, then starts again."""
        self._substep()
        self._substep()
        if not self.style3d and self.count % 2 == 0 and self.count * self.solver.iterations <= 4000:
            with wp.ScopedCapture() as capture:
                for _ in range(self.count):
                    self._substep()
            self.graph = capture.graph
        for state in self.states:
            state.particle_q.assign(self.positions0)
            state.particle_qd.zero_()

    def frame(self) -> None:
        """One frame of 1/25 s."""
        if self.graph is not None:
            wp.capture_launch(self.graph)
            return
        for _ in range(self.count):
            self._substep()

    def positions(self) -> np.ndarray:
        """(V, 3) [m]."""
        return self.states[0].particle_q.numpy().astype(float)
