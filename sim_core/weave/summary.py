"""The summary of a relaxed weave: the keys of `simcore weave --json`, SI units throughout."""

from __future__ import annotations

import numpy as np

from sim_core.weave.cloth import ClothParameters, KesReadings, examined, measured
from sim_core.weave.draft.factors import Factors
from sim_core.weave.files.sources import Source
from sim_core.weave.files.wif.sections import listed
from sim_core.weave.instruments import Reading
from sim_core.weave.maps.figured_maps import drawn_maps
from sim_core.weave.model import Weave
from sim_core.weave.weave_file import Published
from sim_core.weave.yarns.geometry import FiguredGeometry, YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.solver import solve

__all__ = ["beside_published", "facts_of", "summary_of", "summary_text"]

OPENNESS_PIXELS = 256  # of the map that tells how much of a cloth is open
NO_SOURCE = "no source"
KES_KEYS = {"bending": "B", "shear": "G", "tensile": "EMT"}
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

    `floats` as a weaver counts them (`craft_floats`), null where none are meant, `extra` of brocading wefts.
    `repeat` is the smallest that makes up the whole draft. Of a file of another program also its size and period (a
    repeat of which the last may be cut off), what does not interlace (numbers from 1), its colours, the drawdown of up
    to 65,536 crossings (one text a pick, 1 = warp on top), and what the reader had to replace.
    """
    facts = source.facts
    made = {
        "repeat": {"ends": facts.ends, "picks": facts.picks},
        "face": facts.face,
        "floats": {
            side: {"longest": floats and floats.longest, "mean": floats and floats.mean}
            for side, floats in source.floats.items()
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


def summary_of(
    weave: Weave, geometry: YarnGeometry | ParticleCell | FiguredGeometry, seconds: float, origin: str
) -> dict:
    """What the relaxed cloth tells: the keys of the command's JSON beside `facts_of`.

    seconds: that the relaxation took.  origin: of yarns and sett.  Of a figured cloth also `cells`: the share of the
    area, the weave and the summary of each; what is told of the whole is their mean, or the worst of them.
    `thickness` is that between plates at .5 gf/cm2, `height` from the highest to the lowest point without them;
    `compression`, `bending`, `shear`, `tensile` are readings of the instruments, missing beyond 4,096 crossings.
    """
    size = measured(weave, geometry)
    parameters, tests = examined(weave, geometry)
    if isinstance(geometry, FiguredGeometry):
        cells = [
            {
                "share": share,
                "repeat": {"ends": cell.draft.ends, "picks": cell.draft.picks},
                "face": cell.draft.face,
            }
            | summary_of(cell, rest, 0.0, origin)
            for share, cell, rest in zip(geometry.shares, weave.cells, geometry.cells, strict=True)
        ]
        for cell in cells:
            del cell["seconds"]
        whole = {key: max(cell[key] for cell in cells) for key in ("residual", "penetration")}
        take_up = {
            f"take_up_{side}": {"value": crimp / (1 + crimp), "unit": "1", "provenance": TAKE_UP}
            for side, crimp in (("warp", size["crimp_warp"]), ("weft", size["crimp_weft"]))
        }
        covered = cells[0]["penetration_of"]
    else:
        deep = geometry.penetration
        if not isinstance(geometry, ParticleCell):
            deep /= (weave.warp.height + weave.weft.height) / 2
        whole = {"residual": geometry.residual, "penetration": deep}
        take_up, covered, cells = _take_up(weave, geometry), _covered(weave, geometry), []
    return {
        "crimp": {"warp": size["crimp_warp"], "weft": size["crimp_weft"]},
        "thickness": parameters.thickness,
        "height": size["thickness"],
        "areal_density": size["areal_density"],
        "openness": 1.0 - float(drawn_maps(weave, geometry, pixels=OPENNESS_PIXELS).opacity.mean()) / 255,
        **whole,
        "penetration_of": covered,
        "seconds": seconds,
        **told(tests),
        "parameters": {**_entries(parameters), **take_up, "yarns_from": origin},
        **({"cells": cells} if cells else {}),
    }


def beside_published(summary: dict, published: Published | None) -> dict:
    """`published`: of each value what a source tells, with ours and how far it lies from the nearest that is told, as a
    share of that; or "no source"."""
    given = published.values() if published else dict.fromkeys(Published.model_fields.keys() - {"source"})
    found: dict = {"source": published.source} if published else {}
    for name in ("areal_density", "openness", "thickness", "bending", "shear", "tensile"):
        value, ours = given[name], _ours(summary, name)
        if value is None or ours is None:
            found[name] = NO_SOURCE
            continue
        least, most = value if isinstance(value, list) else (value, value)
        nearest = min(max(ours, least), most)
        found[name] = {"value": value, "ours": ours, "off": ours / nearest - 1}
    return {"published": found}


def _ours(summary: dict, name: str) -> float | None:
    """The value that a source's is held against; of bending and tensile the mean of warp and weft."""
    value = summary.get(name)
    if not isinstance(value, dict):
        return value
    readings = [side[KES_KEYS[name]] for side in dict(_sides(value)).values()]
    return sum(one["value"] for one in readings) / len(readings)


def told(tests: KesReadings) -> dict:
    """Readings as JSON holds them, in SI units and in those of KES."""
    return {
        name: value.to_dict() if isinstance(value, Reading) else told(value) for name, value in tests.items()
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
        text += ", and yarns that do not show beneath those that do; not hidden ones beside each other"
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


def summary_text(name: str, summary: dict) -> str:
    """The summary for people, a line a topic."""
    repeat = summary["repeat"]
    lines = [
        f"{name}: {repeat['ends']} ends x {repeat['picks']} picks, {summary['face']} face, "
        f"{_float_words(summary['floats'])}, "
        f"{'hangs together' if summary['integral'] else 'FALLS APART'}"
    ]
    lines += _draft_lines(summary)
    if "crimp" in summary:
        crimp = summary["crimp"]
        lines.append(
            f"  crimp {crimp['warp']:.2%} warp {crimp['weft']:.2%} weft, {summary['thickness'] * 1e6:.0f} um thick, "
            f"{summary['areal_density'] * 1e3:.1f} g/m2, {summary['openness']:.1%} open"
        )
    for key, entry in summary.get("parameters", {}).items():
        if isinstance(entry, dict) and "value" in entry:
            band = entry.get("band")
            between = f"   between {band[0]:.3g} and {band[1]:.3g}" if band else ""
            lines.append(f"  {key:<13}{entry['value']:10.3g} {entry['unit']}{between}")
    lines += _test_lines(summary) + _published_lines(summary.get("published"))
    for number, cell in enumerate(summary.get("cells", ())):
        repeat, crimp = cell["repeat"], cell["crimp"]
        lines.append(
            f"  cell {number}: {cell['share']:.0%} of the cloth, {repeat['ends']} ends x {repeat['picks']} picks, "
            f"{cell['face']} face, crimp {crimp['warp']:.2%} warp {crimp['weft']:.2%} weft, "
            f"{cell['areal_density'] * 1e3:.1f} g/m2"
        )
    if "note" in summary:
        lines.append(f"  {summary['note']}")
    if "drawn" in summary:
        drawn = summary["drawn"]
        lines.append(f"  drawn: {listed(drawn) if len(drawn) < 5 else f'{drawn[0]} to {drawn[-1]}'}")
    return "\n".join(lines)


def _float_words(floats: dict) -> str:
    """The longest floats, and of which yarns none are told."""
    told = [f"{one['longest']} {side}" for side, one in floats.items() if one["longest"] is not None]
    without = [side for side, one in floats.items() if one["longest"] is None]
    words = [f"longest float {' '.join(told)}"] if told else []
    return ", ".join([*words, f"no floats of {' and '.join(without)}"] if without else words)


def _test_lines(summary: dict) -> list[str]:
    """What the instruments read, in KES units, a line a test."""

    def row(readings: dict) -> str:
        return ", ".join(
            f"{name} {one['kes']:.3g}" + (f" {one['kes_unit']}" if one["kes_unit"] != "1" else "")
            for name, one in readings.items()
        )

    lines = []
    for test in ("compression", "bending", "shear", "tensile"):
        for side, readings in _sides(summary.get(test)):
            lines.append(f"  KES {test:<12}{side:<5}{row(readings)}")
    return lines


def _published_lines(published: dict | None) -> list[str]:
    """What is published of such a cloth beside ours, and of what nothing was found."""
    if published is None:
        return []
    lines = [f"  published: {published['source']}"] if "source" in published else []
    for name, found in published.items():
        if isinstance(found, dict):
            value = found["value"]
            between = " to ".join(f"{one:.3g}" for one in (value if isinstance(value, list) else [value]))
            here = f"{found['ours']:.3g} here ({found['off']:+.0%})"
            lines.append(f"  {name.replace('_', ' '):<15}{between} published, {here}")
    lacking = [name.replace("_", " ") for name, found in published.items() if found == NO_SOURCE]
    return [*lines, f"  no source of {listed(lacking, len(lacking))}"] if lacking else lines


def _sides(test: dict | None) -> list[tuple[str, dict]]:
    if not test:
        return []
    return list(test.items()) if "warp" in test else [("", test)]


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
