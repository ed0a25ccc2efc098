"""Pictures of drafts for weavers: threading, tie-up, treadling, drawdown; colour-and-weave; peg plans and cards."""

from sim_core.weave.chart.cards import write_cards, write_pegs
from sim_core.weave.chart.layout import Chart, View, Window, chart_of
from sim_core.weave.chart.sheets import write_draft

__all__ = ["Chart", "View", "Window", "chart_of", "write_cards", "write_draft", "write_pegs"]
