"""The cheapest mesh whose measured error stays within a budget: the scene tried coarsely, the table for the rest.

The scene is first tried with edges of 64, 45, 32, 23 and 16 mm, for 5 to 15 frames. d, the geometric mean of how far
two of these runs are from the next finer one, is measured on that very sheet: size, pins, wind and material are all in
it. How errors go on from there is what `fidelity.json` knows, from scenes of the kind run on meshes from 8 to 90 mm:

    error(h) = d exp(a[pins] + p[pins] log(h / h0) + r log(h / h0)^2) * margin(h)

with h0 the finest edge in d: 32, 23 or 16 mm, one law each. The margin covers what measured scenes are off by when the
law is fitted to the others alone; each mesh is judged by the law that has the least margin there. A flag is chaotic
after half a second; its edges are no longer than those at which the statistics of all watched flags (mean shape,
fluctuation, kinetic energy, frequency of the free corner) agree with those on finer meshes. A sheet outside what was
measured is refused, not guessed.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from sim_core.cloth.scenes.catalogue import Scene, case_values, checked_cloth, checked_size, scene
from sim_core.cloth.scenes.trial_runs import TRIAL_EDGES, apart, gap, trial_film
from sim_core.cloth.sheet.material import Material
from sim_core.cloth.step.frame import FRAME
from sim_core.errors import SimCoreError, WrongArgument
from sim_core.validation import excerpt, finite, instance_of, integer, vector3

FILE = Path(__file__).with_name("fidelity.json")
GRAVITY, AIR = 9.81, 0.6  # [m/s2]; half the density of air times Cd [kg/m3]
LEAST_CROSS = 0.2  # [m/s] of wind across a flag: without it, rounding decides to which side it buckles
SLACK = {"width": 1.25, "height": 1.25}  # how far beyond the measured scenes a sheet may lie; else twice
TWICE = 2.0


@dataclass(frozen=True)
class Choice:
    """What to run: edge [m], vertices, integrator, or an alternative by its name; bound of its error [mm] and cost
    [ms a frame]; why in words."""

    edge: float
    vertices: int
    integrator: str
    error_mm: float
    ms: float
    why: str


@dataclass(frozen=True)
class Alternative:
    """Another way to the same sheet than to simulate it on a mesh, such as a coarse run that is mended: what it is
    called, its vertices, its measured error [mm] of the kind that `choose` tells, and its cost [ms a frame].

    Raises SimCoreError for values without meaning.
    """

    name: str
    vertices: int
    error_mm: float
    ms: float

    def __post_init__(self) -> None:
        instance_of("alternative.name", self.name, str, "a text is meant")
        integer("alternative.vertices", self.vertices, 1, "how many it ends with")
        finite("alternative.error_mm [mm]", self.error_mm, least=0)
        finite("alternative.ms [ms a frame]", self.ms, least=0)


@dataclass(frozen=True)
class Asked:
    """A sheet in a scene: kind, width and height [m], material, pins (hanging), wind [m/s] (flag)."""

    kind: str
    size: tuple[float, float]
    cloth: Material
    pins: str = ""
    wind: tuple[float, float, float] | None = None
    case: int = 1

    def on(self, edge: float) -> Scene:
        """The scene on a mesh of about such edges [m]."""
        return scene(
            self.kind,
            self.case,
            vertices=vertices(self.size, edge),
            size=self.size,
            pins=self.pins or None,
            wind=self.wind,
            cloth=self.cloth,
        )

    @property
    def traits(self) -> dict[str, float]:
        """What the measured scenes span: m, length over bending length, weight over stretch, wind over weight."""
        weight, length = self.cloth.density * GRAVITY, math.sqrt(self.size[0] * self.size[1])
        found = {"width": self.size[0], "height": self.size[1]}
        found["L/c"] = length / (self.cloth.bend / weight) ** (1 / 3) if self.cloth.bend else math.inf
        found["load"] = weight * length / self.cloth.stretch
        if self.wind is not None:
            found["wind"] = AIR * sum(w * w for w in self.wind) / weight
        return found

    def cost_terms(self, edge: float) -> list[float]:
        """The terms of the cost's law: 1, log of vertices and of substeps, up to a factor."""
        speed = math.sqrt(self.cloth.stretch / self.cloth.density)
        return [1.0, math.log(vertices(self.size, edge)), math.log(speed / edge)]


@lru_cache(maxsize=1)
def table() -> dict[str, Any]:
    """The shipped table: see the head of this module; made by tests/bench/cloth_table.py."""
    return json.loads(FILE.read_text("utf-8"))


def vertices(size: Sequence[float], edge: float) -> int:
    """Vertices of a sheet of `size` [m] with equilateral triangles of such edges [m]."""
    return max(12, round(size[0] * size[1] * 2 / math.sqrt(3) / edge**2))


def law_terms(edge: float, trial: float) -> tuple[float, float]:
    """log(h / h0) of an edge [m] over the finest trial run's, and its square."""
    fine = math.log(edge / trial)
    return fine, fine * fine


def bounds(asked: Asked, told: Sequence[float]) -> list[tuple[float, float, float]]:
    """Edge [m], bound of the error [mm] and cost [ms a frame] of every mesh on offer, finest first; error monotone.

    told: what the trial runs tell [mm], law by law, see `gap`. Of several laws the one with the least margin counts.
    The finest mesh is the one the others were measured against: from the next it is told by the law's slope, at most 1.
    """
    part, best = table()[asked.kind], {}
    for law, distance in zip(part["laws"], told, strict=True):
        start, slope = law["pins"][asked.pins]
        for edge_mm, margin in zip(law["edges_mm"], law["margin"], strict=True):
            fine, square = law_terms(edge_mm, law["trial_edge_mm"])
            bound = distance * math.exp(start + slope * fine + law["curve"] * square) * margin
            best[edge_mm] = min(best.get(edge_mm, (math.inf, 0.0)), (margin, bound))
    found, worst, next_mm = [], 0.0, min(best)
    slope = min(1.0, part["laws"][-1]["pins"][asked.pins][1])
    finest = best[next_mm][1] * (part["reference_mm"] / next_mm) ** slope
    best[part["reference_mm"]] = (math.inf, finest)
    for edge_mm in sorted(best):
        worst = max(worst, best[edge_mm][1])
        terms = asked.cost_terms(edge_mm / 1e3)
        cost = sum(a * b for a, b in zip(part["cost"], terms, strict=True))
        found.append((edge_mm / 1e3, worst, math.exp(cost)))
    return found


def choose(
    name: str,
    *,
    error_mm: float,
    case: int = 1,
    size: Sequence[float] | None = None,
    pins: str | None = None,
    wind: Sequence[float] | None = None,
    cloth: Material | None = None,
    alternatives: Sequence[Alternative] = (),
) -> Choice:
    """The cheapest mesh of a published scene, changed by what is given, that keeps `error_mm` [mm], or the cheapest of
    the alternatives, where one that keeps it costs less than that mesh.

    The error is the mean distance of the sheet's material points from where they would be, in the worst frame of the
    table's `seconds`, mesh and time error together; for a flag also that of its mean shape after 0.5 s. Raises
    SimCoreError for what has no meaning, WrongArgument for a scene the table does not know, a sheet outside what was
    measured, and a budget that not even the finest mesh keeps.
    """
    known = table()
    if not isinstance(name, str) or name not in known:
        raise WrongArgument(
            f"scene {excerpt(name)}: no table of errors – there is one for {', '.join(sorted(known))}"
        )
    finite("error_mm: the budget [mm]", error_mm, above=0)
    asked, others = _asked(name, case, size, pins, wind, cloth), _alternatives(alternatives)
    _within(asked)
    part = known[name]
    frames = round(part["seconds"] / FRAME)
    films = [trial_film(asked.on(edge), asked.size, frames) for edge in TRIAL_EDGES]
    offered = bounds(asked, [gap(films[k : k + 3]) for k in range(len(TRIAL_EDGES) - 2)])
    calm = 1e-3 * part.get("calm_mm", math.inf)
    kept = [row for row in offered if row[1] <= error_mm and row[0] <= calm]
    other = min((one for one in others if one.error_mm <= error_mm), key=lambda one: one.ms, default=None)
    if other is not None and (not kept or other.ms < min(row[2] for row in kept)):
        return _instead(other, asked, kept)
    if not kept:
        edge, least, _ = offered[0]
        raise WrongArgument(
            f"error {error_mm:g} mm – the finest mesh measured, of {1e3 * edge:.2g} mm, keeps {_up(least)} mm for this "
            f"sheet; ask for that, or give --vertices"
        )
    best = min(kept, key=lambda row: row[2])
    why = _why(part, apart(films[0], films[-1]), best, [row for row in offered if row[0] > best[0]])
    return Choice(best[0], vertices(asked.size, best[0]), "auto", best[1], best[2], why)


def _alternatives(given: object) -> tuple[Alternative, ...]:
    if not isinstance(given, list | tuple) or not all(isinstance(one, Alternative) for one in given):
        raise SimCoreError(f"alternatives: {excerpt(given)} – give a list of Alternative")
    return tuple(given)


def _instead(other: Alternative, asked: Asked, kept: Sequence[tuple[float, float, float]]) -> Choice:
    """An alternative that keeps the budget at less than the meshes that do."""
    why = f"{other.name}: measured {other.error_mm:.2g} mm off at {other.ms:.3g} ms a frame; "
    if kept:
        edge, _, cost = min(kept, key=lambda row: row[2])
        why += f"the cheapest mesh that keeps it, of {1e3 * edge:.3g} mm, costs {cost:.3g}"
    else:
        why += "no mesh that was measured keeps it"
    area = asked.size[0] * asked.size[1]
    edge = math.sqrt(area * 2 / math.sqrt(3) / other.vertices)
    return Choice(edge, other.vertices, other.name, other.error_mm, other.ms, why)


def _asked(
    name: str,
    case: int,
    size: Sequence[float] | None,
    pins: str | None,
    wind: Sequence[float] | None,
    cloth: Material | None,
) -> Asked:
    """The sheet that is meant. Raises WrongArgument for what the scene does not take."""
    if pins is not None and name != "hanging":
        raise WrongArgument(f"pins – only the hanging cloth takes them, not {name}")
    if wind is not None and name != "flag":
        raise WrongArgument(f"wind – only the flag stands in the wind, not {name}")
    values = case_values(name, case)
    blown = vector3("wind", values["wind"] if wind is None else wind, "in m/s") if name == "flag" else None
    held = str(values.get("pins", "")) if pins is None else pins
    size = checked_size(values["size"] if size is None else size)
    return Asked(name, size, checked_cloth(cloth), held, blown, case)


def _up(value: float) -> str:
    """Two digits, rounded up, so that what is printed can be asked for."""
    place = 10 ** (1 - math.floor(math.log10(value)))
    return f"{math.ceil(value * place - 1e-9) / place:g}"


def _why(
    part: dict[str, Any], tried: float, best: tuple[float, ...], coarser: list[tuple[float, ...]]
) -> str:
    first, last = (1e3 * edge for edge in (TRIAL_EDGES[0], TRIAL_EDGES[-1]))
    text = (
        f"edges of {1e3 * best[0]:.3g} mm, explicit: from {first:.0f} to {last:.0f} mm this "
        f"sheet changes by {tried:.2g} mm, from which {len(part['scenes'])} measured scenes tell an error of at most "
        f"{best[1]:.2g} mm in the first {part['seconds']:g} s; "
    )
    if not coarser:
        return text + "no coarser mesh was measured"
    edge_mm, worse, _ = 1e3 * coarser[0][0], *coarser[0][1:]
    if edge_mm > part.get("calm_mm", math.inf):
        return text + "on a coarser mesh a flag's statistics after 0.5 s would be others"
    return text + f"the next coarser mesh, {edge_mm:.3g} mm, may err by {worse:.2g} mm"


def _within(asked: Asked) -> None:
    """Raises WrongArgument for a sheet outside the measured scenes."""
    part = table()[asked.kind]
    known = part["laws"][0]["pins"]
    if not isinstance(asked.pins, str) or asked.pins not in known:
        raise WrongArgument(f"pins {excerpt(asked.pins)} – the table has {', '.join(sorted(known))}")
    if asked.wind is not None and abs(asked.wind[2]) < LEAST_CROSS:
        raise WrongArgument(
            f"wind {asked.wind} – with less than {LEAST_CROSS} m/s across the flag rounding decides where it buckles, "
            "and no error can be told; give --vertices"
        )
    for name, value in asked.traits.items():
        low, high = part["measured"][name]
        slack = SLACK.get(name, TWICE)
        if not low / slack <= value <= high * slack:
            raise WrongArgument(
                f"{_TOLD[name]} {value:.3g} – measured are {low:.3g} to {high:.3g}; give --vertices instead of --error"
            )


_TOLD = {
    "width": "width [m]",
    "height": "height [m]",
    "L/c": "length over bending length",
    "load": "weight over stretch stiffness",
    "wind": "pressure of the wind over weight",
}
