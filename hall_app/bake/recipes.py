"""The recipes `hall build` knows, by the name an exhibit gives."""

from __future__ import annotations

from collections.abc import Callable

from .pibo_recipe import PiboOnFigure
from .recipe import Inputs, Recipe
from .robe_recipe import RobeOnFigure
from .scarf_recipe import ScarfOnStand

__all__ = ["RECIPES"]

RECIPES: dict[str, Callable[[Inputs], Recipe]] = {
    "scarf_on_stand": ScarfOnStand,
    "robe_on_figure": RobeOnFigure,
    "pibo_on_figure": PiboOnFigure,
}
