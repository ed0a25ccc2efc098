"""Pictures of drafts for weavers: threading, tie-up, treadling, drawdown; colour-and-weave; peg plans and cards.

`values` holds a drawing, `layout` says what lies where in cells, with `floats` and `texts`; `paper` and `furniture`
put it on a page, which `svg` and `png` draw alike. `sheets` writes pages and parts, `cards` a pixel a crossing,
`repeats` weaves a draft several times, `command` holds the arguments of `simcore weave` that ask for all this.
"""

from sim_core.weave.chart.cards import write_cards, write_pegs
from sim_core.weave.chart.layout import chart_of
from sim_core.weave.chart.paper import PAPERS, free_page
from sim_core.weave.chart.png import picture_of
from sim_core.weave.chart.repeats import repeated
from sim_core.weave.chart.sheets import windows, write_draft
from sim_core.weave.chart.values import Chart, View, Window

__all__ = [
    "PAPERS",
    "Chart",
    "View",
    "Window",
    "chart_of",
    "free_page",
    "picture_of",
    "repeated",
    "windows",
    "write_cards",
    "write_draft",
    "write_pegs",
]
