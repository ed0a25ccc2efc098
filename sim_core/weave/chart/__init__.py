"""Pictures of drafts for weavers: threading, tie-up, treadling, drawdown; colour-and-weave; peg plans and cards."""

from sim_core.weave.chart.cards import write_cards, write_pegs
from sim_core.weave.chart.layout import chart_of
from sim_core.weave.chart.paper import PAPERS
from sim_core.weave.chart.repeats import repeated
from sim_core.weave.chart.sheets import write_draft
from sim_core.weave.chart.values import Chart, View, Window

__all__ = [
    "PAPERS",
    "Chart",
    "View",
    "Window",
    "chart_of",
    "repeated",
    "write_cards",
    "write_draft",
    "write_pegs",
]
