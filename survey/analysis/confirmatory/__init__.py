"""Confirmatory factor analysis: a measurement model against the answers. README.md has the formulas."""

from survey.analysis.confirmatory.confirmation import Confirmation, Parameter
from survey.analysis.confirmatory.door import Estimator, Gaps, confirm
from survey.analysis.confirmatory.gaps import Saturated, saturated
from survey.analysis.confirmatory.indices import Fit
from survey.analysis.confirmatory.measurement import Measurement, explored, parsed
from survey.analysis.confirmatory.summary import confirmation_summary

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
