"""Confirmatory factor analysis: a measurement model against the answers. README.md has the formulas."""

from survey.analysis.confirmatory.confirmation import Confirmation, Parameter
from survey.analysis.confirmatory.estimation import Estimator, Gaps, confirm
from survey.analysis.confirmatory.fit_indices import Fit
from survey.analysis.confirmatory.measurement_model import Measurement, explored, parsed
from survey.analysis.confirmatory.summary import confirmation_summary
from survey.analysis.correlation.missing_data import Saturated, saturated

__all__ = [
    "Confirmation",
    "Estimator",
    "Fit",
    "Gaps",
    "Measurement",
    "Parameter",
    "Saturated",
    "confirm",
    "confirmation_summary",
    "explored",
    "parsed",
    "saturated",
]
