"""The report's figures as SVG: how every one is drawn (`svg`), then one module a kind of figure."""

from survey.report.figures.correlation_matrix import correlations
from survey.report.figures.flow_chart import flow
from survey.report.figures.forest_plot import intervals
from survey.report.figures.plots import lines, loadings, scatter_matrix, scree

__all__ = ["correlations", "flow", "intervals", "lines", "loadings", "scatter_matrix", "scree"]
