"""The cloth that relaxed yarns make, as instruments measure it: weight, thickness and stiffness.

Each parameter carries its formula; what the model cannot settle is a band.
"""

from dataclasses import asdict, dataclass, field, replace
from math import radians, sqrt

import numpy as np

from sim_core.weave.draft.draft import plain
from sim_core.weave.model import Weave
from sim_core.weave.yarn import Yarn
from sim_core.weave.yarns.beams import relax
from sim_core.weave.yarns.geometry import FiguredGeometry, YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.paths import strands
from sim_core.weave.yarns.shifts import MANY
from sim_core.weave.yarns.solver import ground_of

__all__ = [
    "ClothParameters",
    "areal_density",
    "cloth_parameters",
    "measured",
    "parameters_of",
    "tensile_compliance",
]

SHEAR_ANGLE = radians(8)  # the angle to which the cell is sheared for the secant modulus
YARN_FRICTION = 0.25  # between crossing silk yarns, assumption
PROBE = 1e-3  # tension of the probe: strains stay near this
PROBE_MANY = 2e-3  # where heights are known to 1e-6 only
PROVENANCE = {
    "density": "sum over warp and weft of yarns per metre x linear density x (1 + crimp of the relaxed yarn)",
    "thickness": "highest minus lowest point of the flattened yarns in the relaxed repeat",
    "stretch_warp": "uniaxial: 1 / (crimp straightened per tension, by finite difference on the relaxed repeat, "
    "+ 1 / (EA x ends per metre)); EA = fibre modulus x linear density / fibre density; bounds: yarns of "
    "free fibres, of fibres stuck to one rod",
    "stretch_weft": "as stretch_warp, for the picks",
    "poisson": "crimp interchange: -S12 / sqrt(S11 S22) of the symmetric compliance of the relaxed repeat, "
    "not below 0 (long floats can turn its sign)",
    "shear": "secant at 8 degrees: friction torque of the crossings (mean crossing force x 0.25 (assumed) x a third "
    "of the yarn width) per cell, at most the stuck frame 12 / (p1 p2 (p2/EI1 + p1/EI2))",
    "bend": "geometric mean of bend_warp and bend_weft",
    "bend_warp": "EI of the yarn x ends per metre / (1 + crimp); bounds: free fibres, fibres stuck to one rod",
    "bend_weft": "as bend_warp, for the picks",
    "friction": "stated in the weave file (an assumption there unless it names a source)",
}


@dataclass(frozen=True)
class ClothParameters:
    """What a cloth solver needs to know of a weave.

    density [kg/m2], thickness [m], stretch_warp, stretch_weft, shear [N/m], poisson, bend [N m] (geometric mean of
    bend_warp and bend_weft), friction.  bounds: name -> (least, most) where a value lies between two bounds.
    provenance: name -> formula, inputs and source in one sentence.
    """

    density: float
    thickness: float
    stretch_warp: float
    stretch_weft: float
    shear: float
    poisson: float
    bend: float
    friction: float
    bend_warp: float
    bend_weft: float
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)
    provenance: dict[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict:
        """A plain dictionary that JSON can hold."""
        return asdict(self)


def cloth_parameters(weave: Weave, geometry: YarnGeometry) -> ClothParameters:
    """Homogenised parameters of a cloth for a solver; `provenance` tells the formula of each.

    Yarn level values, so the tensile stiffness is that of yarns whose crimp straightens: a cloth solver may have to
    soften it for its time step, and should say so.
    """
    compliance = tensile_compliance(weave, geometry)
    shear, shear_bounds = _shear(weave, geometry)
    warp_bounds, weft_bounds = _bending_bounds(weave, geometry)
    bend_warp = weave.warp.stiffness * weave.ends_per_m / (1 + float(geometry.warp_crimp.mean()))
    bend_weft = weave.weft.stiffness * weave.picks_per_m / (1 + float(geometry.weft_crimp.mean()))
    return ClothParameters(
        density=areal_density(weave, geometry),
        thickness=_thickness(weave, geometry),
        stretch_warp=1 / compliance[0, 0],
        stretch_weft=1 / compliance[1, 1],
        shear=shear,
        poisson=float(np.clip(-compliance[0, 1] / sqrt(compliance[0, 0] * compliance[1, 1]), 0.0, 1.0)),
        bend=sqrt(bend_warp * bend_weft),
        friction=weave.friction,
        bend_warp=bend_warp,
        bend_weft=bend_weft,
        bounds={
            "shear": shear_bounds,
            "bend_warp": warp_bounds,
            "bend_weft": weft_bounds,
            "stretch_warp": _stretch_bounds(weave, compliance[0, 0], weave.warp, weave.ends_per_m),
            "stretch_weft": _stretch_bounds(weave, compliance[1, 1], weave.weft, weave.picks_per_m),
        },
        provenance=PROVENANCE,
    )


def areal_density(weave: Weave, geometry: YarnGeometry) -> float:
    """Weight [kg/m2]: yarns per metre times their linear density times (1 + crimp), warp and weft together."""
    warp = weave.ends_per_m * weave.warp.tex * (1 + float(geometry.warp_crimp.mean()))
    weft = weave.picks_per_m * weave.weft.tex * (1 + float(geometry.weft_crimp.mean()))
    return warp + weft


def _thickness(weave: Weave, geometry: YarnGeometry) -> float:
    top = max(
        geometry.warp_height.max() + weave.warp.height / 2, geometry.weft_height.max() + weave.weft.height / 2
    )
    bottom = min(
        geometry.warp_height.min() - weave.warp.height / 2, geometry.weft_height.min() - weave.weft.height / 2
    )
    return float(top - bottom)


def tensile_compliance(weave: Weave, rest: YarnGeometry | None = None) -> np.ndarray:
    """Strains per tension [m/N], (2, 2) symmetric, [0, 0] warp, [1, 1] weft, [0, 1] crimp interchange (negative).

    A small tension is put on one yarn system, the heights are relaxed again, and the change of crimp is the strain
    (the yarn keeps its length); the axial stretch of the straight yarn is added. Above 10,000 crossings the tension
    is only pulled, not pushed (the long waves of a large repeat would buckle), from stage A at rest, `rest`.
    """
    # tension per yarn at which straightening yields strains of about PROBE
    many = weave.draft.lift.size > MANY
    size = PROBE_MANY if many else PROBE
    warp_probe = size * weave.warp.stiffness / weave.pick_spacing**2
    weft_probe = size * weave.weft.stiffness / weave.end_spacing**2
    probes = (warp_probe, 0.0), (0.0, weft_probe)
    yarns = weave.ends_per_m, weave.picks_per_m
    axial = weave.warp.axial, weave.weft.axial
    columns = []
    if many and rest is None:
        rest = relax(weave)
    for k in range(2):
        if many and rest is not None:
            pulled = _crimps(relax(weave, tension=probes[k], start=rest))
            slack, span = _crimps(rest), probes[k][k]
        else:
            pulled = _crimps(relax(weave, tension=probes[k], tolerance=1e-11))
            slack = _crimps(relax(weave, tension=(-probes[k][0], -probes[k][1]), tolerance=1e-11))
            span = 2 * probes[k][k]
        strain = -(pulled - slack) / (span * yarns[k])
        strain[k] += 1 / (axial[k] * yarns[k])
        columns.append(strain)
    matrix = np.column_stack(columns)
    return (matrix + matrix.T) / 2


def _crimps(geometry: YarnGeometry) -> np.ndarray:
    return np.array([geometry.warp_crimp.mean(), geometry.weft_crimp.mean()])


def _shear(weave: Weave, geometry: YarnGeometry) -> tuple[float, tuple[float, float]]:
    """Secant shear modulus [N/m] at 8 degrees between slipping and stuck crossings, and those two bounds."""
    p1, p2 = weave.end_spacing, weave.pick_spacing
    stuck = 12 / (p1 * p2 * (p2 / weave.warp.stiffness + p1 / weave.weft.stiffness))
    radius = sqrt(weave.warp.width * weave.weft.width) / 3  # mean lever of a round contact patch
    torque = YARN_FRICTION * float(geometry.force.mean()) * radius
    slipping = torque / (p1 * p2 * SHEAR_ANGLE)
    return min(stuck, slipping), (min(stuck, slipping), stuck)


def _stretch_bounds(weave: Weave, compliance: float, yarn: Yarn, count: float) -> tuple[float, float]:
    """Tensile stiffness [N/m] with free and with stuck fibres in both yarns: the crimp's compliance goes as 1 / EI."""
    own = weave.warp.stiffness * weave.weft.stiffness
    free = sqrt(weave.warp.stiffness_free * weave.weft.stiffness_free / own)
    stuck = sqrt(weave.warp.stiffness_stuck * weave.weft.stiffness_stuck / own)
    axial = 1 / (yarn.axial * count)
    crimp = max(compliance - axial, 0.0)
    return float(1 / (axial + crimp / min(free, 1.0))), float(1 / (axial + crimp / max(stuck, 1.0)))


def _bending_bounds(weave: Weave, geometry: YarnGeometry) -> list[tuple[float, float]]:
    """Bending stiffness [N m] with free and with stuck fibres, for warp and weft."""
    bounds = []
    for yarn, count, crimp in (
        (weave.warp, weave.ends_per_m, geometry.warp_crimp),
        (weave.weft, weave.picks_per_m, geometry.weft_crimp),
    ):
        share = count / (1 + float(crimp.mean()))
        bounds.append((yarn.stiffness_free * share, yarn.stiffness_stuck * share))
    return bounds


def measured(weave: Weave, geometry: YarnGeometry | ParticleCell | FiguredGeometry) -> dict[str, float]:
    """Crimp, thickness [m] and areal density [kg/m2] of the relaxed repeat, all yarns and only where they are.

    Of a figured weave the means of its cells by their area, and the thickness of the thickest.
    """
    if isinstance(geometry, FiguredGeometry):
        cells = [measured(cell, rest) for cell, rest in zip(weave.cells, geometry.cells, strict=True)]
        mean = {key: float(np.dot(geometry.shares, [cell[key] for cell in cells])) for key in cells[0]}
        return mean | {"thickness": max(cell["thickness"] for cell in cells)}
    warp, weft = float(np.mean(geometry.warp_crimp)), float(np.mean(geometry.weft_crimp))
    width, height = weave.size
    mass = weave.draft.ends * height * (1 + warp) * weave.warp.tex
    systems = strands(weave, geometry)
    for k, system in enumerate(systems[1:]):
        # a yarn that ends at a slit gives one place of its path to the slit, which is no yarn missing
        share = (system.colour >= 0).mean(axis=1) if k else np.ones(len(system.place))
        mass += float(share.sum()) * width * (1 + (weft if k == 0 else 0.0)) * system.yarn.tex
    there = [system for system in systems if (system.colour >= 0).any()]
    tops = [(s.height + s.half_height)[s.colour >= 0].max() for s in there]
    bottoms = [(s.height - s.half_height)[s.colour >= 0].min() for s in there]
    return {
        "crimp_warp": warp,
        "crimp_weft": weft,
        "thickness": float(max(tops) - min(bottoms)),
        "areal_density": mass / (width * height),
    }


def parameters_of(weave: Weave, geometry: YarnGeometry | ParticleCell | FiguredGeometry) -> ClothParameters:
    """Parameters of a relaxed cloth for `cloth.Material.of`: density and thickness of the cell that is given, stiffness
    from stage A of the ground.

    What the model cannot settle is a band in `bounds`: bending between free and stuck fibres, shear between slipping
    and stuck crossings. The ends of a leno or compound weave are counted as if each had its own place. A figured cloth
    has the means of its cells by their area, in bands that hold those of all cells.
    """
    if isinstance(geometry, FiguredGeometry):
        return _of_cells(weave, geometry)
    channels = weave.draft.channels
    ground = replace(ground_of(weave), extra=None)
    if channels.order is not None or channels.layer is not None:
        ground = _stand_in(weave)
    if ground.draft.lift.size > MANY and isinstance(geometry, YarnGeometry) and ground.draft is weave.draft:
        base = geometry
    else:
        base = relax(ground, share=64 if channels.layer is not None else 1)
    made = cloth_parameters(ground, base)
    size = measured(weave, geometry)
    note = dict(made.provenance)
    if channels.order is not None or channels.layer is not None:
        for key in ("stretch_warp", "stretch_weft", "shear", "poisson", "bend_warp", "bend_weft", "bend"):
            note[key] += (
                "; of a plain weave with the same yarns and sett in place of the leno or compound weave"
            )
    stage = "the relaxed particles" if isinstance(geometry, ParticleCell) else "the relaxed beams"
    note["density"] += f"; yarn paths of {stage}"
    return replace(made, density=size["areal_density"], thickness=size["thickness"], provenance=note)


def _of_cells(weave: Weave, geometry: FiguredGeometry) -> ClothParameters:
    """Cells side by side: stiffness and weight as much of each as its share of the area."""
    cells = [parameters_of(cell, rest) for cell, rest in zip(weave.cells, geometry.cells, strict=True)]
    told = [cell.to_dict() for cell in cells]
    shares = ", ".join(f"{share:.0%}" for share in geometry.shares)
    values = {
        key: float(np.dot(geometry.shares, [one[key] for one in told]))
        for key, value in told[0].items()
        if isinstance(value, float)
    }
    values |= {
        "thickness": max(cell.thickness for cell in cells),
        "bend": sqrt(values["bend_warp"] * values["bend_weft"]),
    }
    note = {
        key: f"{text}; mean of {len(cells)} cells by area ({shares})"
        for key, text in cells[0].provenance.items()
    }
    note["thickness"] = f"{cells[0].provenance['thickness']}; of the thickest of {len(cells)} cells"
    bounds = {
        key: (
            min(values[key], *(cell.bounds[key][0] for cell in cells)),
            max(values[key], *(cell.bounds[key][1] for cell in cells)),
        )
        for key in cells[0].bounds
    }
    return ClothParameters(**values, bounds=bounds, provenance=note)


def _stand_in(weave: Weave) -> Weave:
    """A plain weave with the yarns and a sett that fits, for the stiffness of leno and compound weaves."""
    series = [s for s in (weave.draft.channels.end_series, weave.draft.channels.pick_series) if s is not None]
    share = 1 + int(series[0].max()) if weave.draft.channels.layer is not None else 1
    warp = share if weave.draft.channels.end_series is not None else 1
    weft = share if weave.draft.channels.end_series is None else 1
    room = 1.01 * (weave.warp.height + weave.weft.height)
    ends = min(weave.ends_per_m / warp, 1 / (room + weave.warp.width - weave.warp.height))
    picks = min(weave.picks_per_m / weft, 1 / (room + weave.weft.width - weave.weft.height))
    return replace(
        weave, draft=plain(), ends_per_m=ends, picks_per_m=picks, warp_colours=(), weft_colours=(), extra=None
    )
