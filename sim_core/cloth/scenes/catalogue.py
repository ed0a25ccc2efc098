"""The scenes of the published work and two beside them, read from `scenes.toml`, and two small ones for tests."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.cloth.contact.moving_grid import MovingGrid, moving_mesh
from sim_core.cloth.contact.solids import Capsule, Cylinder, Solid
from sim_core.cloth.run.drape_run import Drape, drape
from sim_core.cloth.scenes.limb import limb_film
from sim_core.cloth.scenes.regular_sheets import disc, equilateral_sheet, sheet_of
from sim_core.cloth.scenes.teapot import teapot_mesh, teapot_solid
from sim_core.cloth.sheet.material import Material
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.air import Air
from sim_core.cloth.step.frame import FRAME, MOST_FRAMES, WIDEST, Contact, Phase
from sim_core.cloth.step.precision import COURANT
from sim_core.errors import SimCoreError, WrongArgument
from sim_core.validation import excerpt, finite, instance_of, integer, vector

FILE = Path(__file__).with_name("scenes.toml")
NAMES = ("flag", "teapot", "hanging", "limb", "drape")
PINS = ("edge", "corners", "corner", "middle", "four", "thirds")

GF_CM = Material(0.05, 49.0, 0.3, 4.9e-5, 0.3, 0.5, 2e-5)  # the preset `gf-cm` of the published scenes


@dataclass(frozen=True)
class Scene:
    """What `drape` needs: sheet, start positions (V, 3) [m], phases, pins, collider, contact, air.

    shown: vertices (T, S, 3) [m] after each frame, and faces, of a body that moves, for a film.
    courant: the share of the stable step at which the scene's time error is small (see DETAILS.md, Measured).
    """

    name: str
    sheet: Sheet
    positions: np.ndarray
    phases: tuple[Phase, ...]
    pins: tuple[int, ...] = ()
    collider: Solid | MovingGrid | None = None
    contact: Contact | None = None
    air: Air | None = None
    courant: float = COURANT
    shown: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def solid(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertices (S, 3), or (T, S, 3) after each frame, [m] and faces of what the cloth lies on; None: of nothing."""
        if self.name == "teapot":
            return teapot_mesh(steps=8)
        if isinstance(self.collider, Cylinder):
            from trimesh.creation import cylinder

            ends = [self.collider.start, self.collider.end]
            body = cylinder(self.collider.radius, segment=ends, sections=96)
            return np.asarray(body.vertices), np.asarray(body.faces, np.int32)
        return self.shown

    def lasting(self, frames: int) -> Scene:
        """The same scene for so many frames of 1/25 s, in its first phase."""
        frames = integer("frames", frames, 1, "1 or more, of 1/25 s", most=MOST_FRAMES)
        body = None if self.phases[0].body is None else (0.0, float(frames))  # a key for each frame
        return replace(self, phases=(replace(self.phases[0], seconds=frames * FRAME, body=body),))

    def gusty(self, gusts: float, seed: int = 0) -> Scene:
        """The same scene in gusts, their share of the wind, rms, seeded.

        Raises WrongArgument where no wind blows.
        """
        gusts = finite("gusts", gusts, least=0)
        if self.air is None:
            raise WrongArgument(f"gusts – only the flag stands in the wind, not {self.name}")
        return replace(self, air=replace(self.air, gusts=gusts, seed=seed))

    def layered(self, layers: float) -> Scene:
        """The same scene with layers of the cloth kept so far apart [m]; 0: they do not feel each other."""
        layers = finite("layers [m]", layers, least=0, most=WIDEST)
        return replace(self, contact=replace(self.contact or Contact(), thickness=layers))

    def drape(self, **settings: Any) -> Drape:
        """Simulates the scene; settings: those of `cloth.drape`."""
        return drape(
            self.sheet,
            self.positions,
            self.phases,
            collider=self.collider,
            contact=self.contact,
            pins=self.pins,
            air=self.air,
            **settings,
        )


@lru_cache(maxsize=1)
def _data() -> dict[str, Any]:
    return tomllib.loads(FILE.read_text("utf-8"))


def cases(name: str) -> int:
    """How many cases a scene of `scenes.toml` has."""
    return len(_data()[name]["cases"])


def case_values(name: str, case: int = 1) -> dict[str, Any]:
    """What `scenes.toml` says of a case (from 1): size and pins, wind or place.

    Raises WrongArgument for a scene or case that is not there.
    """
    if not isinstance(name, str) or name not in NAMES:
        raise WrongArgument(f"scene {excerpt(name)} – there are {', '.join(NAMES)}")
    if not isinstance(case, int) or not 1 <= case <= cases(name):
        raise WrongArgument(f"case {excerpt(case)} – {name} has 1 to {cases(name)}")
    return dict(_data()[name]["cases"][case - 1])


def material() -> Material:
    """The material of all scenes of `scenes.toml`."""
    return Material(**_data()["material"])


def scene(
    name: str,
    case: int = 1,
    *,
    frames: int | None = None,
    vertices: int | None = None,
    size: Sequence[float] | None = None,
    wind: Sequence[float] | None = None,
    pins: str | None = None,
    cloth: Material | None = None,
) -> Scene:
    """A scene of `scenes.toml`: its case (from 1), changed by what is given.

    size: width and height [m]; wind [m/s] (flag); pins: one of PINS (hanging); cloth: another material.
    Raises WrongArgument for what the scene does not have.
    """
    values = case_values(name, case)
    data = _data()[name]
    if wind is not None and name != "flag":
        raise WrongArgument(f"wind – only the flag stands in the wind, not {name}")
    if pins is not None and name != "hanging":
        raise WrongArgument(f"pins – only the hanging cloth takes them, not {name}")
    values |= {k: v for k, v in (("size", size), ("wind", wind), ("pins", pins)) if v is not None}
    (width, height), cloth = checked_size(values["size"]), checked_cloth(cloth)
    count = data["vertices"] if vertices is None else integer("vertices", vertices, 12, "12 or more")
    most = {"least": 1, "why": "1 or more, of 1/25 s", "most": MOST_FRAMES}
    values["frames"] = data["frames"] if frames is None else integer("frames", frames, **most)
    made = _MAKERS[name](values, width, height, count, cloth)
    made = replace(made, courant=values.get("courant", data.get("courant", COURANT)))
    return made.lasting(values["frames"])


def checked_size(size: object) -> tuple[float, float]:
    """Width and height [m] of a sheet; raises WrongArgument for what is none."""
    try:
        width, height = vector("size", size, "width and height of 0.05 to 10 m", 2, least=0.05, most=10.0)
    except SimCoreError as error:
        raise WrongArgument(str(error)) from None
    return width, height


def checked_cloth(cloth: Material | None) -> Material:
    """The material, that of `scenes.toml` if there is none; raises SimCoreError for what is none."""
    return material() if cloth is None else instance_of("cloth", cloth, Material, "a Material is meant")


def _sheet(width: float, height: float, count: int, cloth: Material) -> Sheet:
    rest, faces = sheet_of(width, height, count)
    return Sheet.of(rest, faces, cloth)


def _flag(values: dict[str, Any], width: float, height: float, count: int, cloth: Material) -> Scene:
    sheet = _sheet(width, height, count, cloth)
    positions = np.column_stack([sheet.rest[:, 0], -sheet.rest[:, 1], np.zeros(len(sheet.rest))])
    pins = tuple(int(i) for i in np.flatnonzero(sheet.rest[:, 0] < 1e-9))
    air = Air().blowing(values["wind"])
    return Scene("flag", sheet, positions, (Phase(1.0, label="flag"),), pins=pins, air=air)


def _teapot(values: dict[str, Any], width: float, height: float, count: int, cloth: Material) -> Scene:
    sheet = _sheet(width, height, count, replace(cloth, mass_damping=1.0, stiffness_damping=5e-5))
    scale = _data()["teapot"]["scale"]
    (x, z), top = values["at"], 3.15 * scale + 0.02
    flat = sheet.rest - [width / 2, height / 2]
    positions = np.column_stack([flat[:, 0] + x, np.full(len(flat), top), flat[:, 1] + z])
    contact = Contact(clearance=0.003, sample_clearance=0.001, cap=0.002)
    phases = (Phase(1.0, label="teapot"),)
    return Scene("teapot", sheet, positions, phases, collider=teapot_solid(scale), contact=contact)


def _limb(values: dict[str, Any], width: float, height: float, count: int, cloth: Material) -> Scene:
    sheet = _sheet(width, height, count, replace(cloth, mass_damping=1.0, stiffness_damping=5e-5))
    data, moves = _data()["limb"], {name: values[name] for name in ("swing", "turn", "period", "frames")}
    film, faces = limb_film(data["length"], data["radius"], still=data["still"], **moves)
    flat = sheet.rest - [width / 2, height / 2]
    top = data["radius"] + 0.02
    positions = np.column_stack([flat[:, 0] + data["length"] / 2, np.full(len(flat), top), flat[:, 1]])
    phases = (Phase(1.0, label="limb", body=(0.0, 1.0)),)
    contact = Contact(clearance=0.003, sample_clearance=0.001)
    body, shown = moving_mesh(film, faces), (film[1:], faces)
    return Scene("limb", sheet, positions, phases, collider=body, contact=contact, shown=shown)


def _hanging(values: dict[str, Any], width: float, height: float, count: int, cloth: Material) -> Scene:
    sheet = _sheet(width, height, count, cloth)
    positions = np.column_stack([sheet.rest[:, 0], np.zeros(len(sheet.rest)), sheet.rest[:, 1]])
    pins = pinned(sheet.rest, width, height, values["pins"])
    return Scene("hanging", sheet, positions, (Phase(1.0, label="hanging"),), pins=pins)


def pinned(rest: np.ndarray, width: float, height: float, kind: str) -> tuple[int, ...]:
    """The vertices a set of pins holds, `kind` one of PINS, on a sheet whose rest (V, 2) starts at the origin."""
    if not isinstance(kind, str) or kind not in PINS:
        raise WrongArgument(f"pins: {excerpt(kind)} – there are {', '.join(PINS)}")
    if kind == "edge":
        return tuple(int(i) for i in np.flatnonzero(rest[:, 1] < 1e-9))
    places = {
        "corners": [(0, 0), (1, 0)],
        "corner": [(0, 0)],
        "middle": [(0.5, 0.5)],
        "four": [(0, 0), (1, 0), (0, 1), (1, 1)],
        "thirds": [(0, 0), (1 / 3, 0), (2 / 3, 0), (1, 0)],
    }[kind]
    away = [((rest - [a * width, b * height]) ** 2).sum(1) for a, b in places]
    return tuple(sorted({int(np.argmin(d)) for d in away}))


def _drape(values: dict[str, Any], width: float, height: float, count: int, cloth: Material) -> Scene:
    if width != height:
        raise WrongArgument(f"size {width} x {height} – the disc of the drape test is as wide as high")
    edge = width / 2 / max(2, round((np.sqrt(12 * count - 3) - 3) / 6))
    rest, faces = disc(width, edge)
    cloth = replace(cloth, bend=cloth.bend * values["stiffer"], mass_damping=2.0)
    sheet = Sheet.of(rest, faces, cloth)
    # A disc that lies exactly flat falls into folds as rounding has it; a tenth of a millimetre decides instead.
    bump = 1e-4 * np.cos(7 * np.arctan2(rest[:, 1], rest[:, 0])) * np.hypot(*rest.T) / (width / 2)
    positions = np.column_stack([rest[:, 0], 0.0035 + bump, rest[:, 1]])
    pedestal = Cylinder((0.0, -0.05, 0.0), (0.0, 0.0, 0.0), 0.3 * width, 0.002)
    contact = Contact(clearance=0.003, sample_clearance=0.001)
    phases = (Phase(1.0, label="drape"),)
    return Scene("drape", sheet, positions, phases, collider=pedestal, contact=contact)


_MAKERS = {"flag": _flag, "teapot": _teapot, "hanging": _hanging, "limb": _limb, "drape": _drape}


def drape_coefficient(positions: np.ndarray, faces: np.ndarray, width: float) -> float:
    """Share of the overhanging ring whose shadow is left: (A - A18) / (A30 - A18), positions (V, 3) [m]."""
    import shapely

    triangles = positions[faces][:, :, [0, 2]]
    shadow = shapely.union_all(shapely.polygons(triangles)).area
    inner, outer = np.pi * (0.3 * width) ** 2, np.pi * (width / 2) ** 2
    return float((shadow - inner) / (outer - inner))


def hang_edge(edge: float = 0.0134, *, seconds: float = 1.0, material: Material = GF_CM) -> Scene:
    """A horizontal 1 x 1 m sheet let go with one edge pinned: the comparison scene of the published work."""
    rest, faces = equilateral_sheet(1.0, 1.0, edge)
    positions = np.stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]], axis=1)
    pins = tuple(int(i) for i in np.flatnonzero(rest[:, 1] < 1e-9))
    sheet, phases = Sheet.of(rest, faces, material), (Phase(seconds, label="hanging"),)
    return Scene("hang", sheet, positions, phases, pins=pins)


def bar(edge: float = 0.02, *, seconds: float = 1.6) -> Scene:
    """A 0.3 x 0.8 m sheet dropped on a round bar: contact, friction and self-contact in a few seconds."""
    rest, faces = equilateral_sheet(0.3, 0.8, edge)
    positions = np.stack([rest[:, 0] - 0.15, np.full(len(rest), 1.03), rest[:, 1] - 0.38], axis=1)
    material = Material(0.08, 100.0, 0.3, 2e-5, 0.5, 1.0, 2e-5)
    contact = Contact(clearance=0.004, sample_clearance=0.001, thickness=0.003, speed_limit=4.0)
    phases = (Phase(seconds, damping=1.5, label="falling"), Phase(seconds / 2, damping=10.0, label="resting"))
    solid = Capsule((-0.3, 1.0, 0.0), (0.3, 1.0, 0.0), 0.02)
    return Scene("bar", Sheet.of(rest, faces, material), positions, phases, collider=solid, contact=contact)
