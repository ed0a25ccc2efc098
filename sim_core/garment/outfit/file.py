"""Reads outfit files: every path, pattern, weave, pose and step is looked at here, before anything runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from sim_core.body import (
    Cover,
    Figure,
    Mannequin,
    Petticoat,
    Pose,
    Stand,
    TBar,
    covered,
    load_motion,
    pose_named,
)
from sim_core.body.pose import T_POSE
from sim_core.cloth import Contact
from sim_core.errors import FileProblem, SimCoreError
from sim_core.garment.outfit.outfit import UNTANGLE, Layer, Outfit, Program
from sim_core.garment.outfit.steps import Belt, Step, Touch
from sim_core.garment.outfit.tables import (
    CoverTable,
    LayerTable,
    OutfitTable,
    Place,
    PoseTable,
    ProgramTable,
    StandTable,
    StepTable,
)
from sim_core.garment.pattern import Pattern
from sim_core.garment.pattern.tables import CutProblem, read_dye, read_spot
from sim_core.garment.placement import AlongPath, Flat, Folded, Knot, OverBar, Placement, Upright, Wrapped
from sim_core.validation.files import read_toml, shown
from sim_core.weave import Loom, Weave

__all__ = ["default_program", "load_motion", "load_outfit"]

BESIDE = 0.01  # [m] between lengths of cloth on one stand
LOOK = 0.02  # [m] cell of the field by which a figure is tried
READ_BY = {  # keys that few kinds of steps read
    "at": ("pin", "release"),
    "pose": ("pose",),
    "belt": ("close",),
    "seconds": ("sew", "close", "pose", "settle", "rest"),
}
WAYS: dict[str, type[Placement]] = {
    "flat": Flat,
    "over_bar": OverBar,
    "along_path": AlongPath,
    "wrapped": Wrapped,
    "folded": Folded,
    "upright": Upright,
}


def load_outfit(path: Path, content: Path | None = None) -> Outfit:
    """The outfit of a file. Paths in it are read from `content`, else from the folder that holds its `outfits`.

    Raises FileProblem naming file, key, value and remedy for whatever is wrong with it or with a file it names.
    """
    path = Path(path)
    values = read_toml(path, "an outfit file (TOML); it needs a wearer or a stand, and [[layer]] tables")
    try:
        read = OutfitTable.model_validate(values)
    except ValidationError as error:
        raise FileProblem(f"{path}: {_first(error)}") from error
    folder = content or (path.parent.parent if path.parent.name == "outfits" else path.parent)
    reader = _Reader(path, folder)
    return reader.outfit(read)


class _Reader:
    """Turns the tables of one file into values, naming file and key in every error."""

    def __init__(self, path: Path, folder: Path) -> None:
        self._path, self._folder = path, folder
        self._loom = Loom()

    def outfit(self, read: OutfitTable) -> Outfit:
        if (read.wearer is None) == (read.stand is None):
            raise self._wrong(
                "wearer", 'give either wearer = "mannequins/….npz" or a [stand] table, one of both'
            )
        wearer = None if read.wearer is None else self._wearer(self._file("wearer", read.wearer), read)
        stand = None if read.stand is None else self._stand(read.stand)
        for key in ("pose", "size", "cover", "motion"):
            if stand is not None and key in read.model_fields_set:
                raise self._wrong(key, "a stand has none – leave it out")
        pose = self.pose("pose", read.pose) if wearer is not None else T_POSE
        if read.study is not None:
            self._file("study", read.study)
            for k, table in enumerate(read.layer, 1):
                if table.edge is not None:
                    raise self._wrong(
                        f"layer.{k}.edge", "mesh steps are chosen by the study – leave out one of both"
                    )
        motion = load_motion(self._file("motion", read.motion)) if read.motion is not None else None
        layers = [self.layer(f"layer.{k}", table, stand) for k, table in enumerate(read.layer, 1)]
        if read.cover is not None and read.cover.petticoat is not None:
            layers = [_before_it_is_spread(layer) for layer in layers]
        self._check_belts(layers, wearer)
        if stand is not None:
            self._check_beside(layers)
        for k, layer in enumerate(layers):
            if any(layer.name == other.name for other in layers[:k]):
                raise self._wrong(
                    f"layer.{k + 1}.name", f"{layer.name!r} is there twice – name each layer once"
                )
        name = read.name or self._path.stem
        title = {str(language): words for language, words in read.title.items()}
        return Outfit(name, tuple(layers), wearer, stand, pose, motion, title, str(self._path))

    def _stand(self, table: StandTable) -> Stand:
        told = table.model_dump(exclude={"kind"}, exclude_none=True)
        return self._of("stand", lambda: TBar(**told) if table.kind == "t_bar" else Stand(**told))

    def _check_beside(self, layers: Sequence[Layer]) -> None:
        """Layers on one stand do not touch each other: folded lengths beside each other alone."""
        if len(layers) < 2:
            return
        held: list[tuple[float, float, str]] = []
        for number, layer in enumerate(layers, 1):
            if not isinstance(layer.place, Folded):
                raise self._wrong(
                    f"layer.{max(number, 2)}",
                    "a stand bears one layer, or several lengths folded beside each other – give a wearer",
                )
            half = 0.5 * float(np.ptp(layer.cloth.vertices[:, 0])) + 0.5 * BESIDE
            low, high = layer.place.at - half, layer.place.at + half
            for begin, end, name in held:
                if low < end and begin < high:
                    raise self._wrong(
                        f"layer.{number}.place.at",
                        f"{layer.place.at} m – lies within {1e3 * BESIDE:.0f} mm of {name!r}; move it along the bar",
                    )
            held.append((low, high, layer.name))

    def _check_belts(self, layers: Sequence[Layer], wearer: Mannequin | None) -> None:
        known = wearer.landmarks() if wearer is not None else {}
        for number, layer in enumerate(layers, 1):
            for k, step in enumerate(layer.program.steps, 1):
                if step.belt is not None and step.belt.mark not in known:
                    raise self._wrong(
                        f"layer.{number}.{step.named(k)}.belt.mark",
                        f"no landmark {shown(step.belt.mark)} – landmarks: {', '.join(known) or 'none on a stand'}",
                    )

    def _wearer(self, file: Path, read: OutfitTable) -> Mannequin:
        """A figure that cloth can lie on: closed, with hands."""
        wearer = bare = Mannequin.load(file).sized(read.size)
        if read.cover is not None:
            cover = _cover(read.cover)
            if cover == Cover():
                raise self._wrong("cover", "nothing of it is told – give bodice, trousers or petticoat")
            wearer = self._of("cover.petticoat", lambda: covered(bare, cover))
        try:
            Figure(wearer, cell=LOOK).field(T_POSE)
        except SimCoreError as error:
            raise FileProblem(f"{file}: {error}") from error
        return wearer

    def layer(self, key: str, table: LayerTable, stand: Stand | None) -> Layer:
        pattern = self._pattern(key, table)
        weave = Weave.load(self._file(f"{key}.weave", table.weave))
        weaves = {
            name: Weave.load(self._file(f"{key}.weaves.{name}", file)) for name, file in table.weaves.items()
        }
        for of, panels in (("weaves", weaves), ("origins", table.origins)):
            for name in panels:
                self._of(f"{key}.{of}", lambda name=name: pattern.panel(name))
        ways, where = _ways(stand)
        way = table.place.way if table.place else ways[0]
        if way not in ways:
            raise self._wrong(f"{key}.place.way", f"{way!r} – choose {' or '.join(ways)} on {where}")
        place = self.placement(key, table.place) if table.place else WAYS[way]()  # type: ignore[call-arg]
        if way == "flat" and not pattern.panels:
            raise self._wrong(
                f"{key}.pattern", f"{table.pattern} is one panel – flat dressing needs [[panel]] tables"
            )
        if way == "along_path" and not pattern.mirror:
            raise self._wrong(
                f"{key}.pattern", f"{table.pattern} is no half – along_path needs mirror = true"
            )
        program = default_program("hung" if way == "flat" and stand is not None else way)
        steps = self._steps(f"{key}.step", table.step, pattern) or program.steps
        then = self._steps(f"{key}.then", table.then, pattern)
        fold = program.fold if table.fold is None else table.fold
        program = replace(program, steps=(*steps, *then), fold=fold)
        if table.start is not None:
            program = self._begun(f"{key}.start", table.start, way, program)
        _check_order(self, key, program.steps, pattern)
        edge = pattern.edge if table.edge is None else table.edge
        name = table.name or pattern.name
        layer = self._of(
            f"{key}.name",
            lambda: Layer(name, pattern, weave, place, program, edge, weaves, table.seed, self._loom),
        )
        origins = {panel: _metres(at) for panel, at in table.origins.items()}
        return replace(
            layer,
            origin=_metres(table.origin),
            origins=origins,
            closing=table.closing,
            accessory=table.accessory,
        )

    def _begun(self, key: str, start: PoseTable, way: str, program: Program) -> Program:
        """The program from another pose on than is usual for its way of placing."""
        if way not in ("wrapped", "upright", "along_path"):
            raise self._wrong(key, f"{way} has its own begin – leave it out")
        if not any(step.do == "pose" for step in program.steps):
            raise self._wrong(key, 'no step leaves that pose – add a step with do = "pose", or leave it out')
        return replace(program, start=self.pose(key, start))

    def _pattern(self, key: str, table: LayerTable) -> Pattern:
        file = self._file(f"{key}.pattern", table.pattern)
        pattern = self._of(key, lambda: Pattern.load(file, table.measures))
        return self._of(f"{key}.dyes", lambda: pattern.coloured(table.dye, table.dyes))

    def placement(self, key: str, table: Place) -> Placement:
        values = table.model_dump(exclude={"way"})
        if table.way == "along_path":
            knots = tuple(Knot(tuple(k["near"]), k["by"], k["room"]) for k in values.pop("knot"))
            values["knots"] = knots
            values["stations"] = tuple(values["stations"])
            if values["along"] is None:
                del values["along"]
        return WAYS[table.way](**values)

    def pose(self, key: str, told: PoseTable | None) -> Pose:
        if told is None:
            return pose_named("display")
        where = f"{self._path}: {key}"
        try:
            return pose_named(told, where) if isinstance(told, str) else Pose.of(told, where)
        except SimCoreError as error:
            raise FileProblem(str(error)) from error

    def _steps(self, key: str, tables: Sequence[StepTable], pattern: Pattern) -> tuple[Step, ...]:
        return tuple(self.step(f"{key}.{k}", step, pattern) for k, step in enumerate(tables, 1))

    def step(self, key: str, table: StepTable, pattern: Pattern | None) -> Step:
        spots: list[Any] = []
        for k, spot in enumerate(table.at, 1):
            if isinstance(spot, str) or pattern is None:
                spots.append(spot)
                continue
            panels = {panel.name: panel for panel in pattern.panels}
            try:
                spots.append(
                    read_spot(f"{key}.at.{k}", spot, pattern.measures, panels, mirrored=pattern.mirror)
                )
            except CutProblem as error:
                raise FileProblem(f"{self._path}: {error}") from error
        for name, those in READ_BY.items():
            if name in table.model_fields_set and table.do not in those:
                raise self._wrong(
                    f"{key}.{name}", f"{table.do} does not read it, only {', '.join(those)} – leave it out"
                )
        if table.do == "pin" and not spots:
            raise self._wrong(f"{key}.at", 'say what is pinned: at = ["nape"], or places of panels')
        known = [tie.name for tie in pattern.ties] if pattern is not None else []
        for name in table.ties:
            if pattern is not None and name not in known:
                raise self._wrong(f"{key}.ties", f"{name!r} is no tie – ties: {', '.join(known) or 'none'}")
        if table.seconds == 0 and table.do not in ("weld", "pin", "release"):
            raise self._wrong(f"{key}.seconds", f"{table.do} takes time – give seconds above 0")
        return Step(
            do=table.do,
            seconds=table.seconds,
            gravity=table.gravity,
            damping=table.damping,
            friction=table.friction,
            speed=table.speed,
            still=table.still,
            spots=tuple(spots),
            ties=tuple(table.ties),
            pose=None if table.pose is None else self.pose(f"{key}.pose", table.pose),
            belt=None if table.belt is None else Belt(**table.belt.model_dump()),
            touch=Touch(**table.touch.model_dump()),
            label=table.label or table.do,
            key=".".join(key.split(".")[-2:]),
        )

    def _file(self, key: str, name: str) -> Path:
        path = self._folder / name
        if not path.is_file():
            raise self._wrong(key, f"no file {name} in {self._folder} – correct the path")
        return path

    def _wrong(self, key: str, text: str) -> FileProblem:
        return FileProblem(f"{self._path}: {key}: {text}")

    def _of(self, key: str, make: Any) -> Any:
        """What `make` makes; its errors told with file and key."""
        try:
            return make()
        except SimCoreError as error:
            raise FileProblem(f"{self._path}: {key}: {error}") from error


def _before_it_is_spread(layer: Layer) -> Layer:
    """The layer, dressed on a petticoat that is folded as long as the wearer has not begun to take its last pose."""
    begin = layer.program.start
    if begin is None or not any(step.do == "pose" for step in layer.program.steps):
        return layer
    return replace(layer, program=replace(layer.program, start=replace(begin, spread=0.0)))


def _cover(table: CoverTable) -> Cover:
    below = table.petticoat
    petticoat = None if below is None else Petticoat(read_dye(below.dye), below.girth, below.hem)
    return Cover(read_dye(table.bodice), read_dye(table.trousers), petticoat)


def _metres(place: tuple[float, float]) -> tuple[float, float]:
    return place[0] / 1000.0, place[1] / 1000.0


def _check_order(reader: _Reader, key: str, steps: Sequence[Step], pattern: Pattern) -> None:
    """Steps that cannot follow each other: refused before anything runs."""
    welded, belted, pinned = False, False, []
    sewn = any(seam.kind == "sewn" for seam in pattern.seams)
    for number, step in enumerate(steps, 1):
        told = f"{key}.{step.named(number)}"
        where = f"{told}.do"
        if step.do == "sew" and welded:
            raise reader._wrong(where, "sew after weld – seams that are welded are one cloth; sew before")
        if step.do == "weld":
            if welded:
                raise reader._wrong(where, "welded already – leave it out")
            welded = True
        if step.do in ("close", "pose") and sewn and not welded:
            raise reader._wrong(where, f"{step.do} before weld – seams are still open; weld first")
        if step.do == "release":
            if not pinned:
                raise reader._wrong(where, "nothing is pinned – leave it out")
            if any(spot not in pinned for spot in step.spots):
                raise reader._wrong(f"{told}.at", "it is not pinned – pin it before, or leave it out")
            pinned = [spot for spot in pinned if step.spots and spot not in step.spots]
        belted = belted or step.belt is not None
        if step.do == "pin":
            if "belt" in step.spots and not belted:
                raise reader._wrong(f"{told}.at", "no belt is drawn before – close with a belt first")
            pinned += step.spots
    if sewn and not welded:
        raise reader._wrong(f"{key}.step", "the pattern has sewn seams and no step welds them – add one")
    if not steps[-1].timed:
        raise reader._wrong(
            f"{key}.step.{len(steps)}.do",
            f"{steps[-1].do} comes last, and no time passes in which it could do anything – add settle or rest",
        )


@cache
def _programs() -> Mapping[str, ProgramTable]:
    folder = resources.files("sim_core.garment.outfit")
    values = read_toml(Path(str(folder / "programs.toml")), "the default programs (TOML)")
    return {way: ProgramTable.model_validate(table) for way, table in values.items()}


def _ways(stand: Stand | None) -> tuple[tuple[str, ...], str]:
    """Ways of placing cloth on a wearer or a stand, the usual one first, and what that is called."""
    if stand is None:
        return ("flat", "wrapped", "upright", "along_path"), "a wearer"
    return (("flat",), "a T-bar") if isinstance(stand, TBar) else (("over_bar", "folded"), "a stand")


def default_program(way: str) -> Program:
    """How a layer is dressed that does not say it, by its way of placing."""
    table = _programs()[way]
    reader = _Reader(Path("programs.toml"), Path())
    steps = tuple(reader.step(f"{way}.{k}", step, None) for k, step in enumerate(table.step, 1))
    contact = Contact(**table.contact.model_dump(), untangle=UNTANGLE)
    start = pose_named(table.start) if table.start else None
    return Program(steps, contact, start, table.sag, table.fold, table.limit, table.even)


def _first(error: ValidationError) -> str:
    """The first problem of a file in one line: key, what, value."""
    first = error.errors()[0]
    key = ".".join(str(part + 1) if isinstance(part, int) else str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        return f"{key[:80]}: unknown key – remove it or correct its name (see `simcore dress --help`)"
    text = first["msg"].removeprefix("Value error, ")
    value = f" (found {shown(first['input'])})" if key and first["type"] != "missing" else ""
    return f"{key}: {text}{value}" if key else text
