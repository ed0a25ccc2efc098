"""The pictures that hang in the rooms, drawn from what the hall itself shows: patterns, cloth, films, the mirror.

python tests/bench/hangings.py [--out assets/media/hangings] [--only NAME …]

Each is set by a browser on paper, its name beside it and the hall's seal below, as large as the room's sheet needs.
"""

from __future__ import annotations

import argparse
import base64
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT))

from bench.browser import open_browser  # noqa: E402

from sim_core.weave import Loom, Weave  # noqa: E402

ASSETS = ROOT / "assets"
EXHIBITS = ASSETS / "exhibits"
SIZE = (420, 828)  # [px], as the paper of a scroll of .8 by 1.7 m
PAPER, INK = "#efe6d2", "#15110f"
PAGE = """
<style>
* {{ margin: 0; box-sizing: border-box }}
body {{ width: {wide}px; height: {high}px; background: {paper}; position: relative; overflow: hidden }}
main {{ position: absolute; inset: 34px 74px 70px 30px; display: flex; flex-direction: column;
        align-items: center; justify-content: center; gap: 10px }}
main img {{ max-width: 100%; max-height: 100%; min-height: 0; mix-blend-mode: multiply }}
.pieces {{ width: 100%; max-height: 100% }}
.pieces path {{ stroke-width: 1.1px }}
h1 {{ position: absolute; right: 16px; top: 36px; writing-mode: vertical-rl; font: 700 38px/1 "Noto Serif CJK SC";
      letter-spacing: 8px; color: {ink} }}
i {{ position: absolute; right: 20px; bottom: 46px; width: 32px; height: 32px; background: #9e2b25; color: {paper};
     font: 700 22px/32px "Noto Serif CJK SC"; text-align: center }}
</style><body><h1>{title}</h1><main>{shown}</main><i>锦</i></body>
"""


@dataclass(frozen=True)
class Scroll:
    """The name that stands on it, and what is shown: pictures or drawings as SVG, one below the other."""

    title: str
    shown: Callable[[], Sequence[Image.Image | str]]


def _frames(
    exhibit: str, shares: tuple[float, ...], *, box: tuple[float, float, float, float]
) -> list[Image.Image]:
    """Pictures of an exhibit's film at shares of its time, cut to a box of shares, white where the studio is."""
    import av

    with av.open(str(EXHIBITS / exhibit / "baked/drape.mp4")) as film:
        frames = [frame.to_image() for frame in film.decode(video=0)]
    shown = []
    for share in shares:
        frame = frames[round(share * (len(frames) - 1))]
        left, top, right, bottom = box
        wide, high = frame.size
        place = (round(left * wide), round(top * high), round(right * wide), round(bottom * high))
        lit = np.asarray(frame.convert("RGB"), float)
        wall = np.median(
            lit[:, :12], axis=1, keepdims=True
        )  # of each row: nothing stands at the picture's left edge
        shown.append(Image.fromarray(np.clip(255 * lit / wall, 0, 255).astype(np.uint8)).crop(place))
    return shown


def _pieces(exhibit: str, high: float) -> str:
    """The pieces of an exhibit's pattern sheet without its words: so much of its height."""
    drawn = (EXHIBITS / exhibit / "media/pattern.svg").read_text("utf-8")
    (wide,) = re.findall(r'viewBox="0 0 ([\d.]+)', drawn)
    drawn = re.sub(
        r'width="[^"]*mm" height="[^"]*mm" viewBox="[^"]*"', f'viewBox="0 0 {wide} {high}"', drawn, count=1
    )
    drawn = re.sub(r"<(text|title)\b.*?</\1>", "", drawn, flags=re.S)
    drawn = re.sub(r'<rect width="100%" height="100%"[^>]*/>', "", drawn, count=1)
    return drawn.replace("<path ", '<path vector-effect="non-scaling-stroke" ').replace(
        "<svg ", '<svg class="pieces" ', 1
    )


def _cloth(name: str, tiles: tuple[int, int], *, pixels: int = 512, ground: int = 40) -> list[Image.Image]:
    """Repeats of a weave (down, across) over a dark ground, where it lets light through."""
    maps = Loom().maps(Weave.load(ASSETS / f"weaves/{name}.toml"), pixels)
    open_share = 1.0 - np.asarray(maps.opacity, float)[..., None] / 255.0
    seen = maps.albedo[..., :3] * (1 - open_share) + ground * open_share
    return [Image.fromarray(np.tile(seen.astype(np.uint8), (*tiles, 1)))]


def _yarns(name: str, share: float, *, high: int = 1200) -> list[Image.Image]:
    """So much of a repeat's width, twice as high, as under a lens."""
    (cloth,) = _cloth(name, (1, 1), pixels=1024)
    wide = round(share * cloth.width)
    return [cloth.crop((0, 0, wide, 2 * wide)).resize((high // 2, high), Image.Resampling.LANCZOS)]


def _point_paper(name: str, cells: tuple[int, int], side: int = 8) -> list[Image.Image]:
    """A draft as a designer sets it: the upper left of a repeat, (down, across) squares of its colours, and lines."""
    maps = Loom().maps(Weave.load(ASSETS / f"weaves/{name}.toml"), 512)
    picture = Image.fromarray(maps.albedo[..., :3])
    few = (
        picture.resize((cells[1], cells[0]), Image.Resampling.BOX)
        .quantize(6, dither=Image.Dither.NONE)
        .convert("RGB")
    )
    large = np.asarray(few.resize((cells[1] * side, cells[0] * side), Image.Resampling.NEAREST)).copy()
    for every, shade in ((side, 0.72), (8 * side, 0.25)):
        large[::every] = (large[::every] * shade).astype(np.uint8)
        large[:, ::every] = (large[:, ::every] * shade).astype(np.uint8)
    return [Image.fromarray(large)]


def _rubbing() -> list[Image.Image]:
    """The mirror's back as ink takes it from bronze: what stands out is dark."""
    with Image.open(EXHIBITS / "mirror/media/drawing.jpg") as drawing:
        face = drawing.convert("L").crop((160, 160, 840, 840))
    grain = np.random.default_rng(3).normal(0.0, 9.0, (face.height, face.width))
    y, x = np.mgrid[: face.height, : face.width] - face.height / 2 + 0.5
    inked = np.where(np.hypot(x, y) < 0.49 * face.height, 262 - np.asarray(face, float) + grain, 255.0)
    inked = np.where(np.hypot(x, y) < 0.49 * face.height, np.maximum(inked, 24), inked)
    return [Image.fromarray(np.clip(inked, 0, 255).astype(np.uint8)).convert("RGB")]


SCROLLS = {
    "fall": Scroll("轻纱垂落", lambda: _frames("pibo", (0.0, 0.07, 0.16, 0.6), box=(0.28, 0.06, 0.74, 0.66))),
    "dressing": Scroll(
        "着衣四式", lambda: _frames("beizi", (0.0, 0.18, 0.36, 0.62), box=(0.14, 0.08, 0.86, 0.93))
    ),
    "robe": Scroll("直裾裁片", lambda: [_pieces("zhiju", 3060)]),
    "skirt": Scroll("马面裁片", lambda: [_pieces("ming-mamian", 2620)]),
    "mirror": Scroll("连弧镜拓", _rubbing),
    "vine": Scroll("缠枝花锦", lambda: _cloth("edge-zhuanghua", (3, 2))),
    "clouds": Scroll("云气意匠", lambda: _point_paper("cloud-jin", (85, 44))),
    "luo": Scroll("罗之经纬", lambda: _yarns("luo", 0.3)),
}


def _embedded(shown: Image.Image | str) -> str:
    """What draws a picture that lies in the page itself."""
    if isinstance(shown, str):
        return shown
    stream = BytesIO()
    shown.save(stream, "PNG")
    return f'<img src="data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}">'


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=ASSETS / "media/hangings")
    parser.add_argument("--only", nargs="+", choices=SCROLLS, default=list(SCROLLS), metavar="NAME")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    wide, high = SIZE
    with open_browser() as browser:
        page = browser.new_page(viewport={"width": wide, "height": high})
        for name in given.only:
            scroll = SCROLLS[name]
            shown = "".join(map(_embedded, scroll.shown()))
            page.set_content(
                PAGE.format(wide=wide, high=high, paper=PAPER, ink=INK, title=scroll.title, shown=shown)
            )
            page.wait_for_load_state("networkidle")
            data = page.screenshot(type="png")
            with Image.open(BytesIO(data)) as picture:
                picture.convert("RGB").save(given.out / f"{name}.jpg", quality=82, optimize=True)
            print(f"{given.out / name}.jpg {(given.out / f'{name}.jpg').stat().st_size / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
