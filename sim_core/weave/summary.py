"""The summary of a relaxed weave: the keys of `simcore weave --json`, SI units throughout."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_core.weave.cloth import cloth_parameters
from sim_core.weave.draft.factors import Factors
from sim_core.weave.files.sources import Source
from sim_core.weave.files.wif.sections import listed
from sim_core.weave.model import Weave
from sim_core.weave.yarns.geometry import ClothParameters, YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.paths import strands
from sim_core.weave.yarns.solver import ground_of, solve

__all__ = ["facts_of", "measured", "parameters_of", "summary_of", "summary_text"]

MOST_SHOWN = 65_536  # crossings of a drawdown told in full
UNITS = {
    "density": "kg/m2",
    "thickness": "m",
    "stretch_warp": "N/m",
    "stretch_weft": "N/m",
    "shear": "N/m",
    "poisson": "1",
    "bend": "N m",
    "bend_warp": "N m",
    "bend_weft": "N m",
    "friction": "1",
    "take_up_warp": "1",
    "take_up_weft": "1",
}
TAKE_UP = (
    "crimp / (1 + crimp): share of the yarn's length that the cloth takes up; band: beams held at their places (stage "
    "A) and particles free to slide with friction (stage B), since the crimp of floats depends on how the cloth "
    "was handled"
)


def facts_of(source: Source) -> dict:
    """What a draft tells without physics: the first keys of the command's JSON.

    `repeat` is the smallest that makes up the whole draft. Of a file of another program also its size and period (a
    repeat of which the last may be cut off), what does not interlace (numbers from 1), its colours, the drawdown of up
    to 65,536 crossings (one text a pick, 1 = warp on top), and what the reader had to replace.
    """
    facts = source.facts
    made = {
        "repeat": {"ends": facts.ends, "picks": facts.picks},
        "face": facts.face,
        "floats": {
            side: {"longest": floats.longest, "mean": floats.mean}
            for side, floats in (("warp", facts.warp), ("weft", facts.weft))
        },
        "interlacings": facts.interlacings,
        "integral": facts.integral,
    }
    if source.wif is None:
        return made
    factors, tieup = source.factors, source.harness.tieup
    picks, ends = factors.loose()
    size = {"title": source.name, "ends": factors.ends, "picks": factors.picks, "shafts": tieup.shape[0]}
    size["period"] = {"ends": factors.periods[1], "picks": factors.periods[0]}
    return made | {
        "draft": size | ({"lift_plan": True} if source.plan else {"treadles": tieup.shape[1]}),
        "loose": {"ends": (ends + 1).tolist(), "picks": (picks + 1).tolist()},
        "colours": {
            "warp": _counted(source.palette, source.warp_colours),
            "weft": _counted(source.palette, source.weft_colours),
        },
        "drawdown": _rows(factors) if factors.picks * factors.ends <= MOST_SHOWN else None,
        "remarks": list(source.remarks),
    }


def _counted(palette: np.ndarray, colours: np.ndarray) -> list[dict]:
    """Each colour that is used, with how many yarns have it."""
    used, counts = np.unique(colours, return_counts=True)
    return [
        {"colour": "#{:02x}{:02x}{:02x}".format(*palette[k]), "number": int(k) + 1, "yarns": int(n)}
        for k, n in zip(used, counts, strict=True)
    ]


def _rows(factors: Factors) -> list[str]:
    return ["".join("1" if over else "0" for over in pick) for pick in factors.lift()]


def summary_of(weave: Weave, geometry: YarnGeometry | ParticleCell, seconds: float, origin: str) -> dict:
    """What the relaxed cloth tells: the keys of the command's JSON beside `facts_of`.

    seconds: that the relaxation took.  origin: of yarns and sett.
    """
    size = measured(weave, geometry)
    parameters = parameters_of(weave, geometry)
    deep = geometry.penetration
    if not isinstance(geometry, ParticleCell):
        deep /= (weave.warp.height + weave.weft.height) / 2
    return {
        "crimp": {"warp": size["crimp_warp"], "weft": size["crimp_weft"]},
        "thickness": size["thickness"],
        "areal_density": size["areal_density"],
        "residual": geometry.residual,
        "penetration": deep,
        "penetration_of": _covered(weave, geometry),
        "seconds": seconds,
        "parameters": {**_entries(parameters), **_take_up(weave, geometry), "yarns_from": origin},
    }


def _covered(weave: Weave, geometry: YarnGeometry | ParticleCell) -> str:
    """Which overlaps `penetration` measures, and which yarns it leaves out."""
    if isinstance(geometry, ParticleCell):
        text = "curves of warp and weft at all crossings, and particles of neighbouring yarns"
    else:
        text = "warp and weft at the crossings"
    if weave.extra is not None:
        text += "; not extra wefts, which are laid on the relaxed ground"
    if weave.draft.channels.layer is not None:
        text += "; not yarns of a compound weave that do not show, which are placed beneath"
    if weave.draft.channels.order is not None and weave.draft.channels.layer is None:
        text += "; not ends where they cross one another"
    return text


def _take_up(weave: Weave, geometry: YarnGeometry | ParticleCell) -> dict:
    """Take-up of warp and weft, with the band between both stages where stage B was run."""
    kinds = [geometry]
    if isinstance(geometry, ParticleCell):
        kinds.append(solve(weave))
    entries = {}
    for side in ("warp", "weft"):
        shares = [c / (1 + c) for c in (float(np.mean(getattr(kind, f"{side}_crimp"))) for kind in kinds)]
        entries[f"take_up_{side}"] = {
            "value": shares[0],
            "unit": UNITS[f"take_up_{side}"],
            "provenance": TAKE_UP,
        }
        if len(shares) > 1:
            entries[f"take_up_{side}"]["band"] = [min(shares), max(shares)]
    return entries


def _entries(parameters: ClothParameters) -> dict:
    values = parameters.to_dict()
    entries = {}
    for key, unit in UNITS.items():
        if key not in values:
            continue
        entries[key] = {"value": values[key], "unit": unit, "provenance": parameters.provenance[key]}
        if key in parameters.bounds:
            entries[key]["band"] = list(parameters.bounds[key])
    return entries


def measured(weave: Weave, geometry: YarnGeometry | ParticleCell) -> dict[str, float]:
    """Crimp, thickness [m] and areal density [kg/m2] of the relaxed repeat, all yarns and only where they are."""
    warp, weft = float(np.mean(geometry.warp_crimp)), float(np.mean(geometry.weft_crimp))
    width, height = weave.size
    mass = weave.draft.ends * height * (1 + warp) * weave.warp.tex
    systems = strands(weave, geometry)
    for k, system in enumerate(systems[1:]):
        # a yarn that ends at a slit gives one place of its path to the slit, which is no yarn missing
        there = (system.colour >= 0).mean(axis=1) if k else np.ones(len(system.place))
        mass += float(there.sum()) * width * (1 + (weft if k == 0 else 0.0)) * system.yarn.tex
    tops = [(s.height + s.yarn.height / 2)[s.colour >= 0].max() for s in systems]
    bottoms = [(s.height - s.yarn.height / 2)[s.colour >= 0].min() for s in systems]
    return {
        "crimp_warp": warp,
        "crimp_weft": weft,
        "thickness": float(max(tops) - min(bottoms)),
        "areal_density": mass / (width * height),
    }


def parameters_of(weave: Weave, geometry: YarnGeometry | ParticleCell) -> ClothParameters:
    """Parameters of a relaxed cloth for `cloth.Material.of`: density and thickness of the cell that is given, stiffness
    from stage A of the ground.

    What the model cannot settle is a band in `bounds`: bending between free and stuck fibres, shear between slipping
    and stuck crossings. The ends of a leno or compound weave are counted as if each had its own place.
    """
    channels = weave.draft.channels
    plain = replace(ground_of(weave), extra=None)
    if channels.order is not None or channels.layer is not None:
        plain = _stand_in(weave)
    from sim_core.weave.yarns.beams import relax
    from sim_core.weave.yarns.shifts import MANY

    if plain.draft.lift.size > MANY and isinstance(geometry, YarnGeometry) and plain.draft is weave.draft:
        base = geometry
    else:
        base = relax(plain, share=64 if plain is not weave and channels.layer is not None else 1)
    made = cloth_parameters(plain, base)
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


def _stand_in(weave: Weave) -> Weave:
    """A plain weave with the yarns and a sett that fits, for the stiffness of leno and compound weaves."""
    from sim_core.weave.draft.draft import plain

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


def summary_text(name: str, summary: dict) -> str:
    """The summary for people, a line a topic."""
    repeat, floats = summary["repeat"], summary["floats"]
    lines = [
        f"{name}: {repeat['ends']} ends x {repeat['picks']} picks, {summary['face']} face, longest float "
        f"{floats['warp']['longest']} warp {floats['weft']['longest']} weft, "
        f"{'hangs together' if summary['integral'] else 'FALLS APART'}"
    ]
    lines += _draft_lines(summary)
    if "crimp" in summary:
        crimp = summary["crimp"]
        lines.append(
            f"  crimp {crimp['warp']:.2%} warp {crimp['weft']:.2%} weft, {summary['thickness'] * 1e6:.0f} um thick, "
            f"{summary['areal_density'] * 1e3:.1f} g/m2"
        )
    for key, entry in summary.get("parameters", {}).items():
        if isinstance(entry, dict) and "value" in entry:
            band = entry.get("band")
            between = f"   between {band[0]:.3g} and {band[1]:.3g}" if band else ""
            lines.append(f"  {key:<13}{entry['value']:10.3g} {entry['unit']}{between}")
    if "note" in summary:
        lines.append(f"  {summary['note']}")
    if "drawn" in summary:
        drawn = summary["drawn"]
        lines.append(f"  drawn: {listed(drawn) if len(drawn) < 5 else f'{drawn[0]} to {drawn[-1]}'}")
    return "\n".join(lines)


def _draft_lines(summary: dict) -> list[str]:
    """What a file of another program says besides: its size, its colours, what does not interlace."""
    if "draft" not in summary:
        return []
    draft, colours = summary["draft"], summary["colours"]
    how = "lift plan" if "lift_plan" in draft else f"{draft['treadles']} treadles"
    lines = [f"  {draft['ends']} ends on {draft['shafts']} shafts, {draft['picks']} picks, {how}"]
    for side, used in colours.items():
        lines.append(f"  {side:<5}" + listed([f"{entry['yarns']} {entry['colour']}" for entry in used], 6))
    for side, loose in summary["loose"].items():
        if loose:
            lines.append(f"  never interlace: {side} {listed(loose)}")
    return lines
