"""The statistics of a questionnaire: arrays in, arrays out. README.md holds the formulas and their sources."""

from survey.analysis.components.extraction import Components, principal_components
from survey.analysis.components.oblique_rotation import oblimin
from survey.analysis.components.orthogonal_rotation import varimax
from survey.analysis.components.resampling import Bootstrap, bootstrap
from survey.analysis.components.retention import Average, Parallel, minimum_average_partial, parallel_analysis
from survey.analysis.components.sampling_adequacy import (
    Adequacy,
    Bartlett,
    adequacy,
    adequacy_by_factor_analyzer,
    adequacy_of,
)
from survey.analysis.consistency.cronbach import Reliability, reliability, reliability_of
from survey.analysis.consistency.mcdonald import Omega, omega_of
from survey.analysis.correlation.ordinal import polychoric
from survey.analysis.correlation.pearson import Correlation, correlate, correlate_pairwise, stars
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
from survey.analysis.granularity import grim, least_n
from survey.analysis.procedure.json_summary import summary
from survey.analysis.procedure.pipeline import Analysis, Settings, analyse
from survey.analysis.procedure.scales import Group, Scale
from survey.analysis.screening.careless import duplicates, hasty, straight_liners

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
