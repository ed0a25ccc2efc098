"""Commands of research: planning a study, analysing answers, testing stated factors, comparing groups.

`sources` says where their scores come from, `progress` what is shown meanwhile.
"""

from survey.commands.research import analyse, compare, confirm, grim, plan

__all__ = ["analyse", "compare", "confirm", "grim", "plan"]
