"""Schemas of research/numbers.json, which a program writes, and of research/papers.toml, which curators write."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from hall_app.content.schema.article import web_address
from hall_app.content.schema.values import Bilingual, ContentPath, Table, Text


class Figure(Table):
    """One measured thing."""

    what: Bilingual = Field(description="what was measured")
    value: Bilingual = Field(description="the figure with its unit")


class Line(Table):
    """One line of the full table, as the project's README has it, in English."""

    what: Text = Field(description="what was measured")
    value: Text = Field(description="the figure with its unit")
    command: Text = Field(description="the command that measures it")


class Part(Table):
    """A table of a README, or words between two."""

    text: str = Field("", description="words")
    head: tuple[str, ...] = Field((), description="the table's columns")
    row: tuple[tuple[str, ...], ...] = Field((), description="its rows, a cell a column")


class Sheet(Table):
    """What a room's README publishes, in English."""

    file: Text = Field(description="the README")
    command: Text = Field(description="the command that measures it")
    part: tuple[Part, ...] = Field(min_length=1, description="tables and words, in their order")


class Measured(Table):
    """What one bench measured: figures, how, where, when, the data and a plot."""

    id: Text = Field(description="short name")
    title: Bilingual = Field(description="what it is about")
    about: Bilingual = Field(description="what is measured against what, in a sentence or two")
    command: tuple[Text, ...] = Field(min_length=1, description="commands that measure it again")
    machine: Bilingual = Field(description="the machine it was measured on")
    date: datetime.date = Field(description="when it was measured, or published")
    since: datetime.date | None = Field(None, description="when the first of it was measured")
    dated: Literal["measured", "published"] = Field(
        "published", description="what the date is of: data that do not tell their day are dated by this page"
    )
    figure: tuple[Figure, ...] = Field(min_length=1, description="the figures that matter most")
    line: tuple[Line, ...] = Field((), description="its rows of the project's README")
    sheet: tuple[Sheet, ...] = Field((), description="its tables of the rooms' READMEs")
    data: tuple[ContentPath, ...] = Field((), description="the bench's own files, in research/data")
    plot: ContentPath | None = Field(None, description="a drawing in research/plots")
    plot_alt: Bilingual | None = Field(None, description="what the drawing shows, in words")


class NumbersFile(Table):
    """research/numbers.json."""

    section: tuple[Measured, ...] = Field((), description="the benches")


class Citation(Table):
    """What a reference manager keeps of an article in a journal."""

    author: Annotated[tuple[Text, ...], Field(min_length=1)] = Field(
        description="authors, each `Family, Given`"
    )
    title: Text = Field(description="the title as printed")
    journal: Text = Field(description="the journal")
    year: Annotated[int, Field(ge=1600, le=2200)] = Field(description="year")
    volume: Text | None = Field(None, description="volume")
    number: Text | None = Field(None, description="issue")
    pages: Text | None = Field(None, description="pages, or the article's number")
    doi: Annotated[str, Field(pattern=r"^10\.\d{4,9}/[^\s{}]+$")] | None = Field(
        None, description="its DOI, 10.…/…"
    )


class Paper(Table):
    """A publication to read, by its address or as a file; or one that is named alone."""

    title: Bilingual = Field(description="title")
    where: Bilingual = Field(description="authors or journal, year")
    about: Bilingual = Field(description="what it has to do with this hall")
    url: Annotated[str, AfterValidator(web_address)] | None = Field(
        None, description="its address, https://…"
    )
    file: ContentPath | None = Field(None, description="or a .pdf in research/papers, to download")
    cite: Citation | None = Field(None, description="what /research/papers.bib tells of it")

    @model_validator(mode="after")
    def _one_place(self) -> Paper:
        if self.url is not None and self.file is not None:
            raise PydanticCustomError("one_place", "give url or file, not both")
        return self


class PapersFile(Table):
    """research/papers.toml."""

    paper: tuple[Paper, ...] = Field((), description="publications, one [[paper]] each")
