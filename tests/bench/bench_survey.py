"""The survey service, measured: speed with every answer on the disk, what kills and full disks leave, conformity.

Prints a table; --json FILE writes the figures (default: docs/figures/survey_service.json). Exit status 1 where
an answer was lost, doubled or partial, the sync did not come before the receipt, or the API broke its description.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from http.client import HTTPException
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]

from signature import signed  # noqa: E402
from survey_service import ASSETS, Service, stored, submission  # noqa: E402

from survey import read_questionnaire  # noqa: E402

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
URL = "/api/v1/questionnaires/garment/submissions"
LEAST_PER_SECOND, MOST_P99_MS = 1000, 100
MOST_ANALYSIS_S = 5.0  # of 100,000 answers, from the store to the summary
PARTS = ("load", "order", "kills", "full", "exports", "conformity")


def load(work: Path, clients: int, seconds: float, rounds: int) -> dict:
    """The round of median speed, with the speeds of all; each has a store of its own and a bare loop beside it."""
    made = [loaded(work, f"load{number}", clients, seconds) for number in range(rounds)]
    made.sort(key=lambda found: found["per_second"])
    speeds = [found["per_second"] for found in made]
    return made[rounds // 2] | {"per_second_of_rounds": speeds, "partial": sum(f["partial"] for f in made)}


def loaded(work: Path, name: str, clients: int, seconds: float) -> dict:
    """Submissions a second over HTTP, and beside it a bare loop of one write and one sync."""
    body = work / "body.json"
    body.write_text(json.dumps({"id": GARMENT.id, "body": submission(GARMENT)}), "utf-8")
    service = Service(work / name)
    program = [sys.executable, str(Path(__file__).parent / "survey_load.py"), str(service.port)]
    try:
        subprocess.run([*program, str(clients), "1", str(body)], check=True, capture_output=True)
        found = json.loads(
            subprocess.run(
                [*program, str(clients), str(seconds), str(body)], check=True, capture_output=True, text=True
            ).stdout
        )
    finally:
        service.stop()
    times, rows = sorted(found["times"]), stored(work / name)
    return {
        "clients": clients,
        "cores": len(os.sched_getaffinity(0)),
        "per_second": found["codes"].get("201", 0) / found["seconds"],
        "p50_ms": 1e3 * statistics.median(times),
        "p99_ms": 1e3 * times[int(0.99 * len(times))],
        "codes": found["codes"],
        "partial": sum(number != len(GARMENT.item_ids) for number in rows.values()),
        "bare_syncs_per_second": bare_syncs(work, min(seconds, 3.0)),
    }


def bare_syncs(work: Path, seconds: float) -> float:
    """One write of a page's size and one fdatasync after the other, on the same disk."""
    handle, page, count = os.open(work / "bare", os.O_WRONLY | os.O_CREAT), b"x" * 4096, 0
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        os.write(handle, page)
        os.fdatasync(handle)
        count += 1
    os.close(handle)
    return count / seconds


def order(work: Path, number: int = 40) -> dict:
    """What strace sees: between one receipt and the next a sync of the log has returned."""
    if shutil.which("strace") is None:
        return {"strace": None, "receipts": 0, "sent": 0}
    trace = work / "trace"
    watched = "trace=fsync,fdatasync,write,writev,sendto,sendmsg,send"
    service = Service(
        work / "order", before=("strace", "-f", "-y", "-s", "24", "-e", watched, "-o", str(trace))
    )
    for _ in range(number):
        service.request("POST", URL, json.dumps(submission(GARMENT)).encode())
    service.stop()
    synced, receipts, early = False, 0, 0
    pending: set[str] = set()
    for line in trace.read_text("utf-8", "replace").splitlines():
        thread = line.split(maxsplit=1)[0]
        if re.search(r"\bf(data)?sync\(\d+<[^>]*survey\.sqlite-wal", line):
            if "<unfinished" in line:
                pending.add(thread)
            else:
                synced = line.rstrip().endswith("= 0")
        elif thread in pending and re.search(r"f(data)?sync resumed", line):
            pending.discard(thread)
            synced = line.rstrip().endswith("= 0")
        elif "HTTP/1.1 201" in line:
            receipts, early, synced = receipts + 1, early + (not synced), False
    return {"strace": True, "receipts": receipts, "before_the_sync": early, "sent": number}


def kills(work: Path, number: int, threads: int = 16) -> dict:
    """SIGKILL in mid-write, again and again; whoever heard nothing sends the same again to the next process."""
    data, moments = work / "kills", [0.05 + 0.37 * (kill * 0.618 % 1.0) for kill in range(number)]
    acknowledged: set[str] = set()
    unheard: list[dict] = []
    everything: set[str] = set()
    for moment in moments:
        service, unheard, waiting = Service(data), [], unheard

        def keep_sending(service=service, waiting=waiting, unheard=unheard) -> None:
            while True:
                try:
                    body = waiting.pop()
                except IndexError:
                    body = submission(GARMENT)
                everything.add(body["id"])
                try:
                    status, _ = service.request("POST", URL, json.dumps(body).encode())
                except (OSError, HTTPException):
                    unheard.append(body)
                    return
                if status not in (200, 201):
                    raise RuntimeError(f"status {status}")
                acknowledged.add(body["id"])

        workers = [threading.Thread(target=keep_sending) for _ in range(threads)]
        for worker in workers:
            worker.start()
        time.sleep(moment)
        service.stop(signal.SIGKILL)
        for worker in workers:
            worker.join(60)
        unheard += waiting
    service = Service(data)
    for body in unheard:
        service.request("POST", URL, json.dumps(body).encode())
        acknowledged.add(body["id"])
    service.stop()
    rows = stored(data)
    return {
        "kills": number,
        "acknowledged": len(acknowledged),
        "lost": len(acknowledged - set(rows)),
        "partial": sum(count != len(GARMENT.item_ids) for count in rows.values()),
        "doubled_or_unknown": len(rows) - len(set(rows) & everything),
    }


def full(work: Path) -> dict:
    """A disk that takes no more (RLIMIT_FSIZE): refusals, nothing lost, and everything taken once there is room."""
    service = Service(work / "full")
    try:
        kept, refused, texts = [], [], set()
        service.limit_files((work / "full" / "survey.sqlite").stat().st_size + 200_000)
        for _ in range(400):
            body = submission(GARMENT)
            status, reply = service.request("POST", URL, json.dumps(body).encode())
            if status == 201:
                kept.append(body)
            else:
                refused.append(body)
                texts.add((status, json.loads(reply)["problem"]))
        service.limit_files(resource.RLIM_INFINITY)
        taken = [service.request("POST", URL, json.dumps(body).encode())[0] for body in refused]
    finally:
        service.stop()
    rows = set(stored(work / "full"))
    return {
        "taken_before": len(kept),
        "refused": len(refused),
        "statuses": sorted({status for status, _ in texts}),
        "problems": sorted({problem for _, problem in texts}),
        "taken_after": taken.count(201),
        "lost": len({body["id"] for body in [*kept, *refused]} - rows),
    }


def exports(work: Path, answers: int, seconds: float) -> dict:
    """Submissions and readings of results while every format is exported without a pause; then the analysis alone."""
    from survey_exports import exported

    return exported(work, answers, seconds)


def conformity(work: Path, examples: int) -> dict:
    """schemathesis, all checks, fixed seed, on the document and on the one written out for a questionnaire."""
    from survey_conformity import conform

    return conform(work, examples)


def failed(found: dict) -> list[str]:
    """What must not be."""
    bad = []
    if "load" in found and found["load"]["per_second"] < LEAST_PER_SECOND:
        bad.append(f"load: {found['load']['per_second']:.0f} submissions a second, not {LEAST_PER_SECOND}")
    if "load" in found and found["load"]["p99_ms"] > MOST_P99_MS:
        bad.append(f"load: p99 {found['load']['p99_ms']:.0f} ms, not {MOST_P99_MS}")
    if "load" in found and set(found["load"]["codes"]) != {"201"}:
        bad.append(f"load: codes {found['load']['codes']}")
    if found.get("order", {}).get("receipts") != found.get("order", {}).get("sent"):
        bad.append(f"order: {found['order']['receipts']} receipts of {found['order']['sent']}")
    for part, keys in (("load", ("partial",)), ("order", ("before_the_sync",)), ("full", ("lost",))):
        bad += [f"{part}: {key} {found[part][key]}" for key in keys if found.get(part, {}).get(key)]
    if "kills" in found:
        bad += [
            f"kills: {k} {found['kills'][k]}"
            for k in ("lost", "partial", "doubled_or_unknown")
            if found["kills"][k]
        ]
    bad += failed_exports(found.get("exports"))
    if found.get("full", {}).get("statuses", [503]) != [503]:
        bad.append(f"full: statuses {found['full']['statuses']}")
    if "full" in found and found["full"]["taken_after"] != found["full"]["refused"]:
        bad.append("full: the service did not recover")
    if found.get("conformity", {}).get("failures"):
        bad.append("conformity: the API breaks its description")
    return bad


def failed_exports(found: dict | None) -> list[str]:
    if found is None:
        return []
    bad = [
        f"exports: p99 of {what} {found[what]['p99_ms']:.0f} ms, not {MOST_P99_MS}"
        for what in ("submissions", "results")
        if found[what]["p99_ms"] > MOST_P99_MS
    ]
    for how, spent in found["analysis_s"].items():
        if spent > MOST_ANALYSIS_S:
            bad.append(f"exports: analysis by {how} {spent:.1f} s, not {MOST_ANALYSIS_S:.0f}")
    if found["unexpected"]:
        bad.append(f"exports: statuses {found['unexpected']}")
    return bad


def main() -> int:
    parser = argparse.ArgumentParser(prog="survey bench --only service --", description=__doc__)
    parser.add_argument("--parts", default=",".join(PARTS), help="comma-separated: " + ", ".join(PARTS))
    parser.add_argument("--clients", type=int, default=16)
    parser.add_argument("--seconds", type=float, default=8.0, help="of load")
    parser.add_argument("--rounds", type=int, default=5, help="of load; the median counts")
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--answers", type=int, default=100_000, help="stored while exports are made")
    parser.add_argument("--examples", type=int, default=200, help="schemathesis examples an operation")
    parser.add_argument("--json", type=Path, default=ROOT / "docs" / "figures" / "survey_service.json")
    args = parser.parse_args()
    runs = {
        "load": lambda work: load(work, args.clients, args.seconds, args.rounds),
        "order": order,
        "kills": lambda work: kills(work, args.kills),
        "full": full,
        "exports": lambda work: exports(work, args.answers, args.seconds),
        "conformity": lambda work: conformity(work, args.examples),
    }
    found = {}
    with tempfile.TemporaryDirectory(prefix="survey-bench-") as folder:
        for part in args.parts.split(","):
            found[part] = runs[part](Path(folder))
            print(part)
            for key, value in found[part].items():
                print(
                    f"  {key:<24}{value:>12.1f}" if isinstance(value, float) else f"  {key:<24}{value!s:>12}"
                )
            sys.stdout.flush()
    earlier = json.loads(args.json.read_text("utf-8")) if args.json.is_file() else {}
    args.json.parent.mkdir(parents=True, exist_ok=True)
    whole = signed(earlier | found, found)
    args.json.write_text(json.dumps(whole, ensure_ascii=False, indent=1) + "\n", "utf-8")
    for problem in failed(found):
        print(f"survey bench: {problem}", file=sys.stderr)
    return 1 if failed(found) else 0


if __name__ == "__main__":
    sys.exit(main())
