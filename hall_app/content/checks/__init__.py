"""What `hall check` looks at beyond loading: each function takes the content and returns problems."""

from collections.abc import Callable

from ..folder import Content
from ..problems import Problem
from .backdrops import backdrop_problems
from .bakes import bake_problems
from .budget import budget_problems
from .figures import figure_problems
from .fittings import fitting_problems
from .media import media_problems
from .questionnaires import questionnaire_problems
from .reach import reach_problems
from .rooms import room_problems
from .scale import scale_problems
from .unused import unused_problems
from .words import word_problems

__all__ = ["CHECKS"]

CHECKS: tuple[Callable[[Content], list[Problem]], ...] = (
    word_problems,
    media_problems,
    scale_problems,
    budget_problems,
    reach_problems,
    backdrop_problems,
    bake_problems,
    figure_problems,
    questionnaire_problems,
    fitting_problems,
    room_problems,
    unused_problems,
)
