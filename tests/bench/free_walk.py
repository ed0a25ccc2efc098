"""Free walks: random keys and turns in a real browser, against what a real server says of them.

Also run by itself, as part of `hall bench walking`.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[2]))
from bench.browser import enter  # noqa: E402
from bench.wire import wire  # noqa: E402
from plain_hall import write_plain_hall  # noqa: E402
from running_hall import running_hall  # noqa: E402

VIEW = {"width": 480, "height": 270}
KEYS = {
    "KeyW": 0.5,
    "KeyA": 0.3,
    "KeyS": 0.3,
    "KeyD": 0.3,
    "KeyQ": 0.15,
    "KeyE": 0.15,
}  # and how often they are held

# What was shown when a batch left, by the number of its last input; the server's answer to that number; and at every
# frame how far the display is from the server's last word.
LISTEN = """
() => {
  const Real = window.WebSocket, left = new Map();
  window.__free = {missed: [], apart: [], back: 0, walked: 0};
  window.__said = null;
  window.WebSocket = class extends Real {
    constructor(...args) {
      super(...args);
      if (!String(args[0]).includes("/walk")) return;
      this.addEventListener("message", (event) => {
        const message = JSON.parse(event.data);
        if (message.t !== "pose") return;
        window.__said = message;
        const shown = left.get(message.seq);
        left.delete(message.seq);
        if (shown) window.__free.missed.push(Math.hypot(shown.x - message.x, shown.z - message.z));
      });
    }
    send(text) {
      super.send(text);
      const message = String(text).startsWith("{") ? JSON.parse(text) : {};
      if (message.t === "in") left.set(message.in.at(-1)[0], hall.pose());
    }
  };
}
"""

LOOK = """
() => {
  const free = window.__free = {missed: [], apart: [], walked: 0};
  let before = hall.displayed();
  window.__looking = true;
  const look = () => {
    if (!window.__looking) return;
    const [x, , z] = hall.displayed();
    free.walked += Math.hypot(x - before[0], z - before[2]);
    before = [x, 0, z];
    if (window.__said) free.apart.push(Math.hypot(x - window.__said.x, z - window.__said.z));
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}
"""


@dataclass(frozen=True)
class FreeWalk:
    """Display against server [mm]: for the same input (miss), at the same moment (apart), at rest; walked [m]."""

    round_trip_ms: float
    beside: str
    seconds: float
    answers: int
    frames: int
    walked_m: float
    miss_median_mm: float
    miss_largest_mm: float
    apart_median_mm: float
    apart_largest_mm: float
    at_rest_mm: float


@contextlib.contextmanager
def spinners(count: int) -> Iterator[None]:
    """`count` processes that do nothing but spin."""
    running = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in running:
            process.kill()
            process.wait()


def free_walk(page: Any, seconds: float, seed: int) -> dict[str, Any]:
    """Press random keys and drag at random for so long; what LOOK and LISTEN saw, and the distance once at rest [m]."""
    rng = np.random.default_rng(seed)
    page.evaluate(LOOK)
    held: set[str] = set()
    begin = page.evaluate("() => performance.now()")
    while page.evaluate("() => performance.now()") - begin < 1000 * seconds:
        wanted = {key for key, share in KEYS.items() if rng.random() < share}
        for key in held - wanted:
            page.keyboard.up(key)
        for key in wanted - held:
            page.keyboard.down(key)
        held = wanted
        if rng.random() < 0.3:
            page.mouse.move(240, 120)
            page.mouse.down()
            page.mouse.move(240 + float(rng.uniform(-200, 200)), 120, steps=4)
            page.mouse.up()
        page.wait_for_timeout(1000 * float(rng.choice([0.05, 0.15, 0.4, 1.0])))
    for key in held:
        page.keyboard.up(key)
    page.wait_for_timeout(1000)
    page.wait_for_function("() => hall.ahead() === 0")
    page.wait_for_timeout(1000)  # what differs may still fade
    page.evaluate("() => { window.__looking = false; }")
    seen = page.evaluate("() => window.__free")
    x, _, z = page.evaluate("() => hall.displayed()")
    said = page.evaluate("() => window.__said")
    return {**seen, "rest": float(np.hypot(x - said["x"], z - said["z"]))}


def measure_free(browser: Any, *, round_trip: float, beside: int, seconds: float, seed: int) -> FreeWalk:
    """One walk in a hall of its own, `round_trip` [s] away, beside so many spinning processes."""
    with (
        tempfile.TemporaryDirectory() as folder,
        running_hall(write_plain_hall(Path(folder) / "content"), Path(folder) / "work") as hall,
        wire(hall.port, round_trip) as line,
    ):
        page = browser.new_page(viewport=VIEW)
        page.add_init_script(f"({LISTEN})()")
        enter(page, f"http://127.0.0.1:{line.port}/?lang=en")
        page.wait_for_timeout(2000)
        with spinners(beside):
            seen = free_walk(page, seconds, seed)
        page.close()
    missed, apart = 1000 * np.array(seen["missed"]), 1000 * np.array(seen["apart"])
    return FreeWalk(
        round_trip_ms=1000 * round_trip,
        beside=f"{beside} spinning" if beside else "quiet",
        seconds=seconds,
        answers=len(missed),
        frames=len(apart),
        walked_m=seen["walked"],
        miss_median_mm=float(np.median(missed)),
        miss_largest_mm=float(missed.max()),
        apart_median_mm=float(np.median(apart)),
        apart_largest_mm=float(apart.max()),
        at_rest_mm=1000 * seen["rest"],
    )


def measure_all(browser: Any, seconds: float, seed: int) -> list[dict[str, Any]]:
    """Quiet and beside a spinner on each core, without and with 80 ms of round trip."""
    return [
        asdict(measure_free(browser, round_trip=rtt, beside=beside, seconds=seconds, seed=seed))
        for beside in (0, os.cpu_count() or 1)
        for rtt in (0.0, 0.08)
    ]
