"""The pictures of a draft beside each other, for the README.

python tests/bench/weave_charts.py docs/pictures/weave-drafts.jpg
"""

import sys
from pathlib import Path

from PIL import Image

from sim_core.weave.chart import View, chart_of, free_page, picture_of
from sim_core.weave.files import blocked_source, source_of

FOLDER = Path(__file__).parents[1] / "sim_core" / "drafts"
WIDE = 1500  # pixels of two pictures beside each other


def pictures() -> list[Image.Image]:
    """A draft with its long floats, in its colours, as a lift plan from the lower left, and a profile blocked out."""
    twill = source_of(str(FOLDER / "weaveit-32-shafts.wif"))
    profile = blocked_source(source_of("twill:1/3"), "summer-winter")
    drawn = (
        (twill, View(floats=3)),
        (twill, View(colour=True)),
        (source_of("satin:8/3"), View(plan=True, first="left")),
        (profile, View()),
    )
    made = []
    for source, view in drawn:
        chart = chart_of(source, view)
        cell = min(130 / max(chart.width, chart.height), 5.0)
        made.append(picture_of(chart, free_page(chart, cell), 20))
    return made


def main() -> None:
    made = [
        picture.resize((WIDE // 2, round(picture.height * WIDE / 2 / picture.width)))
        for picture in pictures()
    ]
    heights = [max(pair.height for pair in made[k : k + 2]) for k in (0, 2)]
    sheet = Image.new("RGB", (WIDE, sum(heights)), "white")
    for k, picture in enumerate(made):
        sheet.paste(picture, (k % 2 * WIDE // 2, heights[0] * (k // 2)))
    sheet.save(sys.argv[1], quality=88)


if __name__ == "__main__":
    main()
