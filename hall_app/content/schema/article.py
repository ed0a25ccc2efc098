"""Schema of articles/<id>/article.toml."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from hall_app.content.schema.values import Bilingual, ContentPath, Table, Text

Standing = Literal["museum", "secondary", "recalled", "own", "choice"]


def web_address(url: str) -> str:
    """The address, where it is one of the web."""
    if not url.startswith(("https://", "http://")) or any(letter.isspace() for letter in url):
        raise PydanticCustomError("web_address", "the address does not begin with https:// or http://")
    return url


class Source(Table):
    """What an article rests on, and how far it was looked into."""

    text: Bilingual = Field(description="author, title, place and what was taken from it")
    standing: Standing = Field(
        description="museum (a museum's page, or several that agree), secondary, recalled (not read again), own "
        "(computed here), choice (an assumption of ours)"
    )
    url: Annotated[str, AfterValidator(web_address)] | None = Field(
        None, description="its address, https://…"
    )


class ArticleFile(Table):
    """article.toml."""

    title: Bilingual = Field(description="title")
    summary: Bilingual = Field(description="what it tells, in a sentence or two")
    order: int = Field(100, ge=0, le=10_000, description="place in the list: smaller ones come first")
    picture: ContentPath | None = Field(
        None, description="picture for lists: media/… of its own, or exhibits/…, weaves/… of the hall"
    )
    exhibits: tuple[Text, ...] = Field((), description="exhibits it speaks of, by their folders' names")
    weaves: tuple[Text, ...] = Field((), description="weaves it speaks of, by their files' names")
    articles: tuple[Text, ...] = Field((), description="articles to read on, by their folders' names")
    source: tuple[Source, ...] = Field(min_length=1, description="what it rests on, one [[source]] each")
    written: datetime.date = Field(description="when it was written or last revised, e.g. 2026-11-27")
    licence: Text = Field(description="licence of texts and pictures, e.g. CC0-1.0")
