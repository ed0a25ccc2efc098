"""Drafts of other programs: how many are answered, and time and memory of what a large one tells.

python tests/bench/bench_drafts.py [--folder FOLDER] [--quick] [--json FILE] [--peers [FOLDER]]
python tests/bench/bench_drafts.py --rest [--folder FOLDER] [--json FILE]     how soon their yarns are at rest

Every different .wif and .dtx in a folder is given to `simcore weave --json`; with --peers to dtx_to_wif and pyweaving
as well, in an environment of their own. The 72 of the README lie in the source distributions of dtx_to_wif 4.7.1 and
base_loom_server 1.2.5 (`pip download --no-deps --no-binary :all: dtx_to_wif==4.7.1`, unpacked into one folder).
Then drafts of up to 20,000 ends and picks are made, and each is answered by a process of its own: CPU seconds of
reading, CPU seconds of all that is told beside it, peak memory. What they tell is compared with a count on the cloth
woven out, where that fits into memory.

With --rest alone the traditional drafts of weavers_drafts.py and those of the folder, of up to 100 x 100 crossings, are
brought to rest by `simcore weave FILE --relax --json`, one after the other: seconds of stage B on one core, and what
the command says of a cloth that does not rest.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from peers import add_peers, peer_python
from signature import signed
from weavers_drafts import DRAFTS

HERE = Path(__file__).parent
FOLDER = HERE.parent / "sim_core" / "drafts"
RNG = np.random.default_rng(0)


def answered(folder: Path) -> dict[str, str]:
    """What the command says of each file: "" where it is answered, else its one line."""
    told, seen = {}, set()
    for path in sorted(p for p in folder.rglob("*") if p.suffix.lower() in (".wif", ".dtx")):
        data = path.read_bytes()
        if data in seen:
            continue
        seen.add(data)
        words = [sys.executable, "-m", "sim_core.cli", "weave", str(path), "--json"]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        told[str(path)] = "" if done.returncode == 0 else done.stderr.strip().replace(f"{folder}/", "")
    return told


def head(ends: int, picks: int, shafts: int) -> str:
    return (
        f"[WIF]\nVersion=1.1\n[WEAVING]\nShafts={shafts}\nRising Shed=true\n[WARP]\nThreads={ends}\nColor=1\n"
        f"[WEFT]\nThreads={picks}\nColor=2\n[COLOR TABLE]\n1=200,30,30\n2=250,240,220\n"
    )


def section(name: str, rows) -> str:
    return f"[{name}]\n" + "".join(f"{k}={','.join(map(str, row)) or 0}\n" for k, row in enumerate(rows, 1))


def walk(count: int, most: int) -> list[list[int]]:
    """A threading that wanders over the shafts, as twills and their reverses do; it never repeats."""
    return [[int(n) + 1] for n in np.cumsum(RNG.choice([1, 1, 1, -1], count)) % most]


def treadled(count: int, shafts: int) -> str:
    tied = [sorted((np.arange(shafts // 2) + k) % shafts + 1) for k in range(shafts)]
    rest = section("TIEUP", tied) + section("TREADLING", walk(count, shafts))
    return head(count, count, shafts) + section("THREADING", walk(count, shafts)) + rest


def planned(count: int, shafts: int) -> str:
    """A lift plan without a repeat; with as many shafts as ends it is a jacquard."""
    threading = walk(count, shafts) if shafts < count else [[k + 1] for k in range(count)]
    plan = RNG.random((count, shafts)) < 0.5
    rows = [np.flatnonzero(row) + 1 for row in plan]
    return head(count, count, shafts) + section("THREADING", threading) + section("LIFTPLAN", rows)


LARGE = {
    "treadled, 4,000 x 4,000": lambda: treadled(4_000, 24),
    "jacquard, 4,000 x 4,000": lambda: planned(4_000, 4_000),
    "treadled, 20,000 x 20,000": lambda: treadled(20_000, 40),
    "lift plan of 32 shafts, 20,000 x 20,000": lambda: planned(20_000, 32),
}

PROGRAM = """
import json, re, sys, time
from pathlib import Path
from sim_core.weave.summary import facts_of
from sim_core.weave.files.sources import source_of_wif
from sim_core.weave.files.wif.reader import read_wif
path = Path(sys.argv[1])
begin = time.process_time()
wif = read_wif(path)
read = time.process_time()
facts = facts_of(source_of_wif(wif, path))
done = time.process_time()
memory = 1024 * int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1])
print(json.dumps({"read": read - begin, "facts": done - read, "memory": memory, "floats": facts["floats"]}))
"""


def longest_woven(path: Path) -> tuple[int, int]:
    """The longest float of warp and weft, counted pick by pick on the cloth itself."""
    from sim_core.weave.files.wif import read_wif

    lift = read_wif(path).factors.lift()
    found = []
    for yarns in (lift.T, lift):
        most = 0
        for yarn in yarns:
            change = np.flatnonzero(yarn != np.roll(yarn, 1))
            lengths = np.diff(np.append(change, change[0] + len(yarn))) if change.size else [len(yarn)]
            most = max(most, int(np.max(lengths)))
        found.append(most)
    return found[0], found[1]


def large(quick: bool) -> dict[str, dict]:
    made = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in LARGE.items():
            if quick and "20,000" in name:
                continue
            path = Path(folder) / "large.wif"
            path.write_text(text(), "ascii")
            done = subprocess.run(
                [sys.executable, "-c", PROGRAM, str(path)], capture_output=True, text=True, check=True
            )
            made[name] = json.loads(done.stdout)
            if "4,000" in name:
                floats = made[name]["floats"]
                made[name]["same"] = longest_woven(path) == (
                    floats["warp"]["longest"],
                    floats["weft"]["longest"],
                )
    return made


ONE_CORE = os.environ | {
    name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
}
MOST = 10_000  # crossings of a repeat that is brought to rest here
ASKED = 60.0  # [s]


def ordinary(folder: Path) -> dict[str, bytes]:
    """WIF and .dtx by name, each different content once: the traditional drafts, then those of the folder."""
    found = {f"{name}.wif": make().encode() for name, make in DRAFTS.items()}
    seen = set(found.values())
    for path in sorted(p for p in folder.rglob("*") if p.suffix.lower() in (".wif", ".dtx")):
        if (data := path.read_bytes()) not in seen:
            seen.add(data)
            found[str(path.relative_to(folder))] = data
    return found


def rests(folder: Path) -> dict[str, dict]:
    """Of each draft small enough that can be read: crossings of its repeat, seconds, residual, and why not at rest."""
    found: dict[str, dict] = {}
    with tempfile.TemporaryDirectory() as place:
        for name, data in ordinary(folder).items():
            path = Path(place) / f"draft{Path(name).suffix.lower()}"
            path.write_bytes(data)
            words = [sys.executable, "-m", "sim_core.cli", "weave", str(path), "--json"]
            told = subprocess.run(words, capture_output=True, text=True, check=False)
            if told.returncode:
                continue  # cannot be read: counted by the other table
            repeat = json.loads(told.stdout)["repeat"]
            crossings = repeat["ends"] * repeat["picks"]
            if crossings > MOST:
                continue
            done = subprocess.run(
                [*words, "--relax"], capture_output=True, text=True, check=False, env=ONE_CORE
            )
            facts = json.loads(done.stdout)
            found[name] = {"crossings": crossings} | {
                key: facts[key] for key in ("seconds", "residual", "note") if key in facts
            }
            print(rest_line(name, found[name]), flush=True)
    return found


def rest_line(name: str, row: dict) -> str:
    seconds = f"{row['seconds']:7.1f} s" if "seconds" in row else f"{'-':>9}"
    return f"{name:<52} {row['crossings']:>6,} {seconds}  {row.get('note', '')}"


def told_rests(found: dict[str, dict]) -> str:
    """One line: how many rest within the time asked, and how many are said not to be able to."""
    soon = [row for row in found.values() if "note" not in row and row["seconds"] <= ASKED]
    slow = [name for name, row in found.items() if "note" not in row and row["seconds"] > ASKED]
    said = sum("note" in row for row in found.values())
    slowest = max((row["seconds"] for row in soon), default=0.0)
    return (
        f"{len(found)} drafts: {len(soon)} at rest within {ASKED:.0f} s of one core (the slowest of them "
        f"{slowest:.0f} s), {said} said not to rest, and why; later: {', '.join(slow) or 'none'}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--folder", type=Path, default=FOLDER, help="drafts to be answered")
    parser.add_argument("--quick", action="store_true", help="nothing above 4,000 x 4,000")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument(
        "--rest", action="store_true", help="how soon yarns of ordinary drafts are at rest, and no more"
    )
    add_peers(parser, "beside dtx_to_wif and pyweaving")
    args = parser.parse_args()
    if args.rest:
        resting = rests(args.folder)
        print(told_rests(resting))
        if args.json:
            before = json.loads(args.json.read_text("utf-8")) if args.json.exists() else {}
            args.json.write_text(json.dumps(before | {"rests": signed(resting)}, indent=2) + "\n", "utf-8")
        return
    told = answered(args.folder)
    found: dict = {"files": len(told), "answered": sum(not text for text in told.values()), "refused": {}}
    found["refused"] = {Path(path).name: text for path, text in told.items() if text}
    print(f"simcore weave answers {found['answered']} of {found['files']} drafts")
    for name, text in found["refused"].items():
        print(f"  not {name}: {text}")
    if args.peers:
        python = peer_python(args.peers, "drafts")
        words = [str(python), str(HERE / "peer_drafts.py"), *told]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        found["peers"] = {
            name: sum(isinstance(value, float) for value in files.values())
            for name, files in json.loads(done.stdout.splitlines()[-1]).items()
        }
        for name, count in found["peers"].items():
            print(f"{name} reads {count}")
    found["large"] = large(args.quick)
    for name, row in found["large"].items():
        same = {True: ", floats as of the cloth woven out", False: ", FLOATS DIFFER"}.get(row.get("same"), "")
        print(
            f"{name}: read {row['read']:.2f} s, told {row['facts']:.2f} s, {row['memory'] / 1e6:.0f} MB{same}"
        )
    if args.json:
        args.json.write_text(json.dumps(signed(found), indent=2) + "\n", "utf-8")


if __name__ == "__main__":
    main()
