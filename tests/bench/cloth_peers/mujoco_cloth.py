"""MuJoCo's two-dimensional flex, one body of three slides a vertex, double precision.

Membrane: the St. Venant-Kirchhoff triangle, as ours; bending: a hinge that stores D kappa^2/2 in a cylinder. One shell
has both our numbers (`mapping.shell`). Masses are put to ours after compiling. What the scene does not use (contact,
constraints, limits, sensors, actuators) is switched off. It has no air of our kind: forces of the wind are added by
numpy before every fourth step, as our engine renews them. `Euler` is explicit in the elasticity, `discrete` implicit.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import mujoco
import numpy as np
from mapping import FRAME, pressed, shell

VERSION = f"mujoco {mujoco.__version__}"
UNUSED = "contact constraint limit sensor actuation equality frictionloss eulerdamp midphase refsafe".split()


ALONE = '<contact selfcollide="none" contype="0" conaffinity="0"/>'
CONTACT = 0.004  # [s] time constant of a contact, critically damped


def words(values: np.ndarray, form: str = "%.17g") -> str:
    return " ".join(form % v for v in np.ravel(values))


def touching(given, setting: dict) -> tuple[float, str, str]:
    """The radius [m] of the cloth, which is its clearance and half of what layers keep, its contacts, and the bar."""
    radius = float(given["thickness"]) / 2
    passive = str(setting.get("passive", False)).lower()
    meets = f'<contact selfcollide="auto" condim="1" solref="{CONTACT!r} 1" passive="{passive}"/>'
    bar = (
        f'<geom type="capsule" fromto="{words(given["bar"])}" size="{float(given["bar_radius"])!r}" condim="1" '
        f'solref="{CONTACT!r} 1"/>'
    )
    return radius, meets, bar


class MujocoCloth:
    """One run; setting: substeps, integrator (Euler or discrete), for discrete solver and tolerance."""

    def __init__(self, given, setting: dict) -> None:
        self.count = setting["substeps"]
        x, pins = given["positions"], given["pins"]
        layered = "thickness" in given
        flat = np.column_stack([given["rest"], 0 * x[:, 0]]) if layered else x
        young, thickness = shell(float(given["stretch"]), float(given["poisson"]), float(given["bend"]))
        unused = [name for name in UNUSED if not (layered and name in ("contact", "constraint", "refsafe"))]
        flags = " ".join(f'{name}="disable"' for name in unused)
        radius, meets, bar = touching(given, setting) if layered else (0.001, ALONE, "")
        option = (
            f'timestep="{FRAME / self.count!r}" gravity="0 {-float(given["gravity"])!r} 0" jacobian="sparse" '
            f'integrator="{setting["integrator"]}" solver="{setting.get("solver", "Newton")}" '
            f'iterations="1000" tolerance="{setting.get("tolerance", 1e-8)!r}"'
        )
        text = f"""<mujoco><option {option}><flag {flags}/></option><size memory="4G"/><worldbody>{bar}
        <flexcomp name="cloth" type="direct" dim="2" radius="{radius!r}" mass="1" dof="full"
         point="{words(flat)}" element="{words(given["faces"], "%d")}">{meets}
        <elasticity young="{young!r}" poisson="{float(given["poisson"])!r}" thickness="{thickness!r}"
         elastic2d="both" damping="{float(given.get("stiffness_damping", 0.0))!r}"/>
        <pin id="{words(pins, "%d")}"/></flexcomp></worldbody></mujoco>"""
        self.model = mujoco.MjModel.from_xml_string(text)
        free = np.setdiff1d(np.arange(len(x)), pins)
        self.model.body_mass[self.model.flex_vertbodyid[free]] = given["mass"][free]
        self.data = mujoco.MjData(self.model)
        self.faces, self.wind, self.air = given["faces"], given.get("wind"), float(given.get("air", 0.0))
        self.free = free
        self.bodies = self.model.flex_vertbodyid[free]
        self.dofs = self.model.body_dofadr[self.bodies][:, None] + np.arange(3)
        self.speeds = np.zeros((len(x), 3))
        self.model.dof_damping[self.dofs] = float(given.get("damping", 0.0)) * given["mass"][free][:, None]
        mujoco.mj_setConst(self.model, self.data)
        mujoco.mj_resetData(self.model, self.data)
        self.model.flex_vert[pins] = x[
            pins
        ]  # the flat sheet is its shape without strain, this where it begins
        self.data.qpos[
            self.model.jnt_qposadr[self.model.body_jntadr[self.bodies]][:, None] + np.arange(3)
        ] = (x - flat)[free]

    def warm(self) -> None:
        """Nothing is compiled at run time."""

    def frame(self) -> None:
        """One frame of 1/25 s."""
        if self.wind is None:
            mujoco.mj_step(self.model, self.data, self.count)
            return
        for done in range(0, self.count, 4):
            self.speeds[self.free] = self.data.qvel[self.dofs]
            force = pressed(self.positions(), self.speeds, self.faces, self.wind, self.air)
            self.data.qfrc_applied[self.dofs] = force[self.free]
            mujoco.mj_step(self.model, self.data, min(4, self.count - done))

    def positions(self) -> np.ndarray:
        """(V, 3) [m]."""
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_flex(self.model, self.data)
        return np.array(self.data.flexvert_xpos)
