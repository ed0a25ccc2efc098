"""The statistics of a questionnaire: arrays in, arrays out. README.md holds the formulas and their sources."""

from survey.analysis.adequacy import Adequacy, Bartlett, adequacy, adequacy_by_factor_analyzer, adequacy_of
from survey.analysis.bootstrap import Bootstrap, bootstrap
from survey.analysis.components import Components, principal_components
from survey.analysis.correlation import Correlation, correlate, correlate_pairwise, stars
from survey.analysis.errors import (
    AllEqual,
    AnalysisError,
    ConstantItem,
    CrossCheckFailed,
    DependentItems,
    GapsLeft,
    LoneItem,
    NoComponents,
    NotAMean,
    NotConverged,
    NotFinite,
    NotPositiveDefinite,
    TooFewItems,
    TooFewRows,
    TooManyScores,
    UnknownItem,
    WrongShape,
)
from survey.analysis.flags import duplicates, hasty, straight_liners
from survey.analysis.grim import grim, least_n
from survey.analysis.oblimin import oblimin
from survey.analysis.omega import Omega, omega_of
from survey.analysis.pipeline import Analysis, Settings, analyse
from survey.analysis.polychoric import polychoric
from survey.analysis.reliability import Reliability, reliability, reliability_of
from survey.analysis.retention import Average, Parallel, minimum_average_partial, parallel_analysis
from survey.analysis.scales import Group, Scale
from survey.analysis.summary import summary
from survey.analysis.varimax import varimax

__all__ = [
    "Adequacy",
    "AllEqual",
    "Analysis",
    "AnalysisError",
    "Average",
    "Bartlett",
    "Bootstrap",
    "Components",
    "ConstantItem",
    "Correlation",
    "CrossCheckFailed",
    "DependentItems",
    "GapsLeft",
    "Group",
    "LoneItem",
    "NoComponents",
    "NotAMean",
    "NotConverged",
    "NotFinite",
    "NotPositiveDefinite",
    "Omega",
    "Parallel",
    "Reliability",
    "Scale",
    "Settings",
    "TooFewItems",
    "TooFewRows",
    "TooManyScores",
    "UnknownItem",
    "WrongShape",
    "adequacy",
    "adequacy_by_factor_analyzer",
    "adequacy_of",
    "analyse",
    "bootstrap",
    "correlate",
    "correlate_pairwise",
    "duplicates",
    "grim",
    "hasty",
    "least_n",
    "minimum_average_partial",
    "oblimin",
    "omega_of",
    "parallel_analysis",
    "polychoric",
    "principal_components",
    "reliability",
    "reliability_of",
    "stars",
    "straight_liners",
    "summary",
    "varimax",
]
