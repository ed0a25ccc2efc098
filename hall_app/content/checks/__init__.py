"""What `hall check` looks at beyond loading: each function takes the content and returns problems."""

from collections.abc import Callable

from hall_app.content.checks.backdrops import backdrop_problems
from hall_app.content.checks.bakes import bake_problems
from hall_app.content.checks.budget import budget_problems
from hall_app.content.checks.figures import figure_problems
from hall_app.content.checks.fittings import fitting_problems
from hall_app.content.checks.media import media_problems
from hall_app.content.checks.questionnaires import questionnaire_problems
from hall_app.content.checks.reach import reach_problems
from hall_app.content.checks.rooms import room_problems
from hall_app.content.checks.scale import scale_problems
from hall_app.content.checks.unused import unused_problems
from hall_app.content.checks.words import word_problems
from hall_app.content.folder import Content
from hall_app.content.problems import Problem

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
