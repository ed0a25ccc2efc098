"""The schemas of a content folder: hall.toml, plan.toml, exhibit.toml, article.toml,
glossary.toml, papers.toml and numbers.json.

values: what their tables share; hall, plan, exhibit, article, glossary, research: their files; comparison: a table of
exhibit.toml; complaints: pydantic's words as a curator's.
"""

from hall_app.content.schema.article import ArticleFile, Source
from hall_app.content.schema.comparison import Comparison, Side
from hall_app.content.schema.complaints import key_name, schema_problems, table_of, toml_problem
from hall_app.content.schema.exhibit import Body, ExhibitFile, Media, Models, Place, Record, Scanned, Show
from hall_app.content.schema.glossary import GlossaryFile, Word
from hall_app.content.schema.hall import Eye, HallFile, Start
from hall_app.content.schema.plan import (
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
from hall_app.content.schema.research import Measured, NumbersFile, Paper, PapersFile
from hall_app.content.schema.values import Bilingual, Table

__all__ = [
    "ArticleFile",
    "GlossaryFile",
    "Source",
    "Word",
    "Measured",
    "NumbersFile",
    "Paper",
    "PapersFile",
    "Bay",
    "Bilingual",
    "Body",
    "Comparison",
    "Curtain",
    "ExhibitFile",
    "Eye",
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
    "Scanned",
    "Show",
    "Side",
    "Sign",
    "Solid",
    "Start",
    "Table",
    "Wall",
    "key_name",
    "schema_problems",
    "table_of",
    "toml_problem",
]
