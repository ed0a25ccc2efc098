"""What is seen to before anything is computed.

`preparation` sorts out rows and items with a note for everything left out, `careless` answers and scores off the
`scale_range` are named, and `reverse_keying` turns what is worded the other way round.
"""

from survey.analysis.screening.careless import duplicates, hasty, straight_liners
from survey.analysis.screening.preparation import (
    Flags,
    Note,
    Prepared,
    asking,
    flagged,
    left_out,
    likely_gaps,
    named,
    prepare,
)
from survey.analysis.screening.reverse_keying import Turned, turned, turned_table
from survey.analysis.screening.scale_range import off_scale

__all__ = [
    "Flags",
    "Note",
    "Prepared",
    "Turned",
    "asking",
    "duplicates",
    "flagged",
    "hasty",
    "left_out",
    "likely_gaps",
    "named",
    "off_scale",
    "prepare",
    "straight_liners",
    "turned",
    "turned_table",
]
