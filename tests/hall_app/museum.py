"""A content folder with whatever texts, and the collection that is made of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from content_house import EXHIBIT, make_house
from hypothesis import strategies as st

from hall_app.content import Content, Exhibit, load
from hall_app.content.bakes import ExhibitModels, models_of
from hall_app.content.schema import ExhibitFile
from hall_app.web.collection import Collection, collection_of

ADDRESS = "https://hall.example.org"
RECORD = (
    "object",
    "date",
    "culture",
    "material",
    "technique",
    "colour",
    "measurements",
    "wear",
    "maker",
    "source",
)
# Every text that curators could paste: formulas, quotes, separators, breaks, controls, other scripts, marks.
HOSTILE = st.one_of(
    st.text(min_size=1, max_size=40),
    st.sampled_from(
        ["=1+1", "'=1", "''+2", " @x", "-", "＝cmd", "\t=1", "\r\n=2", 'a"b', "a,b;c\td", "'tis"]
    ),
    st.sampled_from(
        ["]]>", "<!--", "</script><b>&amp;", "\x00\x08", "\x7f", "\ufeffx", "\u202eabc", "\U0001f9f5"]
    ),
    st.sampled_from(["a\nb\r\nc\rd", "\\u0041", '"""', "'''", "# no comment", "[table]"]),
).filter(lambda text: bool(text.strip()))


def both(zh: str, en: str) -> dict[str, str]:
    return {"zh": zh, "en": en}


def exhibit_file(**changed: Any) -> ExhibitFile:
    """A valid exhibit.toml, read, with these keys."""
    told = {
        "title": both("箱", "Chest"),
        "place": {"x": 0.0, "z": -1.0},
        "models": {"hall": "media/chest.glb"},
        "body": {"shape": "round", "radius": 0.4},
        "licence": "CC0-1.0",
    }
    return ExhibitFile.model_validate({**told, **changed})


def exhibit(identity: str = "chest", text: str = "t", **changed: Any) -> Exhibit:
    """An exhibit that lies nowhere."""
    return Exhibit(identity, Path("/nowhere"), exhibit_file(**changed), text, text)


def museum(folder: Path, toml: str = EXHIBIT) -> Content:
    """A folder with one exhibit, chest."""
    make_house(folder)
    (folder / "exhibits/chest/exhibit.toml").write_text(toml, "utf-8")
    return read(folder)


def read(folder: Path) -> Content:
    content = load(folder)
    assert not content.problems
    return content


def models_in(content: Content):
    """id -> what it is shown with."""

    def found(identity: str) -> ExhibitModels | None:
        one = content.exhibit(identity)
        return models_of(content, one, None) if one else None

    return found


def collection(content: Content, address: str = ADDRESS) -> Collection:
    return collection_of(content, models_in(content), address)
