"""The recipes `hall build` knows, by the name an exhibit gives."""

from __future__ import annotations

from collections.abc import Callable

from hall_app.build.recipes.pibo import PiboOnFigure
from hall_app.build.recipes.recipe import Inputs, Recipe
from hall_app.build.recipes.robe import RobeOnFigure
from hall_app.build.recipes.scarf import ScarfOnStand

__all__ = ["RECIPES"]

RECIPES: dict[str, Callable[[Inputs], Recipe]] = {
    "scarf_on_stand": ScarfOnStand,
    "robe_on_figure": RobeOnFigure,
    "pibo_on_figure": PiboOnFigure,
}
