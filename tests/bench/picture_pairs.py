"""Pairs for a reader who does not know which is which: ten views, beside the same of an earlier hall and of a study.

Both halls are opened in the same browser and seen without what the page lays over the picture. A pair tells its number
and nothing else; which side is ours stands in the key, a file beside the folder. A reader writes `choices-NAME.json`
into the folder, [{"pair": 1, "side": "left", "why": "…"}, …]; `tally` reads them all.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench.browser import at_rest, enter, open_browser, open_exhibit
from PIL import Image
from running_hall import running_hall

DESK = {"width": 1280, "height": 720}
HEIGHT, GAP = 640, 12  # [px] of a pair
GROUND = (24, 22, 20)
BARE = "* { visibility: hidden !important } canvas[data-engine] { visibility: visible !important }"
STANDS = """
async () => {
  const scene = await (await fetch("/api/scene")).json();
  const {standBefore} = await import("/static/ui/map/geometry.js").catch(() => import("/static/ui/map_geometry.js"));
  return Object.fromEntries(scene.exhibits.map((exhibit) => {
    const {x, z, yaw, pitch} = standBefore(exhibit, scene);
    return [exhibit.id, [x, z, yaw, pitch]];
  }));
}
"""
Box = tuple[int, int, int, int]


@dataclass(frozen=True)
class Study:
    """A study's picture, the part of it that is one view, and the part of ours (of 1280 x 720) that shows the same."""

    file: str
    part: Box = (0, 0, 1280, 720)
    ours: Box = (0, 0, 1280, 720)


@dataclass(frozen=True)
class View:
    """One of ours: the hall before an exhibit ("": where one enters), or its close-up, `near` turns of the wheel in,
    turned by `turn` degrees. before: the exhibit that the earlier hall shows instead, where it has not this one."""

    name: str
    exhibit: str = ""
    close: bool = False
    near: int = 0
    turn: float = 0.0
    before: str | None = None
    study: Study | None = None


UPRIGHT = (330, 60, 790, 704)  # of a close-up: a figure and what is beside it
VIEWS = (
    View("entry", study=Study("hall-entry.jpg")),
    View("before the beizi", "beizi"),
    View("before the robe on its bar", "zhiju", before="beizi", study=Study("hall-booth.jpg")),
    View("before the scarf over a robe", "pibo-figure"),
    View("before the scarf", "pibo"),
    View("before the mirror", "mirror"),
    View(
        "the beizi",
        "beizi",
        close=True,
        study=Study("beizi-dressed.jpg", (0, 0, 320, 448), UPRIGHT),
    ),
    View(
        "the scarf over a robe",
        "pibo-figure",
        close=True,
        study=Study("pibo-dressed.jpg", (0, 0, 320, 448), UPRIGHT),
    ),
    View(
        "a collar",
        "beizi",
        close=True,
        near=14,
        study=Study("silk-real-time-collar-cuff-hem.jpg", (0, 26, 522, 668), UPRIGHT),
    ),
    View(
        "the beizi's back",
        "beizi",
        close=True,
        turn=180.0,
        study=Study("beizi-dressed.jpg", (640, 0, 960, 448), UPRIGHT),
    ),
)


def lay_pairs(content: Path, before: Path, studies: Path | None, out: Path) -> None:
    """Writes pairs of `VIEWS` of the hall of `content` to `out`, and their key beside it. before: the checkout of an
    earlier hall; studies: the folder of the studies' pictures."""
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        ours = _pictures(content, Path(work) / "ours", None)
        theirs = _pictures(before / "assets", Path(work) / "before", before)
        found = list(_pairs(ours, theirs, studies))
        random = np.random.default_rng()
        key = []
        for number, k in enumerate(random.permutation(len(found)), 1):
            view, against, own, other = found[k]
            left = bool(random.integers(2))
            pair = _side_by_side(own, other) if left else _side_by_side(other, own)
            pair.save(out / f"pair-{number:02}.jpg", quality=88)
            key.append(
                {"pair": number, "view": view.name, "against": against, "ours": "left" if left else "right"}
            )
    _key_of(out).write_text(json.dumps(key, indent=1) + "\n", "utf-8")
    print(f"{len(key)} pairs in {out}, their key in {_key_of(out)}")


def _pairs(
    ours: dict[str, Image.Image], theirs: dict[str, Image.Image], studies: Path | None
) -> Iterator[tuple[View, str, Image.Image, Image.Image]]:
    """View, what it is against, our picture and the other one."""
    for view in VIEWS:
        yield view, "before", ours[view.name], theirs[view.name]
        if view.study is not None and studies is not None:
            study = Image.open(studies / view.study.file).convert("RGB").crop(view.study.part)
            yield view, "study", ours[view.name].crop(view.study.ours), study


def _side_by_side(left: Image.Image, right: Image.Image) -> Image.Image:
    """Both as tall as a pair and as wide as the narrower of them, cut alike on both sides."""
    scaled = [
        one.resize((round(one.width * HEIGHT / one.height), HEIGHT), Image.Resampling.LANCZOS)
        for one in (left, right)
    ]
    width = min(one.width for one in scaled)
    pair = Image.new("RGB", (2 * width + GAP, HEIGHT), GROUND)
    for k, one in enumerate(scaled):
        inset = (one.width - width) // 2
        pair.paste(one.crop((inset, 0, inset + width, HEIGHT)), (k * (width + GAP), 0))
    return pair


def _pictures(content: Path, work: Path, checkout: Path | None) -> dict[str, Image.Image]:
    """View -> its picture in the hall of `content`; checkout: the code of another hall than this one."""
    work.mkdir(parents=True)
    env = None if checkout is None else {"PYTHONPATH": str(checkout.resolve())}
    program = (sys.executable, "-P", "-m", "hall_app")  # not of the folder this is run in
    found: dict[str, Image.Image] = {}
    with running_hall(content, work, env=env, program=program) as served, open_browser() as browser:
        page = browser.new_context(viewport=DESK).new_page()
        enter(page, f"{served.url}/?lang=zh", quality="high")
        page.wait_for_timeout(8000)  # what is far comes while one walks
        stands = page.evaluate(STANDS)
        for view in VIEWS:
            exhibit = view.exhibit if checkout is None or view.before is None else view.before
            if view.close:
                _look_closely(page, exhibit, view)
            elif exhibit:
                page.evaluate("(there) => hall.goTo(...there)", stands[exhibit])
            page.wait_for_timeout(4000)
            at_rest(page)
            bare = page.add_style_tag(content=BARE)
            file = work / f"{len(found)}.png"
            page.screenshot(path=file)
            bare.evaluate("(style) => style.remove()")
            found[view.name] = Image.open(file).convert("RGB")
            print(f"{content}: {view.name}", file=sys.stderr, flush=True)
            if view.close:
                page.keyboard.press("Escape")
                page.wait_for_timeout(1500)
    return found


def _look_closely(page, exhibit: str, view: View) -> None:
    open_exhibit(page, exhibit)
    page.mouse.move(560, 200)
    for _ in range(view.near):
        page.mouse.wheel(0, -120)
        page.wait_for_timeout(60)
    if view.turn:  # a drag as long as the picture is high is one whole turn
        page.mouse.down()
        page.mouse.move(560 - DESK["height"] * view.turn / 360, 200, steps=12)
        page.mouse.up()


def _key_of(folder: Path) -> Path:
    return folder.with_name(folder.name + "-key.json")


def tally(folder: Path) -> str:
    """What the readers chose, as a table: pair by pair, and how often ours was chosen.

    Raises ValueError where a choice names no pair or no side.
    """
    key = {one["pair"]: one for one in json.loads(_key_of(folder).read_text("utf-8"))}
    readings = {file: json.loads(file.read_text("utf-8")) for file in sorted(folder.glob("choices-*.json"))}
    lines = ["| reader | pair | view | against | ours chosen | why |", "|-|-|-|-|-|-|"]
    ends: list[str] = []
    for file, choices in readings.items():
        reader = file.stem.removeprefix("choices-")
        won: dict[str, list[bool]] = {}
        for choice in choices:
            if choice["pair"] not in key or choice["side"] not in ("left", "right"):
                raise ValueError(f'{file}: {choice} – name a pair of the key and "left" or "right"')
            one = key[choice["pair"]]
            ours = one["ours"] == choice["side"]
            won.setdefault(one["against"], []).append(ours)
            why = choice["why"].replace("|", "/").replace("\n", " ")
            row = (reader, one["pair"], one["view"], one["against"], "yes" if ours else "**no**", why)
            lines.append("| " + " | ".join(map(str, row)) + " |")
        ends += [
            f"{reader}: ours in {sum(those)} of {len(those)} against {name}" for name, those in won.items()
        ]
    return "\n".join([*lines, "", *ends])
