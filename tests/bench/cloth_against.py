"""Speed against error beside Newton, MuJoCo and Blender: `simcore bench cloth -- --peers`.

    … --peers [FOLDER] [--scene NAME] [--only ENGINE] [--rounds N] [--budget SECONDS] [--vertices N]
      [--deciding] [--json FILE] [--plot FILE.png]

Scenes: hang_edge, hanging and flag as published; each with `_silk` once more, so stiff that no edge grows by more than
3 %; folded, a sheet folded over a bar onto itself, with layers (cloth_folded.py).

Every setting of a peer is run in turn with ours: a turn is one run of each of our settings (the default and cheaper
ones, OURS) and one of the peer's, settings and peers alternate, and a ratio is the median over turns. Two are told:
over our default, and over our cheapest setting that stays within 2 mm mean of our own limit. With --deciding only each
peer's cheapest setting within 2 mm of its limit and the next ones of its sweep are run, the first so often. One thread,
one core, processor milliseconds a frame of 1/25 s; building the model and compiling are left out and told. Errors are
vertex distances at the end (folded: in the worst frame): from the peer's own limit (its finest setting; `floor` is
what the next finer one still differs from it) and from ours. Of layers all crossings are counted, by one function. A
run that takes longer than cloth_sweeps.LONGEST is broken off and told. What has been run is kept in FOLDER, so a long
sweep goes in pieces: with --budget no run is begun after so many seconds, and the next call goes on.
Peers are put into FOLDER (build/peers) by the lines of peers.txt; a peer that cannot run is named with its reason.
"""

import argparse
import json
import os
import sys
import time
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from cloth_figures import deciding, summary
from cloth_sweeps import ENGINES, NAMES, Compared, Own, compared, given, told
from peers import FOLDER, Peers, add_peers, peer_python
from signature import parts, signed

PROGRAM = Path(__file__).with_name("cloth_peers") / "program.py"
DEAR = 1000.0  # [ms a frame] what costs more has one turn, as a limit has
MAPPING_VERSION = 2  # raise when a peer is given other numbers: what was kept is then run again
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


def ours(asked: Compared, substeps: int | None = None, own: Own | None = None) -> dict:
    """One run of our engine: processor and wall milliseconds of every frame, and the end (V, 3) or film (T, V, 3) [m].

    substeps: so many a frame for a limit; own: the setting (None: the default).
    """
    scene, film = asked.scene, []
    if own and scene.contact:
        scene = replace(scene, contact=replace(scene.contact, every=own.every))
    clock = [time.process_time()]

    def hears(_: int, positions: np.ndarray) -> None:
        clock.append(time.process_time())
        film.append(positions)

    end = scene.drape(substeps=substeps, pace=own and own.pace, on_frame=hears)
    return {
        "ms": [1e3 * s for s in end.frame_seconds],
        "cpu_ms": list(1e3 * np.diff(clock)),
        "substeps": end.substeps / end.frames,
        "stretch": end.worst_stretch,
        "positions": np.array(film, float) if asked.whole else end.positions,
    }


class Kept:
    """Runs of one scene in a folder: a JSON file of turns and the end of each setting as npz."""

    def __init__(self, folder: Path, asked: Compared) -> None:
        arrays = given(asked)
        digest = sha256(b"".join(np.ascontiguousarray(arrays[k]).tobytes() for k in sorted(arrays)))
        self.sweeps = asked.sweeps
        self.faces = asked.scene.sheet.faces
        self.folder = folder / f"{asked.scene.name}-{digest.hexdigest()[:12]}-{MAPPING_VERSION}"
        self.folder.mkdir(parents=True, exist_ok=True)
        self.file = self.folder / "turns.json"
        self.turns: dict[str, list[dict]] = (
            json.loads(self.file.read_text("utf-8")) if self.file.is_file() else {}
        )

    @staticmethod
    def key(engine: str, setting: dict) -> str:
        return f"{engine} {json.dumps(setting, sort_keys=True)}"

    def _end(self, key: str) -> Path:
        return self.folder / f"{sha256(key.encode()).hexdigest()[:16]}.npy"

    def add(self, key: str, turn: dict, end: np.ndarray | None) -> None:
        self.turns.setdefault(key, []).append(turn)
        if end is not None:
            np.save(self._end(key), end)
        written = self.file.with_suffix(".part")
        written.write_text(json.dumps(self.turns), "utf-8")
        written.replace(self.file)

    def end(self, key: str) -> np.ndarray | None:
        path = self._end(key)
        return np.load(path) if path.is_file() else None


def run_turns(
    asked: Compared,
    engines: list[str],
    kept: Kept,
    rounds: int,
    until: float,
    peers: Peers,
    only: dict | None = None,
) -> bool:
    """Turns until every setting has its rounds (a limit or dear one: one); False where the time was up before that.

    only: per engine the settings that are run, the first of them in all rounds however dear (None: all of the sweep).
    """
    arrays, complete, sweeps = given(asked), True, asked.sweeps
    longest = max(len(sweeps[engine]) for engine in engines)
    for turn in range(rounds):
        for k in range(longest):
            for engine in engines:
                if k >= len(sweeps[engine]):
                    continue
                setting = sweeps[engine][k]
                key, limit = kept.key(engine, setting), k >= len(sweeps[engine]) - 2
                every = kept.turns.get(key, [])
                done = [t for t in every if "ours" in t or "error" in t]
                once = limit or any("error" in t or np.median(t["cpu_ms"]) > DEAR for t in every)
                chosen = None if only is None else only.get(engine, [])
                if chosen is not None and setting not in chosen:
                    continue
                if chosen and setting == chosen[0]:
                    once = False
                if len(done) > turn or (once and (done or (limit and every))):
                    continue
                if time.monotonic() > until:
                    complete = False
                    continue
                own = {name: ours(asked, own=way) for name, way in asked.ours.items()}
                found = peers.run(engine, setting, **arrays)
                end = found.pop("positions", None)
                kept.add(key, {**found, "ours": {name: run["cpu_ms"] for name, run in own.items()}}, end)
                said = found.get("error") or f"{np.median(found['cpu_ms']):.0f} ms a frame"
                print(f"  {engine} {told(setting)}: {said}", flush=True)
    return complete


def told_finite(value: Any) -> Any:
    """The same with None for numbers that are not finite, which JSON has no word for."""
    if isinstance(value, dict):
        return {key: told_finite(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [told_finite(inner) for inner in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def added(path: Path, results: dict) -> dict:
    """Writes the results of some scenes into a file of figures, whose other scenes stay; returns them all."""
    old = json.loads(path.read_text("utf-8")) if path.is_file() else {}
    whole = signed({**old, **results}, results)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(whole, indent=1) + "\n", "utf-8")
    return parts(whole)


def one_core() -> None:
    """This process and those it starts, on the last of the processors it may use."""
    os.environ.update(ONE_THREAD)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add_peers(parser, "where the peers are", FOLDER)
    parser.add_argument("--scene", choices=NAMES, action="append", help="default: all")
    parser.add_argument("--only", choices=ENGINES, action="append", help="one peer (may be repeated)")
    parser.add_argument("--rounds", type=int, default=3, help="turns of a setting")
    parser.add_argument("--deciding", action="store_true", help="only the settings that decide")
    parser.add_argument("--budget", type=float, default=float("inf"), metavar="SECONDS")
    parser.add_argument("--vertices", type=int, help="another mesh size")
    parser.add_argument("--json", type=Path, help="write the figures as JSON")
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw error against time")
    return parser.parse_args()


def main() -> int:
    args = arguments()
    python = peer_python(args.peers, "cloth")
    one_core()
    peers = Peers(python, PROGRAM, WARP_CACHE_PATH=str(args.peers / "warp"))
    until, results = time.monotonic() + args.budget, {}
    for name in args.scene or NAMES:
        asked = compared(name, args.vertices)
        engines = [e for e in args.only or asked.engines if e in asked.engines]
        if not engines:
            continue
        kept = Kept(args.peers / "cloth-runs", asked)
        for setting in asked.ours.values():  # compile
            ours(asked, own=setting)
        only = deciding(kept, engines) if args.deciding else None
        complete = run_turns(asked, engines, kept, args.rounds, until, peers, only) and only is None
        mine = {label: ours(asked, own=setting) for label, setting in asked.ours.items()}
        runs = [ours(asked, substeps) for substeps in asked.steps]
        results[name] = summary(kept, asked.engines, mine, runs)
        results[name] |= {
            "vertices": len(asked.scene.positions),
            "seconds": asked.seconds,
            "whole": asked.whole,
            "stretch": mine["default"]["stretch"],
            "complete": complete,
        }
    peers.close()
    if args.json:
        results = added(args.json, told_finite(results))
    if args.plot:
        from cloth_plot import plot

        plot(results, args.plot)
    return 0


if __name__ == "__main__":
    sys.exit(main())
