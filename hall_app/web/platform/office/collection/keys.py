"""Forms made from the models of exhibit.toml: which keys are plain enough for one, and what was typed as changes.

What stands in the file is read as TOML and not by the model, so that a faulty draft can be put right by its form.
"""

from __future__ import annotations

import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from hall_app.content.behaviours import BEHAVIOURS
from hall_app.content.schema.exhibit import Body, ExhibitFile, Media, Models, Place, Record, Show
from hall_app.content.schema.values import Bilingual
from hall_app.house.people import PeopleError
from hall_app.web.collection.table import Change
from hall_app.web.platform.counter import Asking, Field
from hall_app.web.platform.office.collection.words import BEHAVIOUR_WORDS, WORDS

__all__ = ["Key", "changes_of", "fields_of", "keys_of", "media_keys"]

LANGUAGES = ("zh", "en")
Path = tuple[str | int, ...]
_PLAIN = {
    "place.x",
    "place.z",
    "body.radius",
    "body.size",
    "body.height",
    "show.nearest",
    "licence",
}  # labels say all
_TABLES: Mapping[str, type[BaseModel]] = {
    "place": Place,
    "body": Body,
    "models": Models,
    "show": Show,
    "record": Record,
}


@dataclass(frozen=True)
class Key:
    """A key of exhibit.toml. kind: pair, text, number, numbers, choice or ticks; name: in forms, as of `hall check`."""

    path: Path
    kind: str
    needed: bool
    choices: tuple[str, ...] = ()
    told: str = ""

    @property
    def name(self) -> str:
        name = ""
        for part in self.path:
            name += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if name else part
        return name


def keys_of(*names: str) -> tuple[Key, ...]:
    """The plain keys of that name at the top of the file, or all of the table of that name."""
    found: list[Key] = []
    for name in names:
        if name in _TABLES:
            whole = not ExhibitFile.model_fields[name].is_required()
            found += _of_model(_TABLES[name], (name,), optional=whole)
        else:
            found += [key for key in [_key((name,), ExhibitFile.model_fields[name])] if key]
    return tuple(found)


def media_keys(number: int) -> tuple[Key, ...]:
    """The texts of one medium, counted from 0."""
    return tuple(
        Key(("media", number, name), "pair", False, told=Media.model_fields[name].description or "")
        for name in ("alt", "caption", "transcript")
    )


def _of_model(model: type[BaseModel], above: Path, *, optional: bool) -> Iterator[Key]:
    for name, info in model.model_fields.items():
        key = _key((*above, name), info)
        if key is not None:
            yield Key(key.path, key.kind, key.needed and not optional, key.choices, key.told)


def _key(path: Path, info: FieldInfo) -> Key | None:
    told, needed = info.description or "", info.is_required()
    if path == ("behaviours",):
        return Key(path, "ticks", False, tuple(BEHAVIOURS), told)
    kind, choices = _kind(info.annotation)
    return Key(path, kind, needed, choices, told) if kind else None


def _kind(annotation: Any) -> tuple[str, tuple[str, ...]]:
    """What is typed for a value of this type; "" for what no plain field holds."""
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin in (Union, types.UnionType):
        return _kind(next(one for one in inside if one is not type(None)))
    if origin is Literal:
        return "choice", tuple(str(one) for one in inside)
    if origin is tuple:
        return ("numbers", ()) if Ellipsis not in inside and _kind(inside[0])[0] == "number" else ("", ())
    if hasattr(annotation, "__metadata__"):
        return _kind(inside[0])
    if isinstance(annotation, type):
        if issubclass(annotation, Bilingual):
            return "pair", ()
        if issubclass(annotation, str):
            return "text", ()
        if issubclass(annotation, float):
            return "number", ()
    return "", ()


def fields_of(asking: Asking, keys: tuple[Key, ...], table: Mapping[str, Any]) -> tuple[Field, ...]:
    """table: exhibit.toml as it is read."""
    found: list[Field] = []
    for key in keys:
        value = _value(table, key.path)
        label, hint = _label(asking, key)
        given = {"maxlength": "4000"}
        if key.kind == "pair":
            tongues = (asking.word("（中文）", " (Chinese)"), asking.word("（英文）", " (English)"))
            for language, tongue in zip(LANGUAGES, tongues, strict=True):
                text = _part(value, language)
                long = len(text) > 60 or key.path[-1] in ("caption", "transcript", "alt")
                kind = "textarea" if long or key.path[0] == "record" else "text"
                name = f"{key.name}.{language}"
                more = given | {"rows": "2", "lang": language}
                if kind == "text":
                    del more["rows"]
                found.append(Field(name, label + tongue, kind, text, needed=key.needed, given=more))
        elif key.kind == "ticks":
            ticked = value if isinstance(value, list) else ()
            found += [
                Field(
                    f"{key.name}.{one}",
                    asking.word(*BEHAVIOUR_WORDS.get(one, (one, one))),
                    "check",
                    "on" if one in ticked else "",
                )
                for one in key.choices
            ]
        elif key.kind == "choice":
            choices = {one: asking.word(*WORDS.get(f"{key.name}={one}", (one, one))) for one in key.choices}
            if not key.needed:
                choices = {"": "–"} | choices
            found.append(Field(key.name, label, "select", _shown(value), hint, key.needed, choices))
        else:
            number = {"inputmode": "decimal", "autocomplete": "off"} if key.kind != "text" else given
            found.append(Field(key.name, label, "text", _shown(value), hint, key.needed, given=number))
    return tuple(found)


def _label(asking: Asking, key: Key) -> tuple[str, str]:
    """Words for the key; where the file has a better description, in English, as a hint."""
    name = ".".join(part for part in key.path if isinstance(part, str))
    label = asking.word(*WORDS.get(name, (name, name)))
    told = asking.lang == "en" and key.kind in ("text", "number", "numbers") and name not in _PLAIN
    return label, key.told if told else ""


def changes_of(
    form: Mapping[str, str], keys: tuple[Key, ...], table: Mapping[str, Any]
) -> tuple[Change, ...]:
    """What the form says differently from the file; keys that it leaves out stay. Raises PeopleError."""
    found = []
    for key in keys:
        before = _value(table, key.path)
        new = _typed(form, key, before)
        if new is not _ABSENT and not _same(new, before):
            found.append(Change(key.path, before, new))
    return tuple(found)


_ABSENT = object()


def _typed(form: Mapping[str, str], key: Key, before: Any) -> Any:
    if key.kind == "pair":
        names = {language: f"{key.name}.{language}" for language in LANGUAGES}
        if not any(name in form for name in names.values()):
            return _ABSENT
        texts = {x: _plain(form.get(name, _part(before, x))) for x, name in names.items()}
        if not any(texts.values()):
            if key.needed:
                raise PeopleError("content-file", why=f"{key.name}: needs both languages")
            return None
        if not all(texts.values()):
            raise PeopleError("content-file", why=f"{key.name}: needs both languages, or neither")
        return Bilingual(**texts)
    if key.kind == "ticks":
        if f"{key.name}.form" not in form and not any(f"{key.name}.{one}" in form for one in key.choices):
            return _ABSENT
        ticked = [one for one in key.choices if form.get(f"{key.name}.{one}")]
        old = before if isinstance(before, list) else []  # in the file's own order
        return [one for one in old if one in ticked] + [one for one in ticked if one not in old]
    if key.name not in form:
        return _ABSENT
    text = _plain(form[key.name])
    if not text:
        if key.needed:
            raise PeopleError("content-file", why=f"{key.name}: is missing")
        return None
    return text if key.kind in ("text", "choice") else _numbers(key, text)


def _numbers(key: Key, text: str) -> Any:
    try:
        found = [float(part) for part in text.replace(",", " ").replace("×", " ").split()]
    except ValueError:
        found = []
    if len(found) != (1 if key.kind == "number" else 2) or not all(map(isfinite, found)):
        raise PeopleError("content-file", why=f"{key.name}: {text[:40]!r} is no number – write 1.5, say")
    return found[0] if key.kind == "number" else found


def _plain(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n").strip()


def _value(table: Mapping[str, Any], path: Path) -> Any:
    found: Any = table
    for part in path:
        if isinstance(part, int):
            found = found[part] if isinstance(found, list) and part < len(found) else None
        else:
            found = found.get(part) if isinstance(found, dict) else None
    return found


def _same(new: Any, before: Any) -> bool:
    if isinstance(new, Bilingual):
        return isinstance(before, dict) and {x: _plain(_part(before, x)) for x in LANGUAGES} == new.as_json()
    if isinstance(new, str) and isinstance(before, str):
        return new == _plain(before)
    return new == before


def _part(pair: Any, language: str) -> str:
    """What stands in the field of one language; where no pair stands in the file, in both what does."""
    return _shown(pair.get(language) if isinstance(pair, dict) else pair)


def _shown(value: Any) -> str:
    """What stands in a field for it, whatever it is: a form shows a value that the check refuses, to be put right."""
    if value is None:
        return ""
    try:
        if isinstance(value, list):
            return " ".join(map(_shown, value))
        if isinstance(value, float | int) and not isinstance(value, bool):
            return f"{value:g}" if abs(value) < 1e5 and float(f"{value:g}") == value else repr(value)
        return str(value)
    except (ValueError, RecursionError):  # an integer of thousands of digits, lists in lists in lists
        return "…"
