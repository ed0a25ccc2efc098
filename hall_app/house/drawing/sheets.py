"""What style sheets say of a drawing's elements, written anew: one class for all elements they tell the same.

So every reference belongs to known elements, and no browser has selectors to weigh.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from xml.etree.ElementTree import Element

import tinycss2

from hall_app.house.drawing.styles import Token, declared, note, say, weighty, written

__all__ = ["TooMuch", "told_by_sheets"]

_SCREENS = frozenset(("", "all", "screen", "only screen"))
# Letters that programs bring with them; what is never closed goes to the end, so nothing is looked at twice.
_DATA = re.compile(r"""url\(\s*+(?:"data:[^"]*+"?+|'data:[^']*+'?+|data:[^)"']*+)""", re.IGNORECASE)
_MOST_READ = 300_000  # characters of all sheets
_MOST_WEIGHED = 500_000  # parts of selectors, each for each element
_MOST_TOLD = 2_000_000  # characters of all classes, and what rules say for each


class TooMuch(Exception):
    """Few rules, but more work than any drawing is worth."""


@dataclass(frozen=True)
class Compound:
    """`path.seam#one`: a part of a selector; kind: "" for any."""

    kind: str = ""
    key: str = ""
    classes: frozenset[str] = frozenset()
    child: bool = False  # of the part before, not only somewhere below it

    def fits(self, element: Element, classes: frozenset[str]) -> bool:
        return (
            self.kind in ("", element.tag)
            and self.key in ("", element.get("id", ""))
            and self.classes <= classes
        )


@dataclass(frozen=True)
class Selected:
    """A rule by one selector. weight: specificity and place in the file."""

    parts: tuple[Compound, ...]
    weight: tuple[int, int, int, int]
    said: Mapping[str, str]  # property -> value
    stressed: Mapping[str, str]  # !important


def told_by_sheets(
    sheets: Iterable[tuple[str, str]], root: Element, left: Counter[str], known: Set[str]
) -> tuple[dict[Element, list[tuple[str, str]]], str]:
    """What style sheets, (media, text), say of each element, by known properties, and the sheet that says it by
    classes, which the elements now have. Raises TooMuch."""
    rules: list[Selected] = []
    read = number = 0
    for media, text in sheets:
        if _shown(media):
            text = _DATA.sub("url()", text)
            read += len(text)
            if read > _MOST_READ:
                raise TooMuch
            for rule in _rules(tinycss2.parse_stylesheet(text, True, True), left):
                rules += _selected(rule, number := number + 1, left, known)
    told: dict[Element, list[tuple[str, str]]] = {}
    classes: dict[str, str] = {}  # block -> class
    merged: dict[tuple[int, ...], tuple[str, list[tuple[str, str]]]] = {}  # rules -> class and what they say
    size = 0
    for element, matched in _Matches(rules).walk(root):
        element.attrib.pop("class", None)
        if not matched:
            continue
        key = tuple(sorted(map(id, matched)))
        if key not in merged:
            block, said = _merged(matched)
            size += len(block) + sum(len(rule.said) + len(rule.stressed) for rule in matched)
            if size > _MOST_TOLD:
                raise TooMuch
            merged[key] = (block and classes.setdefault(block, f"c{len(classes) + 1}"), weighty(said))
        name, said = merged[key]
        if name:
            element.set("class", name)
            told[element] = said
    return told, "".join(f".{name}{{{block}}}\n" for block, name in classes.items())


def _merged(matched: Iterable[Selected]) -> tuple[str, list[tuple[str, str]]]:
    said, stressed = dict[str, str](), dict[str, str]()
    for rule in sorted(matched, key=lambda one: one.weight):
        for whole, more in ((said, rule.said), (stressed, rule.stressed)):
            for key, value in more.items():
                say(whole, key, value)
    return written(said, stressed), [*said.items(), *stressed.items()]


class _Matches:
    """The rules, by what the last part of their selector asks for, and how much has been weighed."""

    def __init__(self, rules: Iterable[Selected]) -> None:
        self.weighed = 0
        self.of: dict[str, list[Selected]] = defaultdict(list)
        for rule in rules:
            last = rule.parts[-1]
            one = next(iter(sorted(last.classes)), "")
            key = f"#{last.key}" if last.key else f".{one}" if one else last.kind or "*"
            self.of[key].append(rule)

    def walk(self, root: Element) -> Iterator[tuple[Element, list[Selected]]]:
        """Each element with the rules that are meant for it."""
        above: list[tuple[Element, frozenset[str]]] = []

        def visit(element: Element) -> Iterator[tuple[Element, list[Selected]]]:
            classes = frozenset(element.get("class", "").split())
            above.append((element, classes))
            keys = ("*", element.tag, f"#{element.get('id', '')}", *(f".{one}" for one in classes))
            rules = (rule for key in keys for rule in self.of.get(key, ()))
            matched = [
                rule for rule in rules if self._fits(rule.parts, len(rule.parts) - 1, above, len(above) - 1)
            ]
            # Below the element its classes are still asked for: it loses them when all below is seen.
            for child in element:
                yield from visit(child)
            above.pop()
            yield element, matched

        if self.of:
            yield from visit(root)
        else:
            yield from ((element, []) for element in root.iter())

    def _fits(
        self,
        parts: tuple[Compound, ...],
        k: int,
        above: Sequence[tuple[Element, frozenset[str]]],
        at: int,
    ) -> bool:
        self.weighed += 1
        if self.weighed > _MOST_WEIGHED:
            raise TooMuch
        if not parts[k].fits(*above[at]):
            return False
        if k == 0:
            return True
        reach = range(at - 1, at - 2, -1) if parts[k].child else range(at - 1, -1, -1)
        return any(self._fits(parts, k - 1, above, one) for one in reach if one >= 0)


def _shown(media: str) -> bool:
    return any(" ".join(one.lower().split()) in _SCREENS for one in media.split(","))


def _rules(rules: Iterable[Token], left: Counter[str]) -> Iterator[Token]:
    """Those of @media that mean a screen included."""
    for rule in rules:
        if rule.type == "qualified-rule":
            yield rule
        elif (
            rule.type == "at-rule"
            and rule.lower_at_keyword == "media"
            and rule.content is not None
            and _shown(tinycss2.serialize(rule.prelude))
        ):
            yield from _rules(tinycss2.parse_rule_list(rule.content, True, True), left)
        else:
            note(left, "at-rule" if rule.type == "at-rule" else "style")


def _selected(rule: Token, number: int, left: Counter[str], known: Set[str]) -> Iterator[Selected]:
    said = declared(rule.content, left, known)
    selectors: list[list[Token]] = [[]]
    for token in rule.prelude:
        if token == ",":
            selectors.append([])
        elif token.type != "comment":
            selectors[-1].append(token)
    given = set[tuple[tuple[Compound, ...], int]]()
    for selector in selectors:
        parts = _parts(selector)
        if parts is None:
            note(left, "style")
            continue
        classes = sum(token == "." for token in selector)
        if (parts, classes) in given:
            continue
        given.add((parts, classes))
        keys = sum(bool(part.key) for part in parts)
        kinds = sum(bool(part.kind) for part in parts)
        yield Selected(parts, (keys, classes, kinds, number), *said)


def _parts(selector: Sequence[Token]) -> tuple[Compound, ...] | None:
    """None: it selects by more than elements, classes and names, and what they lie in."""
    found: list[Compound] = []
    kind, key, classes, child, any_kind = "", "", set[str](), False, False
    tokens: list[Token] = [*selector, None]
    k = 0
    while k < len(tokens):
        token = tokens[k]
        if _ends(token) and (kind or key or classes or any_kind):
            found.append(Compound(kind, key, frozenset(classes), child))
            kind, key, classes, child, any_kind = "", "", set[str](), False, False
        if token is None or token.type == "whitespace":
            pass
        elif token == ">":
            if child or not found:
                return None
            child = True
        elif token == "*":
            any_kind = True
        elif token.type == "ident" and not (kind or key or classes):
            kind = token.value
        elif token.type == "hash" and token.is_identifier:
            key = token.value
        elif token == "." and getattr(tokens[k + 1], "type", "") == "ident":
            k += 1
            classes.add(tokens[k].value)
        else:
            return None
        k += 1
    return None if child or not found else tuple(found)


def _ends(token: Token | None) -> bool:
    return token is None or token.type == "whitespace" or token == ">"
