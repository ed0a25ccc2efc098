"""How many answers a study needs: formulas for means, differences, correlations, α and fit, simulation for factors."""

from survey.analysis.planning.factors import Recovery, factor_recovery
from survey.analysis.planning.fit import fit_answers, fit_power
from survey.analysis.planning.sizes import (
    correlation_answers,
    correlation_margin_answers,
    difference_answers,
    difference_power,
    mean_answers,
    mean_margin,
    reliability_answers,
    reliability_width_answers,
)

__all__ = [
    "Recovery",
    "correlation_answers",
    "correlation_margin_answers",
    "difference_answers",
    "difference_power",
    "factor_recovery",
    "fit_answers",
    "fit_power",
    "mean_answers",
    "mean_margin",
    "reliability_answers",
    "reliability_width_answers",
]
