"""The schemas of a content folder in one place: hall.toml, plan.toml, exhibit.toml."""

from .exhibit_file import Body, ExhibitFile, GarmentRecipe, Media, Models, Place, Record
from .hall_file import Eye, HallFile, Start
from .plan_file import Bay, Opening, PlanFile, Round, Solid, Wall
from .values import Bilingual, Table

__all__ = [
    "Bay",
    "Bilingual",
    "Body",
    "ExhibitFile",
    "Eye",
    "GarmentRecipe",
    "HallFile",
    "Media",
    "Models",
    "Opening",
    "Place",
    "PlanFile",
    "Record",
    "Round",
    "Solid",
    "Start",
    "Table",
    "Wall",
]
