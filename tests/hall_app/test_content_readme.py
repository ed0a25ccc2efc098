"""The curators' page names every key of the content files, and no key that does not exist."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from pydantic import BaseModel

from hall_app.content import BEHAVIOURS
from hall_app.content.schema import (
    ArticleFile,
    Bilingual,
    ExhibitFile,
    GlossaryFile,
    HallFile,
    PapersFile,
    PlanFile,
    table_of,
)
from survey.questionnaire import Text
from survey.web.privacy import Controller

ASSETS = Path(__file__).parents[2] / "assets"
README = (ASSETS / "README.md").read_text("utf-8")
FILES: dict[str, type[BaseModel]] = {
    "hall.toml": HallFile,
    "plan.toml": PlanFile,
    "exhibit.toml": ExhibitFile,
    "article.toml": ArticleFile,
    "glossary.toml": GlossaryFile,
    "papers.toml": PapersFile,
}
DOCUMENTED: dict[str, type[BaseModel]] = FILES | {"controller.toml": Controller}


def keys_of(model: type[BaseModel], before: str = "") -> Iterator[str]:
    for name, field in model.model_fields.items():
        key = f"{before}{field.alias or name}"
        inner = table_of(field.annotation)
        if inner in (None, Bilingual, Text):
            yield key
        else:
            yield from keys_of(inner, f"{key}.")


def documented(file: str) -> list[str]:
    section = README.split(f"\n## {file}\n")[1].split("\n## ")[0]
    rows = [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]
    return [key for row in rows for key in re.findall(r"`([^`]+)`", row)]


@pytest.mark.parametrize("file", DOCUMENTED)
def test_every_key_is_documented_once(file: str):
    assert sorted(documented(file)) == sorted(keys_of(DOCUMENTED[file]))


def test_the_shipped_controller_has_a_blank_for_every_key():
    shipped = tomllib.loads((ASSETS / "controller.toml").read_text("utf-8"))
    blanks = [f"{table}.{key}" for table, keys in shipped.items() for key in keys]
    assert sorted(blanks) == sorted(keys_of(Controller))


@pytest.mark.parametrize("file", FILES)
def test_every_key_describes_itself(file: str):
    def bare(model: type[BaseModel]) -> Iterator[str]:
        for name, field in model.model_fields.items():
            if not field.description:
                yield f"{model.__name__}.{name}"
            if inner := table_of(field.annotation):
                yield from bare(inner)

    assert list(bare(FILES[file])) == []


def test_every_behaviour_is_documented():
    assert [name for name in BEHAVIOURS if f"`{name}`" not in README] == []


def test_every_row_speaks_both_languages():
    rows = [line.split("|")[2:4] for line in README.splitlines() if line.startswith("| `")]
    assert rows
    assert all(re.search("[\u4e00-\u9fff]", zh) and re.search("[a-z]{3}", en) for zh, en in rows)
