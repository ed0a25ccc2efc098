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


def words(values: np.ndarray, form: str = "%.17g") -> str:
    return " ".join(form % v for v in np.ravel(values))


class MujocoCloth:
    """One run; setting: substeps, integrator (Euler or discrete), for discrete solver and tolerance."""

    def __init__(self, given, setting: dict) -> None:
        self.count = setting["substeps"]
        x, pins = given["positions"], given["pins"]
        young, thickness = shell(float(given["stretch"]), float(given["poisson"]), float(given["bend"]))
        flags = " ".join(f'{name}="disable"' for name in UNUSED)
        option = (
            f'timestep="{FRAME / self.count!r}" gravity="0 {-float(given["gravity"])!r} 0" jacobian="sparse" '
            f'integrator="{setting["integrator"]}" solver="{setting.get("solver", "Newton")}" '
            f'iterations="1000" tolerance="{setting.get("tolerance", 1e-8)!r}"'
        )
        text = f"""<mujoco><option {option}><flag {flags}/></option><size memory="4G"/><worldbody>
        <flexcomp name="cloth" type="direct" dim="2" radius="0.001" mass="1" dof="full"
         point="{words(x)}" element="{words(given["faces"], "%d")}">
        <contact selfcollide="none" contype="0" conaffinity="0"/>
        <elasticity young="{young!r}" poisson="{float(given["poisson"])!r}" thickness="{thickness!r}"
         elastic2d="both" damping="0"/>
        <pin id="{words(pins, "%d")}"/></flexcomp></worldbody></mujoco>"""
        self.model = mujoco.MjModel.from_xml_string(text)
        free = np.setdiff1d(np.arange(len(x)), pins)
        self.model.body_mass[self.model.flex_vertbodyid[free]] = given["mass"][free]
        self.data = mujoco.MjData(self.model)
        self.faces, self.wind, self.air = given["faces"], given.get("wind"), float(given.get("air", 0.0))
        self.free = free
        self.dofs = self.model.body_dofadr[self.model.flex_vertbodyid[free]][:, None] + np.arange(3)
        self.speeds = np.zeros((len(x), 3))
        mujoco.mj_setConst(self.model, self.data)
        mujoco.mj_resetData(self.model, self.data)

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
