"""What a visitor really sees while walking: the displayed camera at every frame, and what the server said."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np
import shapely
from numpy.typing import NDArray

PATIENCE = 30_000  # [ms]

LISTEN = """
() => {
  const Real = window.WebSocket;
  window.__said = [];
  window.__moved = 0;
  window.WebSocket = class extends Real {
    constructor(...args) {
      super(...args);
      if (!String(args[0]).includes("/walk")) return;
      this.addEventListener("message", (event) => {
        const message = JSON.parse(event.data);
        if (message.t === "pose") window.__said.push([performance.now(), message.x, message.z]);
        if (message.t === "moved") window.__moved += 1;
      });
    }
  };
}
"""

RECORD = """
() => {
  window.__track = [];
  window.__recording = true;
  const look = (now) => {
    if (!window.__recording) return;
    const [x, y, z] = hall.displayed();
    const at = hall.pose();
    window.__track.push([now, x, y, z, at.x, at.z]);
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}
"""

# From the key event's own time stamp until a frame whose camera stands elsewhere has been handed to the renderer:
# the message arrives when all of a frame's callbacks are through.
# Listens from the start, ahead of the page's own listeners.
LATENCY = """
() => {
  window.__latency = [];
  if (window.top !== window) return;
  addEventListener("keydown", (event) => {
    if (event.code !== "KeyW" || event.repeat || !window.hall) return;
    const before = hall.displayed();
    const channel = new MessageChannel();
    let frames = 0;
    const ask = () => requestAnimationFrame(() => { frames += 1; channel.port2.postMessage(0); });
    channel.port1.onmessage = () => {
      const [x, , z] = hall.displayed();
      if (Math.hypot(x - before[0], z - before[2]) > 1e-4) {
        window.__latency.push([performance.now() - event.timeStamp, frames]);
      } else if (performance.now() - event.timeStamp < 60000) ask();
    };
    ask();
  }, true);
}
"""


@dataclass(frozen=True)
class Track:
    """times (N,) [s], shown (N, 2) [m] as (x, z), server (M, 3) [s, m, m]; disagreement [m] at the same input."""

    times: NDArray[np.float64]
    shown: NDArray[np.float64]
    server: NDArray[np.float64]
    disagreement: float

    def last(self, seconds: float) -> NDArray[np.float64]:
        """Displayed places of the last `seconds`."""
        return self.shown[self.times >= self.times[-1] - seconds]

    def intrusion(self, solids: list[shapely.Geometry], radius: float) -> float:
        """How far the body's circle was seen inside a solid [m]; 0 when never."""
        points = shapely.points(self.shown)
        nearest = np.min([shapely.distance(points, solid) for solid in solids], axis=0)
        return float(max(0.0, np.max(radius - nearest)))

    def trembling(self, seconds: float = 1.0) -> float:
        """Extent of the displayed places in the last `seconds` [m]: for a visitor who is held in place."""
        return float(np.max(np.ptp(self.last(seconds), axis=0)))

    def backward(self, heading: tuple[float, float]) -> float:
        """Longest displayed step against the wish (unit vector) [m]: for a visitor who slides on."""
        steps = np.diff(self.shown, axis=0) @ np.asarray(heading)
        return float(max(0.0, -steps.min()))

    def apart(self) -> float:
        """Distance of the last displayed place from the server's last word [m]."""
        return float(np.hypot(*(self.shown[-1] - self.server[-1, 1:])))


def solids_of_scene(scene: dict) -> list[shapely.Geometry]:
    """Exact shapes of what stands in the way, from the page's own description; a round is a point and a radius."""
    return [
        shapely.Point(s["round"][:2]).buffer(s["round"][2], quad_segs=256)
        if "round" in s
        else shapely.Polygon(s["polygon"])
        for s in scene["solids"]
    ]


def watch(page) -> None:
    """Prepare a page, before it opens the hall, to be measured."""
    page.add_init_script(f"({LISTEN})(); ({LATENCY})()")


def walk(page, *, hold: float, keys: tuple[str, ...] = ("KeyW",), settle: float = 0.3) -> Track:
    """Hold the keys for `hold` seconds and report what was seen."""
    page.evaluate("() => { window.__said.length = 0; }")
    page.evaluate(RECORD)
    for key in keys:
        page.keyboard.down(key)
    page.wait_for_timeout(1000 * hold)
    # A busy machine may not have drawn the walk yet.
    page.wait_for_function("() => window.__track.length >= 10", timeout=PATIENCE)
    track = page.evaluate("() => window.__track.slice()")
    for key in keys:
        page.keyboard.up(key)
    page.wait_for_timeout(1000 * settle)
    # The server's last word is its word on the last step, however long a busy machine takes to bring it.
    page.wait_for_function("() => hall.ahead() === 0")
    said, worst = page.evaluate("() => [window.__said, hall.disagreement()]")
    end = page.evaluate("() => { window.__recording = false; return hall.displayed(); }")
    values = np.asarray(track, float)
    shown = np.vstack([values[:, [1, 3]], [[end[0], end[2]]]])
    times = np.append(values[:, 0], values[-1, 0] + 1) / 1000
    return Track(times, shown, np.asarray(said, float).reshape(-1, 3), worst)


# The server's word has come (a page that is watched counts them), and the visitor stands there, within a cell of the
# walking grid.
ARRIVED = """
([x, z, moved]) => {
  const pose = hall.pose();
  return Math.hypot(pose.x - x, pose.z - z) < 0.05 && (moved === null || window.__moved > moved);
}
"""


def place(page, x: float, z: float, yaw: float) -> None:
    """Stand at (x, z) [m] looking along yaw [rad]: the minimap's way there, then the head is turned by dragging."""
    moved = page.evaluate(
        "([x, z, yaw]) => { hall.goTo(x, z, yaw); return window.__moved ?? null; }", [x, z, yaw]
    )
    page.wait_for_function(ARRIVED, arg=[x, z, moved], timeout=PATIENCE)
    page.wait_for_timeout(400)


def latencies(page, presses: int = 12) -> tuple[list[float], list[int]]:
    """From key to camera, one a press: milliseconds, and the frames drawn until one shows it."""
    page.evaluate("() => { window.__latency.length = 0; }")
    for number in range(presses):
        began = perf_counter()
        page.keyboard.down("KeyW")
        page.wait_for_function("(number) => window.__latency.length > number", arg=number, timeout=PATIENCE)
        page.keyboard.up("KeyW")
        page.keyboard.down("KeyS")  # and back: a slow machine holds keys for long, and there is a wall ahead
        page.wait_for_timeout(1000 * (perf_counter() - began))
        page.keyboard.up("KeyS")
        page.wait_for_timeout(120)
    found = page.evaluate("() => window.__latency")
    return [ms for ms, _ in found], [frames for _, frames in found]
