"""`simcore cloth`: runs a published scene, keeps every frame, and says what it cost."""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import is_zipfile

import numpy as np

from sim_core.cloth.scenes.summary import summary_of, tell, write
from sim_core.errors import SimCoreError, WrongArgument
from sim_core.validation import FURTHEST
from sim_core.validation.arguments import ending, number, whole

if TYPE_CHECKING:
    from sim_core.cloth.run.drape_run import Drape
    from sim_core.cloth.scenes.catalogue import Scene
    from sim_core.cloth.step.precision import Pace

WARM = 120  # vertices of the scene that code is compiled with: enough for lanes
BLOWN = 10.0  # times its length that an edge has in no cloth: a fixed step was too long
DESCRIPTION = """\
Simulates the scenes of the published work, and two more; --case picks a sequence (sim_core/cloth/scenes/scenes.toml).

  flag      1.5 x 1 m in the wind, its left side pinned      10 cases, 600 frames
  teapot    a cloth falls on the Utah teapot                 16 cases, 400 frames
  hanging   a level sheet let go, held by pins               18 cases, 1200 frames
  limb      a cloth on an arm that moves, frame by frame       3 cases, 100 frames
  drape     the disc of the Cusick test on its pedestal       3 cases, 100 frames

Garments, on a stand, on a still mannequin or on one whose arms move, are draped by `simcore dress`.
A frame is 1/25 s. --out FILE.npz holds positions (T, V, 3) float32 [m], faces, uv, pins, dt and the settings as
JSON. --error MM lets the shipped table choose mesh and steps (flag, teapot, hanging); by hand --vertices, --courant,
--substeps and --integrator set them. What the table was not measured with, it refuses: --layers, --gusts, --precision
single, and the settings it chooses itself.
--precision single halves the time at errors of about 0.05 mm; --courant trades steps for time error.
With --resume FILE an interrupted run goes on where it was, on the same machine to the same bits.
"""


def _three(text: str) -> tuple[float, float, float]:
    return _numbers(text, 3, "X,Y,Z [m/s], at most 100 each", 100.0)  # type: ignore[return-value]


def _two(text: str) -> tuple[float, float]:
    parts = text if "," in text else f"{text},{text}"
    return _numbers(parts, 2, "W,H [m]", 10.0)  # type: ignore[return-value]


def _numbers(text: str, count: int, what: str, most: float) -> tuple[float, ...]:
    try:
        values = tuple(float(word) for word in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count or not all(np.isfinite(v) and abs(v) <= most for v in values):
        raise argparse.ArgumentTypeError(f"{text[:40]!r} – give {what}")
    return values


def add_parser(subparsers: Any) -> None:
    """Adds `cloth` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "cloth",
        help="simulate the published cloth scenes",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    scenes = ("flag", "teapot", "hanging", "limb", "drape")
    add("scene", choices=scenes, metavar="SCENE", help=", ".join(scenes))
    add("--frames", type=whole(1, 100_000), metavar="N", help="frames of 1/25 s (default: the scene's own)")
    add("--case", type=whole(1, 100), default=1, metavar="N", help="which sequence of the scene (default: 1)")
    add("--pins", metavar="KIND", help="hanging: edge, corners, corner, middle, four or thirds")
    add("--size", type=_two, metavar="W,H", help="width and height in metres")
    add("--wind", type=_three, metavar="X,Y,Z", help="flag: wind in m/s; write --wind=-4,0,1 for a negative")
    add(
        "--layers",
        type=number(0, 20, " mm"),
        default=0.0,
        metavar="MM",
        help="self-contact: the distance layers keep, e.g. 3 (default: 0, none)",
    )
    add("--gusts", type=number(0, 2), default=0.0, metavar="SHARE", help="flag: rms of gusts, of the wind")
    add("--vertices", type=whole(12, 400_000), metavar="N", help="about so many vertices")
    way = parser.add_mutually_exclusive_group()
    way.add_argument(
        "--error", type=number(0.001, 1000, " mm"), metavar="MM", help="cheapest within this error"
    )
    way.add_argument("--substeps", type=whole(1, 100_000), metavar="N", help="fixed substeps a frame")
    add(
        "--precision",
        choices=("double", "single"),
        default="double",
        help="of the time loop (default: double)",
    )
    add(
        "--courant",
        type=number(0.01, 0.95),
        metavar="SHARE",
        help="of the stable step (default: the scene's)",
    )
    add("--integrator", choices=("auto", "explicit", "implicit"), help="default: auto")
    add("--certify", action="store_true", help="every frame: did anything pass through? (needs ipctk)")
    add("--seed", type=whole(0, 2**31 - 1), default=0, metavar="N", help="of the gusts (default: 0)")
    add("--resume", type=Path, metavar="FILE", help="keep the state here; go on from it if it is there")
    add("--out", type=ending(".npz"), metavar="FILE.npz", help="write the frames")
    add("--video", type=ending(".mp4"), metavar="FILE.mp4", help="film them")
    add("--json", action="store_true", help="print a machine-readable summary")


@dataclass
class _Heard:
    """What the frames of a run are watched for."""

    scene: Scene
    total: int
    told: bool
    film: list[np.ndarray] = field(default_factory=list)
    penetrations: int = 0
    shown: float = 0.0

    def frame(self, index: int, positions: np.ndarray) -> None:
        """Keeps a frame, counts what is inside the collider, and says how far the run is."""
        from sim_core.cloth.contact.moving_grid import MovingGrid

        self.film.append(positions)
        solid = self.scene.collider
        if isinstance(solid, MovingGrid):
            solid = solid.solid(index + 1)
        there = bool((np.abs(positions) <= FURTHEST).all())  # a cloth that blew up is told about at the end
        if solid is not None and self.scene.contact is not None and there:
            x, sheet = positions.astype(float), self.scene.sheet
            samples = np.concatenate([x, x[sheet.edges].mean(1), x[sheet.faces].mean(1)])
            deep = -0.1 * self.scene.contact.clearance
            self.penetrations += int((solid.distance(samples) < deep).sum())
        if self.told and time.perf_counter() - self.shown > 0.2:
            self.shown = time.perf_counter()
            sys.stderr.write(f"\r{self.scene.name}: frame {index + 1} of {self.total}\x1b[K")
            sys.stderr.flush()


def run(args: argparse.Namespace) -> int:
    """Runs the scene; returns the exit status."""
    from sim_core.cloth.scenes.catalogue import scene
    from sim_core.cloth.scenes.film import film_needs

    if args.video:
        film_needs()
    for path in (args.out, args.video, args.resume):
        if path is not None and not path.parent.is_dir():
            raise WrongArgument(f"{path}: there is no folder {path.parent} – make it first")
        if path is not None and path.is_dir():
            raise WrongArgument(f"{path}: this is a folder – name a file")
    if args.resume is not None and args.resume.exists() and not is_zipfile(args.resume):
        raise WrongArgument(f"{args.resume}: this is no state of a run – name another file, or remove it")
    settings = _chosen(args)
    if args.certify:
        from sim_core.cloth.run.certifier import need_ipctk

        need_ipctk()
    made = scene(
        args.scene,
        args.case,
        frames=args.frames,
        vertices=settings["vertices"],
        size=args.size,
        wind=args.wind,
        pins=args.pins,
    )
    if args.gusts:
        made = made.gusty(args.gusts, args.seed)
    if args.layers:
        made = made.layered(1e-3 * args.layers)
    total = round(made.phases[0].seconds * 25)
    heard = _Heard(made, total, told=not args.json and sys.stderr.isatty())
    settings |= {"precision": args.precision, "courant": args.courant or made.courant}
    compiled = _warmed(made, settings)
    begin = time.perf_counter()
    try:
        result = _simulated(made, settings, heard, args.resume)
    except KeyboardInterrupt:
        write(args, made, heard.film, settings)  # what is finished is not lost
        raise
    finally:
        if heard.told:
            sys.stderr.write("\r\x1b[K")
    seconds = time.perf_counter() - begin
    if settings["substeps"] and not result.worst_stretch < BLOWN:
        raise SimCoreError(
            f"--substeps {settings['substeps']}: too few, the cloth blew up – leave it out, and the step is found"
        )
    write(args, made, heard.film, settings)
    summary = summary_of(args, made, result, settings, heard.penetrations)
    summary |= {"seconds": round(seconds, 3), "compile_seconds": round(compiled, 3)}
    tell(args, summary)
    return 0


def _chosen(args: argparse.Namespace) -> dict[str, Any]:
    """Vertices, substeps and integrator, by hand or from the table."""
    settings = {
        "vertices": args.vertices,
        "substeps": args.substeps,
        "integrator": args.integrator or "auto",
        "certify": args.certify,
    }
    if args.error is not None:
        for name, free in _CHOSEN.items():
            if getattr(args, name) not in free:
                raise WrongArgument(
                    f"--{name}: --error chooses the setting, {_WHY[name]} – give one of the two"
                )
        from sim_core.cloth.scenes.fidelity import choose

        choice = choose(
            args.scene, error_mm=args.error, case=args.case, size=args.size, pins=args.pins, wind=args.wind
        )
        settings |= {"substeps": None, "integrator": choice.integrator, "why": choice.why}
        settings["vertices"] = choice.vertices
    return settings


_CHOSEN = {  # by --error; what may stand beside it
    "vertices": (None,),
    "integrator": (None, "auto"),
    "courant": (None,),
    "precision": ("double",),
    "gusts": (0.0,),
    "layers": (0.0,),
}
_WHY = {
    "vertices": "the mesh above all",
    "integrator": "and has measured the explicit one",
    "courant": "the share of the step with it",
    "precision": "whose errors are of double precision",
    "gusts": "whose errors are of a steady wind",
    "layers": "whose errors are of cloth without self-contact",
}


def _pace(settings: dict[str, Any]) -> Pace:
    from sim_core.cloth.step.precision import Pace

    return Pace(settings["precision"], settings["courant"])


def _simulated(made: Scene, settings: dict[str, Any], heard: _Heard, resume: Path | None) -> Drape:
    from sim_core.cloth import Checkpoint

    return made.drape(
        substeps=settings["substeps"],
        integrator=settings["integrator"],
        pace=_pace(settings),
        on_frame=heard.frame,
        checkpoint=resume and Checkpoint(resume, keep=True, only_own=True),
        certify=settings["certify"],
    )


def _warmed(made: Scene, settings: dict[str, Any]) -> float:
    """Seconds until the compiled code is there: one frame of a small scene with the same terms."""
    from sim_core.cloth.scenes.catalogue import scene

    begin = time.perf_counter()
    small = scene(made.name, frames=1, vertices=WARM)
    like = replace(small, collider=made.collider, contact=made.contact, air=made.air)
    like.drape(integrator=settings["integrator"], pace=_pace(settings))
    return time.perf_counter() - begin
