"""The schemas of a content folder in one place: hall.toml, plan.toml, exhibit.toml."""

from hall_app.content.exhibit_file import Body, ExhibitFile, GarmentRecipe, Media, Models, Place, Record
from hall_app.content.hall_file import Eye, HallFile, Start
from hall_app.content.plan_file import (
    Bay,
    Curtain,
    Lantern,
    Laylight,
    Opening,
    PlanFile,
    Round,
    Sign,
    Solid,
    Wall,
)
from hall_app.content.values import Bilingual, Table

__all__ = [
    "Bay",
    "Bilingual",
    "Body",
    "Curtain",
    "ExhibitFile",
    "Eye",
    "GarmentRecipe",
    "HallFile",
    "Lantern",
    "Laylight",
    "Media",
    "Models",
    "Opening",
    "Place",
    "PlanFile",
    "Record",
    "Round",
    "Sign",
    "Solid",
    "Start",
    "Table",
    "Wall",
]
