"""Light on the dress: how every exhibit stands out from what is behind it, as a visitor before it sees it.

    python tests/bench/bench_lit.py [--only ID …] [--json FILE] [--pictures FOLDER]

The hall is seen from where the map leads to, 1280 x 720, without what the page lays over it, once with the exhibit and
once without: its pixels are those that differ. Luminance is relative (WCAG 2), of the pixels as they are shown.

exhibit   mean over its pixels
behind    mean over the same pixels without it
contrast  the greater of both by the lesser; asked: 1.5
tenth     what its brightest tenth begins at
brighter  share of the rest of the frame that is brighter than that, and of this what is no lamp and no window
--pictures writes each view with these last pixels in red.
"""

from __future__ import annotations

import argparse
import io
import json
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT))

from bench.browser import at_rest, enter, open_browser  # noqa: E402
from bench.picture_pairs import BARE, DESK, STANDS  # noqa: E402
from bench.readable import luminance  # noqa: E402
from running_hall import running_hall  # noqa: E402

ASKED = 1.5
DIFFERS = 6  # of 255, in any colour
LAMP = 0.9  # luminance from which on a pixel is of a lamp or a window
SHOW = """
([key, shown]) => {
  window.__viserMutable.nodeRefFromName[`/exhibits/${key}`]
    .traverse((one) => { one.layers[shown ? "set" : "disableAll"](0); });
}
"""


def picture(page, there: list[float]) -> np.ndarray:
    """The frame as it is shown from that stand, once the hall has drawn it anew: one looks aside and back."""
    x, z, yaw, pitch = there
    for turned in (0.02, 0.0):
        page.evaluate("(there) => hall.goTo(...there)", [x, z, yaw + turned, pitch])
        page.wait_for_timeout(700)
    at_rest(page)
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"))


def measured(shown: np.ndarray, hidden: np.ndarray) -> tuple[dict[str, float], np.ndarray]:
    """The figures of one view, and which pixels of the rest are brighter than the exhibit's brightest tenth."""
    own = (np.abs(shown.astype(int) - hidden) > DIFFERS).any(axis=2)
    light, behind = luminance(shown), luminance(hidden)
    exhibit, backdrop = float(light[own].mean()), float(behind[own].mean())
    tenth = float(np.quantile(light[own], 0.9))
    brighter = ~own & (light > tenth)
    told = {
        "pixels": int(own.sum()),
        "exhibit": exhibit,
        "behind": backdrop,
        "contrast": max(exhibit, backdrop) / max(min(exhibit, backdrop), 1e-4),
        "tenth": tenth,
        "brighter": float(brighter.sum() / (~own).sum()),
        "no_lamp": float((brighter & (light < LAMP)).sum() / (~own).sum()),
    }
    return told, brighter


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--content", type=Path, default=ROOT / "assets")
    parser.add_argument("--only", nargs="*", default=(), metavar="ID", help="these exhibits")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--pictures", type=Path, metavar="FOLDER")
    arguments = parser.parse_args()
    rows: dict[str, dict[str, float]] = {}
    with (
        tempfile.TemporaryDirectory() as work,
        running_hall(arguments.content, Path(work)) as served,
        open_browser() as browser,
    ):
        page = browser.new_context(viewport=DESK).new_page()
        enter(page, f"{served.url}/?lang=zh", quality="high")
        page.wait_for_timeout(6000)  # what is far comes while one walks
        stands = page.evaluate(STANDS)
        page.add_style_tag(content=BARE)
        print(
            f"{'':<16}{'exhibit':>9}{'behind':>9}{'contrast':>10}{'tenth':>8}{'brighter':>10}{'no lamp':>9}"
        )
        for key, there in stands.items():
            if arguments.only and key not in arguments.only:
                continue
            page.evaluate("(there) => hall.goTo(...there)", there)
            page.wait_for_timeout(2500)
            shown = picture(page, there)
            page.evaluate(SHOW, [key, False])
            hidden = picture(page, there)
            page.evaluate(SHOW, [key, True])
            if (shown == hidden).all():
                raise SystemExit(
                    f"{key}: the hall went on drawing it – its node is another than /exhibits/{key}"
                )
            row, brighter = measured(shown, hidden)
            rows[key] = row
            print(
                f"{key:<16}{row['exhibit']:>9.3f}{row['behind']:>9.3f}{row['contrast']:>10.2f}{row['tenth']:>8.2f}"
                f"{row['brighter']:>9.1%}{row['no_lamp']:>9.1%}{'' if row['contrast'] >= ASKED else '  too alike'}",
                flush=True,
            )
            if arguments.pictures:
                arguments.pictures.mkdir(parents=True, exist_ok=True)
                marked = shown.copy()
                marked[brighter] = (220, 30, 30)
                both = np.concatenate([shown, marked], axis=1)
                Image.fromarray(both).resize((1280, 360)).save(
                    arguments.pictures / f"lit-{key}.jpg", quality=85
                )
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n", "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
