"""The page: cold load, bytes, close-up and key-to-camera, in a real Chromium with software WebGL.

    python tests/bench/bench_page.py [--runs 5] [--content FOLDER] [--json FILE]

Each run is a new browser context (cold cache), 1280x720, from navigation until every node of the hall is drawn.
Bytes are counted on the wire between browser and server: everything, headers and sockets, both directions.
"""

import argparse
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
    found = latencies(page, 8)
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


def spread(values: list[float]) -> dict[str, float]:
    return {"median": statistics.median(values), "min": min(values), "max": max(values)}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--content", type=Path, default=Path(__file__).parents[2] / "assets")
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as work,
        running_hall(arguments.content, Path(work)) as hall,
        wire(hall.port) as line,
        open_browser() as browser,
    ):
        import urllib.request

        with urllib.request.urlopen(f"{hall.url}/api/scene") as answer:
            exhibits = [entry["id"] for entry in json.load(answer)["exhibits"]]
        runs = []
        for number in range(arguments.runs):
            runs.append(visit(browser, line, exhibits))
            print(f"run {number + 1}: load {runs[-1]['load_s']:.2f} s", flush=True)
    summary = {
        "cores": os.cpu_count(),
        "runs": arguments.runs,
        "load_s": spread([run["load_s"] for run in runs]),
        "megabytes": spread([run["bytes"] / 1e6 for run in runs]),
        "frame_ms": spread([run["frame_ms"] for run in runs]),
        "key_to_camera_ms": spread([run["key_to_camera_ms"] for run in runs]),
        "closeup_s": {name: spread([run["closeup_s"][name] for run in runs]) for name in exhibits},
    }
    print(
        f"\n{'1280x720, software WebGL, ' + str(summary['cores']) + ' cores':40} {'median':>9} {'min':>9} {'max':>9}"
    )
    for name, value in summary.items():
        rows = {name: value} if isinstance(value, dict) and "median" in value else {}
        rows |= {f"closeup_s {k}": v for k, v in value.items()} if name == "closeup_s" else {}
        for label, row in rows.items():
            print(f"{label:40} {row['median']:9.3f} {row['min']:9.3f} {row['max']:9.3f}")
    if arguments.json:
        arguments.json.write_text(json.dumps({"summary": summary, "runs": runs}, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
