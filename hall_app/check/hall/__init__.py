"""How it stands in the hall: ways to the exhibits, cloth behind them, fittings, the baked room, questionnaires."""

from hall_app.check.hall.backdrops import backdrop_problems
from hall_app.check.hall.fittings import fitting_problems
from hall_app.check.hall.questionnaires import questionnaire_problems, unstated
from hall_app.check.hall.reach import reach_problems
from hall_app.check.hall.room import room_problems

__all__ = [
    "backdrop_problems",
    "fitting_problems",
    "questionnaire_problems",
    "reach_problems",
    "room_problems",
    "unstated",
]
