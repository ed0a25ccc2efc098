"""The page: cold load, bytes, close-up and key-to-camera, in a real Chromium with software WebGL.

    python tests/bench/bench_page.py [--runs 5] [--content FOLDER] [--only fast|slow] [--beside CHECKOUT] [--json FILE]

Each run is a new browser context (cold cache), 1280x720, from navigation until every node of the hall is drawn.
Bytes are counted on the wire between browser and server: everything, headers and sockets, both directions.
The slow line carries 1.6 Mbit/s with a round trip of 300 ms, 480x270: when the door can be read, when one may enter.
--beside measures the same of another checkout, visit by visit in turn, on the slow line.
"""

import argparse
import contextlib
import json
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[2]))

from bench.browser import open_browser  # noqa: E402
from bench.door import BITS, ROUND_TRIP, longest_stand, slow_visit  # noqa: E402
from bench.signature import signed  # noqa: E402
from bench.track import latencies, watch  # noqa: E402
from bench.wire import Wire, wire  # noqa: E402
from running_hall import running_hall  # noqa: E402

FRAMES = """
() => new Promise((done) => {
  const times = [];
  const look = (now) => {
    times.push(now);
    if (now - times[0] < 3000) requestAnimationFrame(look);
    else done(times);
  };
  requestAnimationFrame(look);
})
"""


def visit(browser, line: Wire, exhibits: list[str]) -> dict:
    """One cold visit: load, walk, open every exhibit's close-up."""
    carried = line.carried()
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    watch(page)
    began = time.perf_counter()
    page.goto(f"http://127.0.0.1:{line.port}/?lang=en")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=180_000)
    load = time.perf_counter() - began
    page_clock = page.evaluate("() => hall.loadedAt") / 1000
    first_view = line.carried() - carried
    page.click("[data-testid=enter]")
    page.locator("[data-testid=enter-screen]").wait_for(state="detached")
    page.wait_for_timeout(500)
    found, _ = latencies(page, 8)
    page.keyboard.down("KeyW")
    times = page.evaluate(FRAMES)
    page.keyboard.up("KeyW")
    frames = [b - a for a, b in zip(times, times[1:], strict=False)]
    closeups = {exhibit: closeup(page, exhibit) for exhibit in exhibits}
    context.close()
    return {
        "load_s": load,
        "page_clock_s": page_clock,
        "bytes": first_view,
        "key_to_camera_ms": statistics.median(found),
        "frame_ms": statistics.median(frames),
        "closeup_s": closeups,
    }


def closeup(page, exhibit: str) -> float:
    """Seconds from the click until the fine model is drawn."""
    page.click("[data-testid=list]")
    item = page.locator(f"[data-testid=list-item-{exhibit}]")
    item.wait_for()
    began = page.evaluate("() => performance.now()")
    item.click()
    page.locator("[data-testid=panel]:not([hidden])").wait_for()
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
    ended = page.evaluate("() => hall.closeupAt()")
    page.keyboard.press("Escape")
    page.locator("[data-testid=panel]").wait_for(state="hidden")
    page.wait_for_timeout(300)
    return (ended - began) / 1000


def on_slow_line(browser, runs: int, content: Path, beside: Path | None) -> dict[str, list[dict]]:
    """Cold visits over the slow line, of this checkout and of another one in turn."""
    here = Path(__file__).parents[2]
    checkouts = {"here": here} | ({beside.name: beside.resolve()} if beside else {})
    found: dict[str, list[dict]] = {name: [] for name in checkouts}
    with contextlib.ExitStack() as stack:
        lines = {}
        for name, folder in checkouts.items():
            work = Path(stack.enter_context(tempfile.TemporaryDirectory()))
            hall = stack.enter_context(
                running_hall(content, work, env={"PYTHONPATH": str(folder), "PYTHONSAFEPATH": "1"})
            )
            lines[name] = stack.enter_context(wire(hall.port, ROUND_TRIP, BITS))
        for number in range(runs):
            for name, line in lines.items():
                found[name].append(slow_visit(browser, line))
                ready = found[name][-1]["ready_s"]
                print(f"slow line, {name}, run {number + 1}: ready {ready:.2f} s", flush=True)
    return found


def slow_figures(visits: list[dict]) -> dict[str, dict[str, float]]:
    return {
        "door_s": spread([max(visit["painted_s"], visit["title_s"]) for visit in visits]),
        "ready_s": spread([visit["ready_s"] for visit in visits]),
        "door_kilobytes": spread([visit["door"]["bytes"] / 1e3 for visit in visits]),
        "megabytes": spread([visit["bytes"] / 1e6 for visit in visits]),
        "progress_stands_s": spread([longest_stand(visit) for visit in visits]),
    }


def spread(values: list[float]) -> dict[str, float]:
    return {"median": statistics.median(values), "min": min(values), "max": max(values)}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--content", type=Path, default=Path(__file__).parents[2] / "assets")
    parser.add_argument("--only", choices=("fast", "slow"), help="one of the two lines")
    parser.add_argument("--beside", type=Path, metavar="CHECKOUT")
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    summary: dict = {"cores": os.cpu_count(), "runs": arguments.runs}
    told: dict = {"summary": summary}
    with open_browser() as browser:
        if arguments.only != "slow":
            told["runs"] = on_fast_line(browser, arguments.runs, arguments.content)
            summary |= fast_figures(told["runs"])
            closeups = {f"closeup_s {name}": row for name, row in summary["closeup_s"].items()}
            rows = {name: row for name, row in summary.items() if isinstance(row, dict) and "median" in row}
            show(f"1280x720, software WebGL, {summary['cores']} cores", rows | closeups)
        if arguments.only != "fast":
            told["slow"] = on_slow_line(browser, arguments.runs, arguments.content, arguments.beside)
            summary["slow"] = {name: slow_figures(visits) for name, visits in told["slow"].items()}
            for name, rows in summary["slow"].items():
                show(f"1.6 Mbit/s, 300 ms, {name}", rows)
    if arguments.json:
        arguments.json.write_text(json.dumps(signed(told), indent=1))
    return 0


def on_fast_line(browser, runs: int, content: Path) -> list[dict]:
    """Cold visits over a line that holds nothing back."""
    import urllib.request

    found = []
    with (
        tempfile.TemporaryDirectory() as work,
        running_hall(content, Path(work)) as hall,
        wire(hall.port) as line,
    ):
        with urllib.request.urlopen(f"{hall.url}/api/scene") as answer:
            exhibits = [entry["id"] for entry in json.load(answer)["exhibits"]]
        for number in range(runs):
            found.append(visit(browser, line, exhibits))
            print(f"run {number + 1}: load {found[-1]['load_s']:.2f} s", flush=True)
    return found


def fast_figures(runs: list[dict]) -> dict:
    return {
        "load_s": spread([run["load_s"] for run in runs]),
        "megabytes": spread([run["bytes"] / 1e6 for run in runs]),
        "frame_ms": spread([run["frame_ms"] for run in runs]),
        "key_to_camera_ms": spread([run["key_to_camera_ms"] for run in runs]),
        "closeup_s": {
            name: spread([run["closeup_s"][name] for run in runs]) for name in runs[0]["closeup_s"]
        },
    }


def show(title: str, rows: dict[str, dict[str, float]]) -> None:
    print(f"\n{title:40} {'median':>9} {'min':>9} {'max':>9}")
    for label, row in rows.items():
        print(f"{label:40} {row['median']:9.3f} {row['min']:9.3f} {row['max']:9.3f}")


if __name__ == "__main__":
    sys.exit(main())
