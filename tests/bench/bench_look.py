"""What the hall's light costs: CPU time a picture of the same hall, lit in four ways, with software WebGL.

    python tests/bench/bench_look.py [--rounds 4] [--content FOLDER] [--json FILE]
    python tests/bench/bench_look.py --silk [--rounds 4] [--json FILE]      what silk's gleam costs: look_silk.py
    python tests/bench/bench_look.py --before CHECKOUT [--exhibit beizi]    beside an earlier hall with its own content

shipped    room unlit, its light baked; two lights and the room's reflection for the exhibits
ambient    the same models with lit materials, one ambient light and nothing else
default    the same models with lit materials under viser's default environment map

beside     ambient light beside that environment map: what a viser program gets that adds the light and stops there

An earlier page leaves it to viser how many pixels it draws, which follows the machine's speed from picture to picture:
it is held to this page's.

All halls run at once and are drawn in turn by one Chromium at 960x540, with the picture quality that software WebGL is
given ("low": two thirds of the pixels each way, textures by one bilinear look-up); a picture's cost is the CPU time of
Chromium's GPU process, which holds the software renderer. Best of several rounds.
"""

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[2]))

from bench.browser import enter, open_browser  # noqa: E402
from bench.picture_pairs import STANDS  # noqa: E402
from bench.signature import signed  # noqa: E402
from running_hall import running_hall  # noqa: E402

ROOT = Path(__file__).parents[2]
LOOKS = ("shipped", "ambient", "beside", "default")
SURROUNDED = ("beside", "default")
MOST = {"ambient": 1 / 2, "beside": 1 / 2, "default": 1 / 3}  # what the shipped look may cost of each
MOST_BEFORE = {"entry": 1.3, "exhibit": 1.0}  # and of commit 47c1f8d, with all exhibits in
VIEW = {"width": 960, "height": 540}
SCRIPT = "hall.packed.js"  # all of the page's modules
DRAW = """
(ms) => new Promise((done) => {
  const before = hall.framesDrawn(), end = performance.now() + ms;
  const more = () => {
    window.__viserMutable.requestRender();
    if (performance.now() < end) requestAnimationFrame(more);
    else done(hall.framesDrawn() - before);
  };
  more();
})
"""
ENVIRONMENT = "() => Boolean(window.__viserMutable.scene.environment)"
SIZE = """
() => {
  const gl = window.__viserMutable.scene.__r3f.root.getState().gl;
  return [gl.domElement.width, gl.domElement.height, gl.getPixelRatio()];
}
"""


def gpu_process() -> int:
    """Process id of the GPU process of the Chromium this program has started."""
    parents, gpus = {}, []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            pid = int(folder.name)
            parents[pid] = int((folder / "stat").read_text().rsplit(")", 1)[1].split()[1])
            if b"--type=gpu-process" in (folder / "cmdline").read_bytes():
                gpus.append(pid)
    for pid in gpus:
        above = pid
        while above := parents.get(above, 0):
            if above == os.getpid():
                return pid
    raise RuntimeError("Chromium has no GPU process – its flags must ask for software WebGL")


def cpu_seconds(pid: int) -> float:
    """CPU time a process has used so far, all threads."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def cost(page, gpu: int, seconds: float) -> float:
    """CPU milliseconds a picture while `page` draws for so long."""
    page.bring_to_front()
    page.wait_for_timeout(500)  # the page before draws on for a moment
    page.evaluate(DRAW, 500)
    began = cpu_seconds(gpu)
    pictures = page.evaluate(DRAW, 1000 * seconds)
    return 1000 * (cpu_seconds(gpu) - began) / pictures


def keep_environment(route) -> None:
    """The page takes environments off below "high"; the hall that is lit by one keeps it."""
    reply = route.fetch()
    text = reply.text()
    if "reflections: false" not in text:
        raise RuntimeError(f"{SCRIPT} no longer says `reflections: false` – this bench must follow it")
    route.fulfill(response=reply, body=text.replace("reflections: false", "reflections: true"))


Rounds = dict[str, dict[str, list[float]]]  # hall -> view -> CPU ms a picture in each round


def in_turn(
    pages: dict[str, Any], stands: dict[str, dict[str, list[float]]], rounds: int, seconds: float
) -> Rounds:
    """What each hall's picture costs at each of its places, [x, z, yaw …] by view, drawn one after the other; the other
    halls stand still meanwhile, since what moves in them would count as well."""
    gpu = gpu_process()
    time.sleep(4)  # the pages' first look at the machine's speed
    found: Rounds = {name: {view: [] for view in places} for name, places in stands.items()}
    life = {name: page.context.new_cdp_session(page) for name, page in pages.items()}

    def live(name: str, state: str) -> None:
        life[name].send("Page.setWebLifecycleState", {"state": state})

    for name in pages:
        live(name, "frozen")
    for number in range(rounds):
        for view in next(iter(stands.values())):
            for name, page in pages.items():
                live(name, "active")
                page.evaluate("(there) => hall.goTo(...there)", stands[name][view])
                page.wait_for_timeout(600)
                found[name][view].append(cost(page, gpu, seconds))
                live(name, "frozen")
        print(f"round {number + 1} of {rounds}", flush=True)
    return found


def held_to(page, pixels: list[float]) -> None:
    """Lets a page draw so many pixels (wide, high, and for each of the page's), whatever the machine's speed."""
    page.evaluate("(ratio) => window.__viserTestpoints.devSettings.set({ fixedDpr: ratio })", pixels[2])
    page.evaluate(DRAW, 500)
    if (found := page.evaluate(SIZE)) != pixels:
        raise RuntimeError(
            f"a page draws {found} pixels instead of {pixels} – halls that draw as many can be compared"
        )


def views(page, exhibit: str | None = None) -> dict[str, list[float]]:
    """The entry, and the place before an exhibit, the first one where none is named."""
    scene = page.evaluate("async () => (await fetch('/api/scene')).json()")
    start, before = scene["start"], page.evaluate(STANDS)
    return {
        "entry": [start["x"], start["z"], start["yaw"]],
        "exhibit": before[exhibit or scene["exhibits"][0]["id"]][:3],
    }


def bare_page(browser, url: str, prepare: Callable[[Any], None] = lambda page: None) -> Any:
    """A page in the hall, with nothing laid over the picture; prepare: done to it first."""
    page = browser.new_context(viewport=VIEW).new_page()
    prepare(page)
    enter(page, f"{url}/?lang=en")
    page.evaluate("() => { document.querySelector('#hall-ui').style.display = 'none'; }")
    return page


def lit_by_itself(page) -> None:
    page.route(f"**/{SCRIPT}*", keep_environment)


def measured(rounds: int, seconds: float, content: Path) -> Rounds:
    """Of each look, in the same hall at the same places."""
    with contextlib.ExitStack() as stack:
        work = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        browser = stack.enter_context(open_browser())
        program = (sys.executable, str(Path(__file__).with_name("look_hall.py")))
        pages = {}
        for look in LOOKS:
            hall = stack.enter_context(
                running_hall(content, work / look, program=program, env={"HALL_LOOK": look})
            )
            prepared = (lit_by_itself,) if look in SURROUNDED else ()
            pages[look] = bare_page(browser, hall.url, *prepared)
            pages[look].wait_for_timeout(4000)
            if pages[look].evaluate(ENVIRONMENT) != (look in SURROUNDED):
                raise RuntimeError(f"{look}: its environment is not what it is named after – mend this bench")
        where = views(pages["shipped"])
        return in_turn(pages, dict.fromkeys(LOOKS, where), rounds, seconds)


def beside_earlier(rounds: int, seconds: float, halls: dict[str, Path], exhibit: str) -> Rounds:
    """Of each hall before its own exhibit; halls: checkouts, each with its content in `assets`."""
    program = (sys.executable, "-P", "-m", "hall_app")
    with contextlib.ExitStack() as stack:
        work = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        browser = stack.enter_context(open_browser())
        pages = {}
        for name, checkout in halls.items():
            env = {"PYTHONPATH": str(checkout.resolve())}
            hall = stack.enter_context(
                running_hall(checkout / "assets", work / name, program=program, env=env)
            )
            pages[name] = bare_page(browser, hall.url)
            pages[name].wait_for_timeout(8000)  # an earlier page tells nobody when all has come
        pixels = pages["now"].evaluate(SIZE)
        for page in pages.values():
            held_to(page, pixels)
        return in_turn(pages, {name: views(page, exhibit) for name, page in pages.items()}, rounds, seconds)


def bests(found: Rounds) -> dict[str, dict[str, float]]:
    return {name: {view: min(values) for view, values in row.items()} for name, row in found.items()}


def earlier(rounds: int, seconds: float, checkout: Path, exhibit: str, path: Path | None) -> int:
    """Measures this hall beside an earlier one and prints both."""
    found = beside_earlier(rounds, seconds, {"now": ROOT, "before": checkout}, exhibit)
    best = bests(found)
    share = {view: best["now"][view] / best["before"][view] for view in best["now"]}
    print(f"\n{'CPU ms a picture, best of ' + str(rounds):34}{'entry':>10}{exhibit:>10}")
    for name, row in best.items():
        print(f"{name:34}{row['entry']:10.1f}{row['exhibit']:10.1f}")
    print(f"{'now / before':34}{share['entry']:10.2f}{share['exhibit']:10.2f}")
    print(f"{'asked at most':34}{MOST_BEFORE['entry']:10.2f}{MOST_BEFORE['exhibit']:10.2f}")
    if path:
        told = {"cpu_ms": best, "share": share, "before": checkout_commit(checkout)}
        path.write_text(json.dumps(signed({"summary": told, "rounds": found}), indent=1))
    return 0


def checkout_commit(checkout: Path) -> str:
    command = ("git", "-C", str(checkout), "rev-parse", "--short", "HEAD")
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def summary(found: Rounds) -> dict:
    """Best of the rounds, and the shipped look's share of the others, the worst of the views."""
    best = bests(found)
    share = {
        other: max(best["shipped"][view] / best[other][view] for view in best[other]) for other in LOOKS[1:]
    }
    reached = {other: value <= MOST[other] for other, value in share.items()}
    return {"cpu_ms": best, "share": share, "reached": reached}


def silk(rounds: int, seconds: float, path: Path | None) -> int:
    """Measures the gleam of a figured silk and prints it."""
    from bench.look_silk import measured, table

    found = measured(rounds, seconds, cost, gpu_process)
    text, numbers = table(found)
    print(f"\nbest of {rounds}\n{text}")
    if path:
        path.write_text(json.dumps(signed({"summary": numbers, "rounds": found}), indent=1))
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=4)
    parser.add_argument("--seconds", type=float, default=2.5, help="of drawing, each time")
    parser.add_argument("--content", type=Path, default=ROOT / "assets")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--silk", action="store_true", help="what the gleam of a figured silk costs, alone")
    parser.add_argument("--before", type=Path, metavar="CHECKOUT", help="this hall beside an earlier one")
    parser.add_argument("--exhibit", default="beizi", help="before which both are drawn, of what both show")
    arguments = parser.parse_args()
    if arguments.before:
        return earlier(
            arguments.rounds, arguments.seconds, arguments.before, arguments.exhibit, arguments.json
        )
    if arguments.silk:
        return silk(arguments.rounds, arguments.seconds, arguments.json)
    found = measured(arguments.rounds, arguments.seconds, arguments.content)
    result = summary(found)
    print(f"\n{'CPU ms a picture, best of ' + str(arguments.rounds):34}{'entry':>10}{'exhibit':>10}")
    for look, row in result["cpu_ms"].items():
        print(f"{look:34}{row['entry']:10.1f}{row['exhibit']:10.1f}")
    for other, share in result["share"].items():
        print(f"{'shipped / ' + other:34}{share:10.2f}{'asked':>10} {MOST[other]:.2f}")
    if arguments.json:
        arguments.json.write_text(json.dumps(signed({"summary": result, "rounds": found}), indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
