"""`hall build`: simulate what changed, keep what did not, go on where it stopped."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hall_app.build.beside import Job, bake, bake_beside, cores
from hall_app.content.bakes.store import SCAN, bake_fault, baked_here, data_bake, read_record
from hall_app.content.folder import Content, Exhibit
from hall_app.content.loading import load, read_table
from hall_app.content.lookup import content_folder, make_data_folder
from hall_app.content.schema.exhibit import ExhibitFile
from sim_core.validation.arguments import whole

if TYPE_CHECKING:
    from rich.progress import Progress as Bars

__all__ = ["add_parser", "run"]

TYPICAL = 600.0  # [s] a bake takes of which nothing is known yet
Progress = Callable[[float, str], None]

_EPILOG = """\
Each outfit (exhibit.toml: outfit = "outfits/….toml") is baked into baked/ beside the exhibit: the simulated garments,
both models, film and pictures. Each scan (exhibit.toml: scan = "….glb") becomes both models, whose deviation is
measured. The room is raised from plan.toml and its light computed, into room/. What is up to date is left alone; where
only [show] changed, the garment is not dressed again. Several are baked at once, one a core; where one cannot be
baked, the others are all the same. An interrupted build goes on where it stopped. Without PyAV films are left out.

examples:
  hall build                      everything that changed, in ./assets
  hall build --exhibit pibo -f    this one again, changed or not
  hall build --room               the room alone
  hall build --pattern            flat patterns, to be shown in texts: ![words](media/pattern.svg)
  hall build --media              music, pictures and the foreign model as well"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare `hall build`."""
    parser = subparsers.add_parser(
        "build",
        help="simulate garments and make the hall's media",
        description="Bake what changed in a content folder.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--content", type=Path, metavar="FOLDER", help="content folder (default ./assets)")
    parser.add_argument("--data", type=Path, default=Path("hall-data"), metavar="FOLDER", help="work folder")
    parser.add_argument("--exhibit", metavar="ID", help="this exhibit alone")
    parser.add_argument("--room", action="store_true", help="the room alone")
    parser.add_argument(
        "--pattern", action="store_true", help="the flat pattern as SVG (media/pattern.svg), and nothing else"
    )
    parser.add_argument("-f", "--force", action="store_true", help="bake again what is up to date")
    parser.add_argument("--no-film", action="store_true", help="leave the film of the drape out")
    parser.add_argument(
        "--media", action="store_true", help="make music, pictures and the foreign model again"
    )
    parser.add_argument(
        "--into-data",
        action="store_true",
        help="write to --data instead of the content folder (as hall serve does)",
    )
    parser.add_argument(
        "--workers",
        type=whole(1, 64),
        default=cores(),
        metavar="N",
        help="exhibits baked at once, each by a process of some 700 MB (default: the cores, at most 4)",
    )
    parser.add_argument("--json", action="store_true", help="progress and summary as JSON lines")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Bake; 1 when an exhibit that was asked for cannot be baked."""
    folder = content_folder(arguments.content)
    if arguments.media:
        from hall_app.media import make_media

        with _progress(arguments.json, "media") as progress:
            make_media(folder, progress)
    content = load(folder)
    if arguments.pattern:
        _draw_patterns(content, arguments)
        return 0
    jobs = [] if arguments.room else _jobs(content, arguments)
    failed = 0
    if len(jobs) == 1:
        with _progress(arguments.json, jobs[0].exhibit) as progress:
            record = bake(jobs[0], content, progress)
        _tell_baked(arguments.json, jobs[0].exhibit, record)
    elif jobs:
        failed = _beside(jobs, arguments)
    if arguments.exhibit is None:
        _build_room(content, arguments)
    return 1 if failed else 0


def _jobs(content: Content, arguments: argparse.Namespace) -> list[Job]:
    """What is to be baked; of the others it is told that they are up to date."""
    from hall_app.content.bakes.key import bake_key

    jobs = []
    for exhibit in _chosen(content, arguments.exhibit):
        key = bake_key(content, exhibit)
        target = data_bake(arguments.data, exhibit.id, key) if arguments.into_data else baked_here(exhibit)
        record = read_record(target)
        whole = record is not None and record.get("key") == key and bake_fault(target) is None
        if whole and not arguments.force:
            _tell(arguments.json, {"exhibit": exhibit.id, "state": "up to date"}, f"{exhibit.id}: up to date")
            continue
        seconds = float((record or {}).get("seconds", {}).get("all", TYPICAL))
        jobs.append(
            Job(
                content.folder,
                exhibit.id,
                key,
                target,
                arguments.data,
                seconds,
                film=not arguments.no_film,
                force=arguments.force,
            )
        )
    return jobs


def _beside(jobs: list[Job], arguments: argparse.Namespace) -> int:
    """Bakes several at once; of one that cannot be baked it is told why, and the others go on. How many could not."""
    failed = 0
    with _progress_of_all(arguments.json, jobs) as heard:
        for exhibit, found in bake_beside(jobs, arguments.workers, heard):
            if isinstance(found, str):
                failed += 1
                print(f"hall build: {exhibit}: {found}", file=sys.stderr, flush=True)
            else:
                _tell_baked(arguments.json, exhibit, found)
    return failed


def _tell_baked(as_json: bool, exhibit: str, record: dict) -> None:
    lines = [f"{exhibit}: baked in {record['seconds']['all']:.0f} s", *_scan_lines(exhibit, record)]
    _tell(as_json, {"exhibit": exhibit, "state": "baked", **record}, "\n".join(lines))


def _scan_lines(exhibit: str, record: dict) -> list[str]:
    """What was measured of a scan's models, and what was remarked of the scan itself."""
    if SCAN not in record:
        return []
    lines = [f"{exhibit}: {remark}" for remark in record[SCAN]["remarks"]]
    for name in ("close", "hall"):
        told = record[SCAN][name]
        apart = ", ".join(f"{key[:-2]} {1000 * value:.2f} mm" for key, value in told["deviation"].items())
        lines.append(
            f"{exhibit}: {name}.glb {told['triangles']} triangles, deviation {apart}, {told['bytes'] / 1e6:.2f} MB"
        )
    return lines


def _draw_patterns(content: Content, arguments: argparse.Namespace) -> None:
    """The flat patterns of one exhibit or of all, as SVG beside the texts that show them."""
    from hall_app.media.make import write_pattern_sheet

    for exhibit in _chosen(content, arguments.exhibit):
        if exhibit.file.outfit is None:
            continue  # a scan was cut from no pattern that is known
        path = write_pattern_sheet(content.folder, exhibit.id, exhibit.file.outfit)
        name = path.relative_to(content.folder).as_posix()
        _tell(arguments.json, {"exhibit": exhibit.id, "pattern": name}, f"{exhibit.id}: {name}")


def _build_room(content: Content, arguments: argparse.Namespace) -> None:
    """The room, if the plan or what is written in it changed."""
    from hall_app.room.bake.key import room_key
    from hall_app.room.bake.store import data_room, room_here, room_record, room_work

    key = room_key(content, arguments.data)
    target = data_room(arguments.data, key) if arguments.into_data else room_here(content.folder)
    record = room_record(target)
    if record is not None and record.get("key") == key and not arguments.force:
        _tell(arguments.json, {"room": key, "state": "up to date"}, "room: up to date")
        return
    from hall_app.room.bake.build import bake_room

    make_data_folder(arguments.data)
    work = room_work(arguments.data, key)
    with _progress(arguments.json, "room") as progress:
        record = bake_room(content, key=key, target=target, work=work, data=arguments.data, progress=progress)
    size = f"{record['triangles']} triangles, {record['bytes'] / 1e6:.2f} MB"
    _tell(
        arguments.json,
        {"room": key, "state": "baked", **record},
        f"room: baked in {record['seconds']:.0f} s ({size})",
    )


def _chosen(content: Content, wanted: str | None) -> list[Exhibit]:
    if wanted is None:
        for problem in content.problems:
            print(f"left out: {problem}", file=sys.stderr)
        return [exhibit for exhibit in content.exhibits if exhibit.file.baked_key is not None]
    exhibit = content.exhibit(wanted)
    if exhibit is None:
        named = [str(problem) for problem in content.problems if _concerns(content, problem.file, wanted)]
        raise ValueError(named[0] if named else f"no exhibit {wanted!r} in {content.folder}")
    if exhibit.file.baked_key is None:
        raise ValueError(f"{exhibit.toml}: names no outfit and no scan, nothing to bake")
    return [exhibit]


def _concerns(content: Content, file: str, wanted: str) -> bool:
    """Whether a faulty file belongs to an exhibit: it lies in its folder, or is the outfit it names."""
    if file.startswith(f"exhibits/{wanted}/"):
        return True
    table, _ = read_table(content.folder, f"exhibits/{wanted}/exhibit.toml", ExhibitFile)
    return table is not None and table.outfit == file


@contextmanager
def _progress(as_json: bool, what: str) -> Iterator[Progress]:
    if as_json:
        yield lambda fraction, label: print(
            json.dumps({"fraction": round(fraction, 4), "label": label}), flush=True
        )
        return
    with _bars() as bars:
        task = bars.add_task("…", total=1.0, what=what)
        yield lambda fraction, label: bars.update(task, completed=fraction, description=label)


@contextmanager
def _progress_of_all(as_json: bool, jobs: list[Job]) -> Iterator[Callable[[str, float, str], None]]:
    """A bar for each exhibit under way, and one for all of them, by the time that each may take."""
    if as_json:
        yield lambda exhibit, fraction, label: print(
            json.dumps({"exhibit": exhibit, "fraction": round(fraction, 4), "label": label}), flush=True
        )
        return
    weights = {job.exhibit: max(job.seconds, 1.0) for job in jobs}
    done = dict.fromkeys(weights, 0.0)
    with _bars() as bars:
        every = bars.add_task(f"0 of {len(jobs)}", total=sum(weights.values()), what="all")
        tasks: dict[str, Any] = {}

        def heard(exhibit: str, fraction: float, label: str) -> None:
            if exhibit not in tasks:
                tasks[exhibit] = bars.add_task("…", total=1.0, what=exhibit)
            done[exhibit] = fraction
            bars.update(tasks[exhibit], completed=fraction, description=label)
            ready = sum(share >= 1.0 for share in done.values())
            gone = sum(weights[name] * share for name, share in done.items())
            bars.update(every, completed=gone, description=f"{ready} of {len(jobs)}")

        yield heard


def _bars() -> Bars:
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bars

    return Bars(
        TextColumn("{task.fields[what]}"),
        BarColumn(),
        TextColumn("{task.description}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )


def _tell(as_json: bool, summary: dict, sentence: str) -> None:
    print(json.dumps(summary, ensure_ascii=False) if as_json else sentence, flush=True)
