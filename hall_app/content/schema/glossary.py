"""Schema of glossary.toml: words of the craft, explained."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from hall_app.content.schema.values import Bilingual, Table, Text

Group = Literal["cloth", "making", "garment", "part", "wearing", "hall"]
Key = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=40)]


class Word(Table):
    """A word in both languages, and what it means in a sentence or two."""

    id: Key = Field(description="short name, as texts write it: [罗](word:luo)")
    zh: Text = Field(description="the word in Chinese")
    pinyin: Text = Field(description="how it is spoken, in pinyin with tones")
    en: Text = Field(description="the word in English")
    group: Group = Field(description="cloth, making, garment, part, wearing or hall")
    short: Bilingual = Field(description="what it means, in a sentence or two")
    see: tuple[Key, ...] = Field((), description="words to compare, by their ids")
    weaves: tuple[Text, ...] = Field((), description="weaves that show it, by their files' names")
    exhibits: tuple[Text, ...] = Field((), description="exhibits that show it, by their folders' names")


class GlossaryFile(Table):
    """glossary.toml."""

    word: tuple[Word, ...] = Field((), description="the words, one [[word]] each")

    @model_validator(mode="after")
    def _each_once(self) -> GlossaryFile:
        seen: set[str] = set()
        for word in self.word:
            if word.id in seen:
                raise PydanticCustomError("word_twice", "there are two words {id}", {"id": word.id})
            seen.add(word.id)
        return self
