"""Shared by tests and bench: the page's own walking scripts run in Chromium, against the server's session."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hall_app.walk import Floor, Grid, Keys, Pose, WalkSession

PAGE = Path(__file__).parents[2] / "hall_app" / "page"
WALKMATH = PAGE / "walk" / "walkmath.js"
PREDICTION = PAGE / "walk" / "prediction.js"
HEAD = PAGE / "look" / "head.js"

FORWARD = Keys(1, 0)

SCRIPT = """
async ([source, bytes, meta, job]) => {
  const url = URL.createObjectURL(new Blob([source], {type: "text/javascript"}));
  const walk = await import(url);
  URL.revokeObjectURL(url);
  const raw = Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0));
  const grid = walk.loadGrid(raw.buffer, meta);
  const jobs = {
    constants: () => walk.WALK,
    clearance: ({places}) => places.map(([x, z]) => walk.clearance(grid, x, z)),
    move: ({moves}) => moves.map(([x, z, f, r, yaw, dt]) => {
      const to = walk.move(grid, {x, z}, f, r, yaw, dt);
      return [to.x, to.z];
    }),
    trace: ({start, events}) => {
      const predictor = new walk.Predictor(grid, {x: start[0], z: start[1]});
      const shown = [], misses = [];
      for (const [kind, ...e] of events) {
        if (kind === "push") {
          const [seq, dt, forward, right, yaw, eye] = e;
          const pose = predictor.push({seq, dt, forward, right, yaw, eye});
          shown.push([pose.x, pose.z]);
        } else if (kind === "moved") predictor.teleport(...e);
        else if (kind === "skip") predictor.skip(...e);
        else misses.push(predictor.acknowledge(...e));
      }
      return {shown, misses, pending: predictor.pending.length, worst: predictor.worst};
    },
    timing: ({moves, rounds}) => {
      const began = performance.now();
      for (let k = 0; k < rounds; k++)
        for (const [x, z, f, r, yaw, dt] of moves) walk.move(grid, {x, z}, f, r, yaw, dt);
      return (performance.now() - began) / rounds / moves.length * 1000;
    },
    refused: ({size}) => {
      try { walk.loadGrid(new ArrayBuffer(size), meta); return null; } catch (error) { return error.message; }
    },
  };
  return jobs[job.name](job);
}
"""


@dataclass
class Page:
    """walkmath.js in a browser tab, with one grid."""

    tab: Any
    grid: Grid

    def run(self, name: str, **values: Any) -> Any:
        """Result of one of SCRIPT's jobs."""
        data = base64.b64encode(self.grid.to_bytes()).decode()
        job = {"name": name, **values}
        return self.tab.evaluate(SCRIPT, [WALKMATH.read_text("utf-8"), data, self.grid.meta(), job])


# Many pages at once, each with a prediction of its own; every call is one frame of each.
CROWD = """
async ([walkmath, prediction, bytes, meta, starts]) => {
  const load = (source) => URL.createObjectURL(new Blob([source], {type: "text/javascript"}));
  const address = load(walkmath);
  const walk = await import(address);
  const {Prediction, PACE} = await import(load(prediction.replace("./walkmath.js", address)));
  const raw = Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0));
  const grid = walk.loadGrid(raw.buffer, meta);
  const crowd = starts.map(([x, z]) => new Prediction(grid, {x, z}, 0));
  window.crowdStep = (frames) => JSON.stringify(JSON.parse(frames).map(([answers, dt, forward, right, yaw, now], k) => {
    const page = crowd[k];
    for (const [seq, x, z, at] of answers) page.answer(seq, x, z, at);
    const {x, z} = page.walk(dt, forward, right, yaw, 1.6, now);
    return [x, z, page.take(), page.waiting, page.predictor.worst];
  }));
  return PACE;
}
"""


class Crowd:
    """Pages with prediction.js, one for each start (x, z) [m]; `pace` are the script's constants."""

    def __init__(self, tab: Any, grid: Grid, starts: list[tuple[float, float]]) -> None:
        self.tab = tab
        data = base64.b64encode(grid.to_bytes()).decode()
        sources = [path.read_text("utf-8") for path in (WALKMATH, PREDICTION)]
        self.pace = tab.evaluate(CROWD, [*sources, data, grid.meta(), starts])

    def step(self, frames: list[list[Any]]) -> list[list[Any]]:
        """[answers [seq, x, z, at], dt, forward, right, yaw, now] of each -> [x, z, inputs to send, waiting, worst]."""
        # As text: the browser's driver takes longer over a list than both sides take to walk.
        return json.loads(self.tab.evaluate("(frames) => crowdStep(frames)", json.dumps(frames)))


@dataclass(frozen=True)
class Track:
    """What was shown after each frame, where the server stood at each answer, and how far apart [m]."""

    shown: np.ndarray  # (frames, 2)
    server: np.ndarray  # (answers, 2)
    misses: np.ndarray  # (answers,) shown against server for the same input

    def jitter(self, frames: int) -> float:
        """Largest extent [m] of the last `frames` displayed places."""
        return float(np.ptp(self.shown[-frames:], axis=0).max())


def hold(
    page: Page, floor: Floor, start: Pose, dts: list[float], rtt: float, keys: Keys | list[Keys] = FORWARD
) -> Track:
    """Play frames through Predictor and WalkSession with a round trip of rtt [s]; sent 30 times a second."""
    session = WalkSession(floor, page.grid, start, now=0.0)
    begin = [session.pose.x, session.pose.z]
    events: list[tuple[float, int, list[Any]]] = []
    server: list[tuple[float, float]] = []
    batch: list[list[Any]] = []
    time = sent = 0.0
    for seq, dt in enumerate(dts, start=1):
        held = keys if isinstance(keys, Keys) else keys[seq - 1]
        time += dt
        entry = [seq, dt, held.forward, held.right, start.yaw, 1.6]
        events.append((time, 0, ["push", *entry]))
        batch.append(entry)
        if time - sent >= 1 / 30 - 1e-9 or seq == len(dts):
            reply = session.inputs(batch, time + rtt / 2)
            assert reply.refused == 0
            events.append((time + rtt, 1, ["ack", reply.seq, reply.x, reply.z]))
            server.append((reply.x, reply.z))
            batch, sent = [], time
    events.sort(key=lambda event: event[:2])
    told = page.run("trace", start=begin, events=[event for _, _, event in events])
    return Track(
        np.array(told["shown"]), np.array(server), np.array([m for m in told["misses"] if m is not None])
    )
