"""The paper's procedure, from scores to one `Analysis`.

`factoring` of the items that are kept, reliability by `scales`, the `pipeline` of it all, and what it found as JSON or
text (`json_summary`, `text_summary`). `profiles` are the means by module and dimension of III.C.
"""

from survey.analysis.procedure.factoring import Settings
from survey.analysis.procedure.json_summary import KEYS, descriptives, summary
from survey.analysis.procedure.pipeline import Analysis, Context, analyse
from survey.analysis.procedure.profiles import Profile, profile
from survey.analysis.procedure.scales import Group, Scale
from survey.analysis.procedure.text_summary import printed

__all__ = [
    "KEYS",
    "Analysis",
    "Context",
    "Group",
    "Profile",
    "Scale",
    "Settings",
    "analyse",
    "descriptives",
    "printed",
    "profile",
    "summary",
]
