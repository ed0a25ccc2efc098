"""How it stands in the hall: ways to the exhibits, cloth behind them, fittings, the baked room, questionnaires."""

from hall_app.check.hall.fittings import fitting_problems

__all__ = ["fitting_problems"]
