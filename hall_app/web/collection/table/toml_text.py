"""An exhibit.toml with some values changed: comments, order and spelling of all the rest stay.

tomlkit writes it, and is not believed: what it wrote is read again by another reader and compared with what was meant
(of 0.15 it is known that keys written with dots and split lists of tables may come out elsewhere).
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, MutableMapping
from typing import Any

from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.record import LANGUAGES
from hall_app.web.collection.table.columns import key
from hall_app.web.collection.table.difference import Change

__all__ = ["EditError", "edited", "read_toml_text"]


class EditError(ValueError):
    """The file is written in a way that cannot be changed by a program without harm."""


def edited(text: str, changes: Iterable[Change]) -> str:
    """The file's text with the changes. Raises EditError where that cannot be done faithfully."""
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    changes = tuple(changes)
    meant = read_toml_text(text)
    for change in changes:
        try:
            _apply(meant, change, dict, dict)
        except (TypeError, LookupError, AttributeError) as error:
            where = key(change.path)
            raise EditError(f"{where}: what stands there is of another form") from error
    try:
        document = tomlkit.parse(text)
        for change in changes:
            _apply(document, change, tomlkit.table, tomlkit.inline_table)
        written = _breaks_as(text, tomlkit.dumps(document))
        if tomllib.loads(written) == meant:
            return written
    except (
        TOMLKitError,
        tomllib.TOMLDecodeError,
        TypeError,
        ValueError,
        LookupError,
        AttributeError,
        ArithmeticError,
        RecursionError,
    ) as error:
        raise EditError(f"it cannot be rewritten ({type(error).__name__})") from error
    raise EditError("rewritten, it would say something else")


def read_toml_text(text: str) -> dict[str, Any]:
    """Raises tomllib.TOMLDecodeError for what is no TOML, and EditError for what cannot be read even so: at a number of
    thousands of digits, or thousands of brackets, tomllib gives up in ways of its own."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except (ValueError, ArithmeticError, RecursionError) as error:
        raise EditError(f"cannot be read ({type(error).__name__})") from error


def _apply(container: Any, change: Change, new_table: Any, new_pair: Any) -> None:
    """Make one change in a table of either reader's. new_table, new_pair: what stands for a table that is not there."""
    *above, last = change.path
    for part, following in zip(above, change.path[1:], strict=True):
        if isinstance(part, int):
            if part == len(container):
                container.append(new_table())
        elif part not in container:
            container[part] = _new_list() if new_table is not dict and following == 0 else new_table()
            if new_table is dict and following == 0:
                container[part] = []
        container = container[part]
    if change.value is None:
        del container[last]
    elif not isinstance(change.value, Bilingual):
        container[last] = change.value
    elif isinstance(container, MutableMapping) and isinstance(container.get(last), MutableMapping):
        for language in LANGUAGES:
            if container[last].get(language) != (text := getattr(change.value, language)):
                container[last][language] = text
    else:
        container[last] = _pair(change.value, new_pair)


def _new_list() -> Any:
    import tomlkit

    return tomlkit.aot()


def _pair(value: Bilingual, new_pair: Any) -> Any:
    made = new_pair()
    for language in LANGUAGES:
        made[language] = getattr(value, language)
    return made


def _breaks_as(text: str, written: str) -> str:
    """Lines ended as those of `text`, where all of them are ended with a carriage return."""
    if "\r\n" not in text or text.count("\n") != text.count("\r\n"):
        return written
    return written.replace("\r\n", "\n").replace("\n", "\r\n")
