"""A garment's materials: what its weaves measure, simplified as far as the scene needs it, and said in words."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim_core.cloth import Material
from sim_core.garment.outfit import GRAVITY, Layer, Program
from sim_core.garment.pattern import Cloth
from sim_core.weave import ClothParameters, parameters_of

__all__ = ["Materials", "materials_of", "simplified"]

DOUBLED = "doubled"
LOCKED = 32.0  # times the shear stiffness at 8 degrees: woven cloth, whose yarns jam at 30 to 40
STEADY = 0.013  # [m] mesh steps below which stiffness is damped less: the same on a finer mesh would shorten time steps


@dataclass(frozen=True)
class Materials:
    """kinds: material of each kind of panel, `names` theirs (weave, and whether it is doubled); of_panel (N,): which
    each panel of the pattern has; choices: what was simplified, in words; provenance of the first weave's numbers."""

    kinds: tuple[Material, ...]
    names: tuple[str, ...]
    of_panel: np.ndarray
    choices: dict[str, str]
    provenance: dict[str, str]

    def of_faces(self, cloth: Cloth) -> np.ndarray:
        """Kind (F,) int32 of each face."""
        return self.of_panel[cloth.panel % len(self.of_panel)].astype(np.int32)


def materials_of(layer: Layer, cloth: Cloth, hanging: float) -> Materials:
    """The materials of a layer whose longest free length hangs `hanging` [m]."""
    solved: dict[str, ClothParameters] = {}
    kinds: dict[tuple[str, bool], int] = {}
    materials: list[Material] = []
    names, choices, of_panel = [], {}, []
    panels = layer.pattern.panels
    for name, doubled in [(p.name, p.doubled) for p in panels] or [("cloth", False)]:
        weave = layer.weave_of(name)
        cloth_kind = weave.key
        first = not solved
        if cloth_kind not in solved:
            solved[cloth_kind] = parameters_of(weave, layer.yarns(name))
        kind = cloth_kind, doubled
        if kind not in kinds:
            kinds[kind] = len(materials)
            single, said = simplified(solved[cloth_kind], layer.program, hanging, layer.edge)
            materials.append(_doubled(single) if doubled else single)
            names.append(f"{weave.name} {DOUBLED}" if doubled else weave.name)
            choices |= {key if first else f"{key} of {weave.name}": text for key, text in said.items()}
            if doubled:
                choices[DOUBLED] = "twice the mass and stretch, six times the bending"
        of_panel.append(kinds[kind])
    provenance = dict(next(iter(solved.values())).provenance)
    return Materials(tuple(materials), tuple(names), np.array(of_panel, np.int32), choices, provenance)


def simplified(
    parameters: ClothParameters, program: Program, hanging: float, edge: float
) -> tuple[Material, dict[str, str]]:
    """The weave's material as far as the scene needs it, and what was simplified, in words.

    hanging: longest free length [m]; edge: mesh step [m]. Silk hardly stretches, and a solver that resolved its true
    stiffness would spend its time on strains of 1e-5: stiffness is lowered until the cloth's own weight strains it by
    program.sag. Shear is LOCKED times what the instrument reads at 8 degrees, at most an isotropic sheet's: as soft as
    it reads, without the locking of woven cloth at wider angles, coarse meshes fold by chance. Bending is what it
    reads, but no less than the mesh resolves: (B / rho g)^(1/3) >= program.fold edges, below which folds look like
    crumpled paper.
    """
    density = float(parameters.density)
    enough = density * GRAVITY * hanging / program.sag
    stretch = [min(float(k), enough) for k in (parameters.stretch_weft, parameters.stretch_warp)]
    warp, weft = float(parameters.bend_warp), float(parameters.bend_weft)
    resolved = density * GRAVITY * (program.fold * edge) ** 3
    material = Material(
        density=density,
        stretch=stretch[0],
        stretch_warp=stretch[1],
        shear=min(LOCKED * float(parameters.shear), min(stretch) / 2.6),
        poisson=min(float(parameters.poisson), 0.3),
        bend=max(weft, resolved),
        bend_warp=max(warp, resolved),
        friction=float(parameters.friction),
        mass_damping=2.0,
        stiffness_damping=2e-5 * min(1.0, edge / STEADY) ** 2,
    )
    choices = {
        "stretch": f"{stretch[0]:.0f} N/m instead of {parameters.stretch_weft:.0f}: "
        f"{program.sag:.2%} strain by its weight",
        "shear": f"{material.shear:.0f} N/m instead of {parameters.shear:.1f}: stiffer by up to {LOCKED:.0f} times, "
        "since it does not lock",
        "bend": f"warp {warp:.2e} and weft {weft:.2e} N m, at least {resolved:.2e} for a {edge * 1e3:.0f} mm mesh",
        "poisson": f"{material.poisson:.2f} instead of {parameters.poisson:.2f}: crimp interchange needs tension",
    }
    return material, choices


def _doubled(single: Material) -> Material:
    """Of cloth folded along its length: two layers that slide a little."""
    assert single.stretch_warp is not None
    assert single.shear is not None
    assert single.bend_warp is not None
    return replace(
        single,
        density=2 * single.density,
        stretch=2 * single.stretch,
        stretch_warp=2 * single.stretch_warp,
        shear=2 * single.shear,
        bend=6 * single.bend,
        bend_warp=6 * single.bend_warp,
    )
