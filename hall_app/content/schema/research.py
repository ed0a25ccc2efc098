"""Schemas of research/numbers.json, which a program writes, and of research/papers.toml, which curators write."""

from __future__ import annotations

import datetime
from typing import Annotated

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


class Measured(Table):
    """What one bench measured: figures, how, where, when, the data and a plot."""

    id: Text = Field(description="short name")
    title: Bilingual = Field(description="what it is about")
    about: Bilingual = Field(description="what is measured against what, in a sentence or two")
    command: tuple[Text, ...] = Field(min_length=1, description="commands that measure it again")
    machine: Bilingual = Field(description="the machine it was measured on")
    date: datetime.date = Field(description="when it was measured")
    figure: tuple[Figure, ...] = Field(min_length=1, description="the figures that matter most")
    line: tuple[Line, ...] = Field((), description="all figures that are published of it")
    data: tuple[ContentPath, ...] = Field((), description="the bench's own files, in research/data")
    plot: ContentPath | None = Field(None, description="a drawing in research/plots")
    plot_alt: Bilingual | None = Field(None, description="what the drawing shows, in words")


class NumbersFile(Table):
    """research/numbers.json."""

    section: tuple[Measured, ...] = Field((), description="the benches")


class Paper(Table):
    """A publication to read, by its address or as a file."""

    title: Bilingual = Field(description="title")
    where: Bilingual = Field(description="authors or journal, year")
    about: Bilingual = Field(description="what it has to do with this hall")
    url: Annotated[str, AfterValidator(web_address)] | None = Field(
        None, description="its address, https://…"
    )
    file: ContentPath | None = Field(None, description="or a .pdf in research/papers, to download")

    @model_validator(mode="after")
    def _one_place(self) -> Paper:
        if (self.url is None) == (self.file is None):
            raise PydanticCustomError("one_place", "needs either url or file")
        return self


class PapersFile(Table):
    """research/papers.toml."""

    paper: tuple[Paper, ...] = Field((), description="publications, one [[paper]] each")
