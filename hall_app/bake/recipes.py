"""The recipes `hall build` knows, by the name an exhibit gives."""

from __future__ import annotations

from collections.abc import Callable

from hall_app.bake.pibo_recipe import PiboOnFigure
from hall_app.bake.recipe import Inputs, Recipe
from hall_app.bake.robe_recipe import RobeOnFigure
from hall_app.bake.scarf_recipe import ScarfOnStand

__all__ = ["RECIPES"]

RECIPES: dict[str, Callable[[Inputs], Recipe]] = {
    "scarf_on_stand": ScarfOnStand,
    "robe_on_figure": RobeOnFigure,
    "pibo_on_figure": PiboOnFigure,
}
