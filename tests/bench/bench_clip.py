"""Clips: bytes, the error of their quantisation, how long packing and unpacking take; beside plain numbers.

    python tests/bench/bench_clip.py [--frames 100] [--vertices 5000] [--page] [--json FILE]

A waving sheet without and with noise of 0.2 mm, and the shipped coat at rest with a ripple laid over it, each with a
figure that strides by its bones. --page: in Chromium, how long reading takes and writing a frame into a model,
with the whole figure and with about as much of it as a hall shows.
"""

import argparse
import base64
import json
import sys
import time
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[2]))

from bench.browser import open_browser  # noqa: E402
from bench.clip_cases import coat, striding, waving  # noqa: E402

from sim_core.body import JOINTS, Mannequin  # noqa: E402
from sim_core.garment.clip import Clip, Drawn, Moved, Skinned  # noqa: E402
from sim_core.garment.levels import Thinning  # noqa: E402

ROOT = Path(__file__).parents[2]


def plain(moved: Moved) -> int:
    """Bytes of the same frames as whole steps of 0.25 mm, deflated as they are."""
    steps = np.round((moved.positions - moved.positions.min((0, 1))) / 0.25e-3).astype("<u2")
    return sum(len(zlib.compress(frame.tobytes(), 9)) for frame in steps)


def measured(name: str, moved: Moved, figure: Skinned) -> dict:
    began = time.perf_counter()
    data = Clip.of([moved], figure=figure, loop=True).to_bytes()
    packed = time.perf_counter()
    clip = Clip.from_bytes(data)
    ended = time.perf_counter()
    frames, count = moved.positions.shape[:2]
    own = sum(len(clip.frame_bytes(k)) for k in range(frames)) - frames * 348
    return {
        "case": name,
        "frames": frames,
        "vertices": count,
        "figure": len(figure.rest),
        "bytes": len(data),
        "bytes_a_vertex": own / frames / count,
        "deflated_steps": plain(moved),
        "float32": 12 * frames * count,
        "error_mm": 1e3 * clip.error,
        "figure_error_mm": 1e3 * max(figure_error(clip, figure, k) for k in (0, frames // 3)),
        "pack_s": packed - began,
        "unpack_s": ended - packed,
    }


def figure_error(clip: Clip, figure: Skinned, frame: int) -> float:
    woman = Mannequin.load(ROOT / "assets" / "mannequins" / "woman.npz")
    return float(np.abs(clip.positions(frame, "figure") - woman.posed(striding(figure.frames)[frame])).max())


TIMED = """
async (text) => {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const began = performance.now(), own = await readClip(bytes), read = performance.now() - began;
  const times = [];
  for (let k = 0; k < 3 * own.frames; k++) {
    const from = performance.now();
    playback.frame((k + 0.5) / own.rate, true);
    times.push(performance.now() - from);
    await new Promise((done) => setTimeout(done));
  }
  times.sort((a, b) => a - b);
  return {read_ms: read, frame_ms: times[times.length >> 1], p95_ms: times[Math.floor(0.95 * times.length)]};
}
"""


def in_page(browser, name: str, moved: Moved, figure: Skinned) -> dict:
    """How long the page takes over a clip whose model is drawn vertex by vertex."""
    from bench.clip_page import ClipPage

    count = moved.positions.shape[1]
    own = (Drawn("cloth", np.arange(count, dtype=np.int32)),)
    whole = replace(figure, drawn=(Drawn("figure", np.arange(len(figure.rest), dtype=np.int32)),))
    data = Clip.of([replace(moved, drawn=own)], figure=whole, loop=True).to_bytes()
    tab = browser.new_page(viewport={"width": 320, "height": 180})
    page = ClipPage(tab, data, [("cloth", count), ("figure", len(figure.rest))])
    told = tab.evaluate(TIMED, base64.b64encode(data).decode())
    tab.close()
    assert page.told["frames"] == len(moved.positions)
    return {"case": name, "vertices": count, "figure": len(figure.rest), "bytes": len(data), **told}


def shown(woman: Mannequin, frames: int) -> Skinned:
    """Head and neck, forearms and feet: about what a robe leaves of a figure."""
    wanted = ("neck", "wrist_l", "wrist_r", "ankle_l", "ankle_r", "toe_l", "toe_r")
    bare = woman.weights[:, [JOINTS.index(name) for name in wanted]].sum(1) > 0.5
    kept = woman.faces[bare[woman.faces].all(1)]
    mesh = Thinning(woman.vertices, kept, np.arange(len(woman.vertices)))
    mesh.to(1600)
    used, index = np.unique(mesh.faces(), return_inverse=True)
    return Skinned.of(woman, striding(frames), part=(used, index.reshape(-1, 3)))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--vertices", type=int, default=5000)
    parser.add_argument("--page", action="store_true", help="in Chromium as well")
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    woman = Mannequin.load(ROOT / "assets" / "mannequins" / "woman.npz")
    figure = Skinned.of(woman, striding(arguments.frames))
    edge = 1.07 / np.sqrt(arguments.vertices)
    cases = {
        "sheet": waving(edge=edge, frames=arguments.frames),
        "sheet, 0.2 mm noise": waving(edge=edge, frames=arguments.frames, noise=2e-4),
        "coat, rippling": coat(arguments.frames, arguments.vertices),
    }
    rows = [measured(name, moved, figure) for name, moved in cases.items()]
    for row in rows:
        print(", ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()))
    if arguments.page:
        bodies = {"whole figure": figure, "figure as shown": shown(woman, arguments.frames)}
        with open_browser() as browser:
            for body, skinned in bodies.items():
                rows.append(in_page(browser, f"page, {body}", cases["coat, rippling"], skinned))
                print(rows[-1])
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
