"""Confirmatory factor analysis: a measurement model against the answers. survey/README.md has the formulas.

A `measurement_model` implies a `covariance_structure`; `maximum_likelihood` and `weighted_least_squares` (of what
`thresholds` tell) fit it by `fisher_scoring` and are judged by `fit_indices` and `modification_indices`.
`estimation` is the way in, a `Confirmation` what comes out, and `summary` tells it.
"""

from survey.analysis.confirmatory.confirmation import Confirmation, Parameter
from survey.analysis.confirmatory.estimation import Estimator, Gaps, confirm
from survey.analysis.confirmatory.fit_indices import Fit
from survey.analysis.confirmatory.measurement_model import Measurement, explored, parsed
from survey.analysis.confirmatory.summary import confirmation_printed, confirmation_summary
from survey.analysis.confirmatory.thresholds import Polychorics
from survey.analysis.confirmatory.weighted_least_squares import weighted_of

__all__ = [
    "Confirmation",
    "Estimator",
    "Fit",
    "Gaps",
    "Measurement",
    "Parameter",
    "Polychorics",
    "confirm",
    "confirmation_printed",
    "confirmation_summary",
    "explored",
    "parsed",
    "weighted_of",
]
