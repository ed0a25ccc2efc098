"""The `simcore` command: builds the parser, finds the room of a command and reports its errors in one line."""

import argparse
import io
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

from sim_core.errors import SimCoreError, WrongArgument

__all__ = ["main"]

ROOMS = ("weave", "mesh", "cloth", "dress", "figure", "motion", "track", "learn")
ELSEWHERE = {
    "dress": "sim_core.garment.cli",
    "figure": "sim_core.body.cli",
    "motion": "sim_core.body.motion.cli",
}  # commands that share another room
BENCHES = ("weave", "drafts", "mesh", "cloth", "field", "figure", "track")

DESCRIPTION = """\
The simulation core, one stage at a time: files in, files out.

  weave    a weave file (TOML) becomes tileable texture maps and cloth parameters
  mesh     a panel outline (JSON) becomes a triangle mesh
  cloth    a mesh falls onto a collider under gravity
  dress    an outfit (TOML) becomes dressed garments, their model and picture
  figure   who wears a garment: poses drawn, and new figures from free body data
  motion   how figures move: motion files (TOML) drawn, measured, written as joints in time
  track    a motion (BVH, arrays, a sensor's stream) becomes points that follow the person
  learn    fine cloth from coarse: data to learn from
  bench    time and error of the engines, side by side with a reference

Units are SI throughout: metres, kilograms, seconds, newtons. Exit status: 0 done, 1 the work failed
(one line on stderr says what, where and the remedy), 2 wrong arguments.
"""

DEBUG = "show the traceback of an error"

BENCH_DESCRIPTION = """\
Run the benchmark programs of tests/bench, each of which measures time AND error in one run and writes
JSON. They live in a checkout of the repository; elsewhere this command exits with 2.
Arguments behind `--` go to the programs, e.g. `simcore bench mesh -- --quick`.
"""


def _room_command(room: str):
    """Import `sim_core.<room>.cli`, or None where that room is not installed."""
    if room in ELSEWHERE:
        return import_module(ELSEWHERE[room])
    try:
        return import_module(f"sim_core.{room}.cli")
    except ModuleNotFoundError as error:
        if error.name in (f"sim_core.{room}", f"sim_core.{room}.cli"):
            return None
        raise


def _pattern_code(path: Path):
    """What a pattern file cuts, for `simcore mesh`: that room lies below the garments' and cannot ask there itself."""
    return import_module("sim_core.garment.pattern.garmentcode").read_pattern_code(path)


def _wanted_rooms(arguments: list[str]) -> tuple[str, ...]:
    """Only the room that is called is imported; the general help needs all of them."""
    named = tuple(word for word in arguments if not word.startswith("-"))[:1]
    if named and named[0] in ROOMS:
        return named
    return () if named == ("bench",) else ROOMS


def _parser(arguments: list[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="simcore", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--debug", action="store_true", help=DEBUG)
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for room in _wanted_rooms(arguments):
        module = _room_command(room)
        if module is not None:
            module.add_parser(subparsers)
            subparsers.choices[room].set_defaults(run=module.run)
        if room == "mesh":
            subparsers.choices[room].set_defaults(pattern_code=_pattern_code)
    bench = subparsers.add_parser(
        "bench",
        help="time and error of the engines",
        description=BENCH_DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    bench.add_argument("engine", nargs="?", choices=BENCHES, help="one engine; all of them when left out")
    bench.add_argument("rest", nargs=argparse.REMAINDER, metavar="-- ARGUMENTS", help="for the program")
    bench.set_defaults(run=_bench)
    for command in subparsers.choices.values():
        # SUPPRESS: a `--debug` before the command is not undone by its absence behind it.
        command.add_argument("--debug", action="store_true", default=argparse.SUPPRESS, help=DEBUG)
    return parser


def _bench(args: argparse.Namespace) -> int:
    folder = Path(__file__).resolve().parent.parent / "tests" / "bench"
    if not folder.is_dir():
        print(
            f"simcore bench: {folder}: no such folder – benches run in a checkout of the repository, "
            "not from an installed package",
            file=sys.stderr,
        )
        return 2
    rest = [word for word in args.rest if word not in ("--", "--debug")]
    engines = [args.engine] if args.engine else [name for name in BENCHES if _program(folder, name).is_file()]
    for engine in engines:
        done = subprocess.run([sys.executable, str(_program(folder, engine)), *rest], check=False)
        if done.returncode:
            return 1
    return 0


def _program(folder: Path, engine: str) -> Path:
    return folder / f"bench_{engine}.py"


def main(arguments: list[str] | None = None) -> int:
    """Run one `simcore` command and return its exit status."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    args = _parser(words).parse_args(words)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # names a terminal's encoding may lack
    try:
        status = args.run(args)
        sys.stdout.flush()
        return status
    except BrokenPipeError:  # whoever read the output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        return _told(args.command, "interrupted", 1)
    except Exception as error:
        if args.debug:
            raise
        if isinstance(error, (SimCoreError, OSError)):
            return _told(args.command, str(error), 2 if isinstance(error, WrongArgument) else 1)
        # A fault of ours: still one line, and the way to see more.
        kind = type(error).__name__
        return _told(args.command, f"unexpected {kind}: {error} – add --debug and report what it shows", 1)


def _told(command: str, message: str, status: int) -> int:
    sys.stderr.write(f"simcore {command}: {' '.join(message.split())}\n")
    return status


if __name__ == "__main__":
    sys.exit(main())
