"""What silk's gleam costs: one garment in a figured silk drawn by our lobe, by three.js' own, and in today's cloth.

silk       a figured damask as the page draws it: one stretched lobe a lamp
three.js   the same model with the page's lobe left out: microfacets with anisotropy, sheen
cloth      the same garment in a plain twill with sheen, as all cloth was drawn before

The close-up as it opens, from 10 cm and from 2 cm, and the exhibit as one stands before it in the hall; all halls at
once, drawn in turn.
"""

from __future__ import annotations

import contextlib
import json
import struct
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from bench.browser import enter, open_browser, stand_before
from plain_hall import write_plain_hall
from running_hall import running_hall

ROOT = Path(__file__).parents[2]
KINDS = {"silk": "lian-duan", "three.js": "lian-duan", "cloth": "ling"}
VIEWS = ("hall", "closeup", "10 cm", "2 cm")
MOST = 1.15  # of today's cloth


def as_before(glb: bytes) -> bytes:
    """The GLB without what is new in its materials: sheen alone, as models were."""
    length = struct.unpack_from("<I", glb, 12)[0]
    document = json.loads(glb[20 : 20 + length])
    for material in document["materials"]:
        material.pop("extras", None)
        extensions = material.get("extensions", {})
        for name in [name for name in extensions if not name.endswith("sheen")]:
            del extensions[name]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    rest = glb[20 + length :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + rest


def dressed_hall(folder: Path, kind: str) -> Path:
    """A plain hall whose exhibit is the shipped coat in the kind's weave."""
    from sim_core.garment import Clothed, Garment, write_glb
    from sim_core.weave import Loom, Weave

    home = write_plain_hall(folder) / "exhibits" / "box"
    garment = Garment.load(ROOT / "assets" / "exhibits" / "beizi" / "baked" / "garment.npz")
    maps = Loom().maps(Weave.load(ROOT / "assets" / "weaves" / f"{KINDS[kind]}.toml"), 512)
    for precision in ("close", "hall"):
        path = home / f"{precision}.glb"
        write_glb(path, [Clothed(garment, maps)], precision=precision)
        if kind == "cloth":
            path.write_bytes(as_before(path.read_bytes()))
    toml = (home / "exhibit.toml").read_text("utf-8")
    toml = toml.replace('hall = "box.glb"', 'hall = "hall.glb", close = "close.glb"').replace(
        ', "turn_slowly"', ""
    )
    (home / "exhibit.toml").write_text(toml, "utf-8")
    return folder


def without_lobe(route) -> None:
    """The page's module without what it does to materials."""
    reply = route.fetch()
    text = reply.text()
    begin = "export function gleam(meshes, blend = true) {"
    if begin not in text:
        raise RuntimeError(f"silk.js no longer says `{begin}` – this bench must follow it")
    route.fulfill(response=reply, body=text.replace(begin, begin + " return;"))


def measured(
    rounds: int, seconds: float, cost: Callable[[object, int, float], float], gpu_process: Callable[[], int]
) -> dict[str, dict[str, list[float]]]:
    """Kind -> view -> CPU ms a picture in each round."""
    found: dict[str, dict[str, list[float]]] = {kind: {view: [] for view in VIEWS} for kind in KINDS}
    with contextlib.ExitStack() as stack:
        work = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        browser, pages = stack.enter_context(open_browser()), {}
        for number, kind in enumerate(KINDS):
            content = dressed_hall(work / f"content-{number}", kind)
            hall = stack.enter_context(running_hall(content, work / f"hall-{number}"))
            page = pages[kind] = browser.new_context(viewport={"width": 960, "height": 540}).new_page()
            if kind == "three.js":
                page.route("**/silk.js*", without_lobe)
            enter(page, f"{hall.url}/?lang=en")
            page.evaluate("() => { document.querySelector('#hall-ui').style.display = 'none'; }")
        gpu = gpu_process()
        time.sleep(4)  # the pages' first look at the machine's speed
        for number in range(rounds):
            for view in VIEWS:
                for kind, page in pages.items():
                    show(page, view)
                    found[kind][view].append(cost(page, gpu, seconds))
            print(f"round {number + 1} of {rounds}", flush=True)
    return found


def show(page, view: str) -> None:
    """Bring a page to a view, from wherever the last one left it."""
    page.bring_to_front()
    if view == "hall":
        if page.locator("html[data-closeup]").count():
            page.keyboard.press("Escape")
            page.wait_for_timeout(800)
        stand_before(page, "box")
        page.wait_for_timeout(800)
    elif view == "closeup":
        page.keyboard.press("Enter")
        page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
        page.wait_for_timeout(800)
    elif view == "10 cm":
        page.mouse.dblclick(480, 300)
        page.locator("html[data-closeup-near]").wait_for(state="attached", timeout=30_000)
    else:
        page.evaluate("() => window.__viserMutable.cameraControl.dollyTo(0.02, false)")
    page.wait_for_timeout(300)


def table(found: dict[str, dict[str, list[float]]]) -> tuple[str, dict]:
    """The best of the rounds as lines, and as numbers with silk's share of the others."""
    best = {kind: {view: min(values) for view, values in row.items()} for kind, row in found.items()}
    share = {
        other: {view: best["silk"][view] / best[other][view] for view in VIEWS} for other in list(KINDS)[1:]
    }
    rows = [f"{'CPU ms a picture':20}" + "".join(f"{view:>10}" for view in VIEWS)]
    rows += [f"{kind:20}" + "".join(f"{row[view]:10.1f}" for view in VIEWS) for kind, row in best.items()]
    rows += [
        f"{'silk / ' + other:20}" + "".join(f"{row[view]:10.2f}" for view in VIEWS)
        for other, row in share.items()
    ]
    rows.append(f"asked of silk / cloth: {MOST}")
    return "\n".join(rows), {"cpu_ms": best, "share": share}
