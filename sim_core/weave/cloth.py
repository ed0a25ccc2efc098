"""The cloth that relaxed yarns make, as instruments measure it: weight, thickness and stiffness.

Each parameter carries its formula; what the model cannot settle is a band.
"""

from dataclasses import asdict, dataclass, field, replace
from math import sqrt
from typing import Any

import numpy as np

from sim_core.weave.draft.draft import plain
from sim_core.weave.instruments import Laboratory, Reading, mean_reading
from sim_core.weave.model import Weave
from sim_core.weave.yarns.beams import relax
from sim_core.weave.yarns.geometry import FiguredGeometry, YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.paths import strands
from sim_core.weave.yarns.shifts import MANY
from sim_core.weave.yarns.solver import ground_of

__all__ = ["ClothParameters", "KesReadings", "examined", "measured", "parameters_of"]

KesReadings = dict[str, dict[str, Any]]  # test -> reading by name, or side -> reading by name
MOST_TESTED = 4_096  # crossings of a repeat that is pulled to 500 gf/cm: seconds
BANDS = "; band: what is assumed of finish and fibre, varied one at a time"
PROVENANCE = {
    "density": "sum over warp and weft of yarns per metre x linear density x (1 + crimp of the relaxed yarn)",
    "thickness": "between plates at .5 gf/cm2 (KES-FB3): highest minus lowest point of the relaxed yarns, less what "
    "the plates take off beams that kept .9 of their crimp" + BANDS,
    "stretch_warp": "uniaxial, slope at rest: crimp that straightens, and EA x ends per metre in series"
    + BANDS,
    "stretch_weft": "as stretch_warp, for the picks",
    "poisson": "crimp interchange: -S12 / sqrt(S11 S22) of the symmetric compliance of the relaxed repeat, "
    "not below 0 (long floats can turn its sign)",
    "shear": "secant at 8 degrees as KES-FB1 shears, without what its pull adds: friction of the crossings (mean "
    "crossing force of set yarns x 0.25 (assumed) x mean arm of the patch) per cell, at most the frame of "
    "yarns that bend between held crossings" + BANDS,
    "bend": "geometric mean of bend_warp and bend_weft",
    "bend_warp": "B of KES-FB2: slope of the loop from .5 to 1.5 /cm, filaments free between crossings and held "
    "where pressed until they slide, x ends per metre / (1 + crimp)" + BANDS,
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
    """Parameters of a relaxed cloth for `cloth.Material.of`: density of the cell that is given, thickness of it between
    plates, stiffness as the instruments find it on stage A of the ground.

    What the model cannot settle is a band in `bounds`. Yarn level values, so the tensile stiffness is that of yarns
    whose crimp straightens: a cloth solver may have to soften it for its time step, and should say so. The ends of a
    leno or compound weave are counted as if each had its own place. A figured cloth has the means of its cells by
    their area, and of the ends of their bands; beyond 10,000 crossings nothing is varied and nothing pressed.
    """
    return examined(weave, geometry, tests=False)[0]


def examined(
    weave: Weave, geometry: YarnGeometry | ParticleCell | FiguredGeometry, *, tests: bool = True
) -> tuple[ClothParameters, KesReadings]:
    """`parameters_of`, and what the instruments of Kawabata's evaluation system read on the cloth.

    `compression` T0, TM [m]; `bending` of warp and weft, B [N m] and 2HB [N]; `shear` G [N/m per rad], 2HG and 2HG5
    [N/m]; `tensile` of warp and weft, EMT, LT, WT [J/m2], RT. Of a figured cloth means of its cells by area, the
    thickness that of the thickest. No readings without `tests` or beyond 4,096 crossings, whose pull takes minutes.
    """
    if isinstance(geometry, FiguredGeometry):
        cells = [
            examined(cell, rest, tests=tests) for cell, rest in zip(weave.cells, geometry.cells, strict=True)
        ]
        readings = [read for _, read in cells]
        together = _mean_readings(readings, geometry.shares) if all(readings) else {}
        return _of_cells([parameters for parameters, _ in cells], geometry.shares), together
    ground, base = _ground(weave, geometry)
    laboratory, height = Laboratory(ground, base, vary=base.force.size <= MANY), measured(weave, geometry)
    parameters = _parameters(weave, geometry, laboratory, height)
    if not tests or base.force.size > MOST_TESTED:
        return parameters, {}
    return parameters, {
        "compression": _pressed(laboratory, height["thickness"]),
        "bending": laboratory.bending,
        "shear": {name: laboratory.shear[name] for name in ("G", "2HG", "2HG5")},
        "tensile": laboratory.tensile,
    }


def _parameters(
    weave: Weave, geometry: YarnGeometry | ParticleCell, laboratory: Laboratory, size: dict[str, float]
) -> ClothParameters:
    """size: of `measured`."""
    compliance, compliances = laboratory.compliance
    shear, warp, weft = (
        laboratory.shear["secant"],
        *(laboratory.bending[side]["B"] for side in ("warp", "weft")),
    )
    note = dict(PROVENANCE)
    if _held_apart(weave):
        for key in ("stretch_warp", "stretch_weft", "shear", "poisson", "bend_warp", "bend_weft", "bend"):
            note[key] += (
                "; of a plain weave with the same yarns and sett in place of the leno or compound weave"
            )
    stage = "the relaxed particles" if isinstance(geometry, ParticleCell) else "the relaxed beams"
    note["density"] += f"; yarn paths of {stage}"
    if laboratory.own.rest.force.size > MANY:
        note["thickness"] = "highest minus lowest point of the relaxed yarns"
        thickness = Reading("T0", size["thickness"], (size["thickness"], size["thickness"]))
    else:
        thickness = _pressed(laboratory, size["thickness"])["T0"]
    return ClothParameters(
        density=size["areal_density"],
        thickness=thickness.value,
        stretch_warp=1 / compliance[0, 0],
        stretch_weft=1 / compliance[1, 1],
        shear=shear.value,
        poisson=float(np.clip(-compliance[0, 1] / sqrt(compliance[0, 0] * compliance[1, 1]), 0.0, 1.0)),
        bend=sqrt(warp.value * weft.value),
        friction=weave.friction,
        bend_warp=warp.value,
        bend_weft=weft.value,
        bounds={
            "thickness": thickness.band,
            "shear": shear.band,
            "bend_warp": warp.band,
            "bend_weft": weft.band,
            "stretch_warp": _stiffest([compliance, *compliances], 0),
            "stretch_weft": _stiffest([compliance, *compliances], 1),
        },
        provenance=note,
    )


def _ground(weave: Weave, geometry: YarnGeometry | ParticleCell) -> tuple[Weave, YarnGeometry]:
    """The simple cloth whose stiffness is taken for the weave's, and its stage A."""
    ground = replace(ground_of(weave), extra=None)
    if _held_apart(weave):
        ground = _stand_in(weave)
    if ground.draft.lift.size > MANY and isinstance(geometry, YarnGeometry) and ground.draft is weave.draft:
        return ground, geometry
    return ground, relax(ground, crowded=weave.draft.channels.layer is not None)


def _held_apart(weave: Weave) -> bool:
    """Whether ends change places or several yarns share one."""
    channels = weave.draft.channels
    return channels.order is not None or channels.layer is not None


def _pressed(laboratory: Laboratory, thickness: float) -> dict[str, Reading]:
    """T0 and TM of a cloth that is `thickness` [m] from its highest to its lowest point: less by what the plates take
    off the ground's beams, or where these are not its own, by the same share."""
    read = laboratory.thickness
    scale = thickness / read["free"].value
    return {
        name: Reading(
            name, scale * read[name].value, (scale * read[name].band[0], scale * read[name].band[1])
        )
        for name in ("T0", "TM")
    }


def _stiffest(compliances: list[np.ndarray], side: int) -> tuple[float, float]:
    found = [1 / float(one[side, side]) for one in compliances]
    return min(found), max(found)


def _mean_readings(cells: list[KesReadings], shares: tuple[float, ...]) -> KesReadings:
    """Cells side by side; plates rest on the thickest."""

    def together(parts: list[dict]) -> dict:
        return {
            name: together([part[name] for part in parts])
            if isinstance(value, dict)
            else mean_reading([part[name] for part in parts], list(shares))
            for name, value in parts[0].items()
        }

    made = together([dict(cell) for cell in cells])
    for name in made["compression"]:
        made["compression"][name] = max(
            (cell["compression"][name] for cell in cells), key=lambda one: one.value
        )
    return made


def _of_cells(cells: list[ClothParameters], shares: tuple[float, ...]) -> ClothParameters:
    """Cells side by side: of stiffness and weight the means by area, and so of the ends of the bands."""
    told = [cell.to_dict() for cell in cells]
    percent = ", ".join(f"{share:.0%}" for share in shares)
    values = {
        key: float(np.dot(shares, [one[key] for one in told]))
        for key, value in told[0].items()
        if isinstance(value, float)
    }
    thickest = max(cells, key=lambda cell: cell.thickness)
    values |= {
        "thickness": thickest.thickness,
        "bend": sqrt(values["bend_warp"] * values["bend_weft"]),
    }
    note = {
        key: f"{text}; mean of {len(cells)} cells by area ({percent})"
        for key, text in cells[0].provenance.items()
    }
    note["thickness"] = f"{cells[0].provenance['thickness']}; of the thickest of {len(cells)} cells"
    bounds = {
        key: (
            float(np.dot(shares, [cell.bounds[key][0] for cell in cells])),
            float(np.dot(shares, [cell.bounds[key][1] for cell in cells])),
        )
        for key in cells[0].bounds
    }
    bounds["thickness"] = thickest.bounds["thickness"]
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
