"""The statistics of a questionnaire: arrays in, arrays out. README.md holds the formulas and their sources."""

from survey.analysis.adequacy import Adequacy, Bartlett, adequacy, adequacy_by_formula
from survey.analysis.components import Components, principal_components
from survey.analysis.correlation import Correlation, correlate, stars
from survey.analysis.errors import (
    AllEqual,
    AnalysisError,
    ConstantItem,
    DependentItems,
    NotFinite,
    TooFewRows,
)
from survey.analysis.pipeline import Analysis, analyse
from survey.analysis.reliability import Reliability, reliability
from survey.analysis.varimax import varimax

__all__ = [
    "Adequacy",
    "AllEqual",
    "Analysis",
    "AnalysisError",
    "Bartlett",
    "Components",
    "ConstantItem",
    "Correlation",
    "DependentItems",
    "NotFinite",
    "Reliability",
    "TooFewRows",
    "adequacy",
    "adequacy_by_formula",
    "analyse",
    "correlate",
    "principal_components",
    "reliability",
    "stars",
    "varimax",
]
