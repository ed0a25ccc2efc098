"""Shared by tests and bench: the page's own clip scripts in Chromium, on meshes that only hold arrays."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np

PAGE = Path(__file__).parents[2] / "hall_app" / "page"
ORIGIN = "http://clip.test"

# Meshes as three.js has them, as far as the page touches them; what it asks of viser is counted.
SETUP = """
async ([text, models]) => {
  const [{readClip}, {createPlayback, frameAt}, {createClock}, {normalsOf}] = await Promise.all(
    ["clip_file", "playback", "clock", "normals"].map((name) => import(`/look/clip/${name}.js`)));
  const raw = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  window.__asked = 0;
  const attribute = (count) => ({array: new Float32Array(3 * count), count, version: 0,
    set needsUpdate(value) { if (value) this.version += 1; }});
  const geometry = (count) => ({
    attributes: {position: attribute(count), normal: attribute(count)}, boundingBox: {}, boundingSphere: null,
    computeBoundingSphere() {
      this.boundingSphere = {radius: 0, center: {set(...c) { this.at = c; }}};
    },
  });
  const mesh = ([name, count]) => ({name, isMesh: true, geometry: geometry(count)});
  window.make = () => { window.__meshes = models.map(mesh); };
  make();
  window.__viserMutable = {
    requestRender: () => { window.__asked += 1; },
    nodeRefFromName: {"/exhibits/a": {traverse: (act) => window.__meshes.forEach(act)}},
  };
  const clip = await readClip(raw.buffer);
  Object.assign(window, {clip, frameAt, createClock, normalsOf, readClip,
    playback: createPlayback(clip, "/exhibits/a"), replay: () => createPlayback(clip, "/exhibits/a")});
  return {frames: clip.frames, period: clip.period, names: clip.meshes.map((mesh) => mesh.name)};
}
"""


class ClipPage:
    """A tab that has read a clip; models: names and vertices of the drawn meshes."""

    def __init__(self, tab: Any, data: bytes, models: list[tuple[str, int]]) -> None:
        self.tab = tab
        tab.route(f"{ORIGIN}/**", self._answer)
        tab.goto(f"{ORIGIN}/")
        self.told = tab.evaluate(SETUP, [base64.b64encode(data).decode(), [list(one) for one in models]])

    @staticmethod
    def _answer(route: Any) -> None:
        name = route.request.url.removeprefix(f"{ORIGIN}/")
        if name.endswith(".js"):
            route.fulfill(
                body=(PAGE / name).read_text("utf-8"), content_type="text/javascript; charset=utf-8"
            )
        else:
            route.fulfill(body="<!doctype html><title>clip</title>", content_type="text/html")

    def play(self, seconds: float, *, seen: bool = True) -> bool:
        """Ahead of a picture; whether it wrote a frame."""
        return self.tab.evaluate("([t, seen]) => playback.frame(t, seen)", [seconds, seen])

    def arrays(self, mesh: int) -> tuple[np.ndarray, np.ndarray]:
        """Positions (P, 3) and normals (P, 3) of a drawn mesh."""
        told = self.tab.evaluate(
            """(mesh) => ["position", "normal"].map((name) =>
            Array.from(__meshes[mesh].geometry.attributes[name].array))""",
            mesh,
        )
        return np.array(told[0]).reshape(-1, 3), np.array(told[1]).reshape(-1, 3)

    def asked(self) -> int:
        """Pictures that were asked for so far."""
        return self.tab.evaluate("() => __asked")
