"""Principal components.

Whether a matrix may be factored (`sampling_adequacy`), how many components to keep (`retention`), their `extraction`
and rotation, and intervals by `resampling`.
"""

from survey.analysis.components.extraction import (
    Components,
    Rotation,
    eigenvalues,
    homes,
    kaiser_count,
    principal_components,
    proposed_modules,
)
from survey.analysis.components.oblique_rotation import oblimin, quartimin_criterion
from survey.analysis.components.orthogonal_rotation import (
    STARTS,
    row_lengths,
    starts,
    varimax,
    varimax_criterion,
)
from survey.analysis.components.resampling import Bootstrap, bootstrap
from survey.analysis.components.retention import (
    Average,
    Parallel,
    minimum_average_partial,
    parallel_analysis,
    random_correlations,
)
from survey.analysis.components.sampling_adequacy import (
    Adequacy,
    Bartlett,
    adequacy,
    adequacy_by_factor_analyzer,
    adequacy_of,
)

__all__ = [
    "STARTS",
    "Adequacy",
    "Average",
    "Bartlett",
    "Bootstrap",
    "Components",
    "Parallel",
    "Rotation",
    "adequacy",
    "adequacy_by_factor_analyzer",
    "adequacy_of",
    "bootstrap",
    "eigenvalues",
    "homes",
    "kaiser_count",
    "minimum_average_partial",
    "oblimin",
    "parallel_analysis",
    "principal_components",
    "proposed_modules",
    "quartimin_criterion",
    "random_correlations",
    "row_lengths",
    "starts",
    "varimax",
    "varimax_criterion",
]
