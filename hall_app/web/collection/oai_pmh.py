"""OAI-PMH 2.0: by which aggregators harvest the collection, as a function from a request's arguments to a document.

https://www.openarchives.org/OAI/2.0/openarchivesprotocol.htm. Deleted records are not kept. Two of the protocol's
errors cannot happen here: every record is there in every format (noMetadataFormats), and there are sets
(noSetHierarchy).
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

from hall_app.web.collection import dublin_core, lido
from hall_app.web.collection.markup import Node, document, node
from hall_app.web.collection.record import Collection, Item

__all__ = ["PAGE", "harvested"]

PAGE = 50  # records in one answer
NO_CONTACT = "no-contact-stated@example.invalid"  # the protocol wants one; hall.toml: contact

_NAMESPACE = "http://www.openarchives.org/OAI/2.0/"
_ROOT = {
    "xmlns": _NAMESPACE,
    "xmlns:xsi": "http://www.w3.org/2001/XMLSchema-instance",
    "xsi:schemaLocation": f"{_NAMESPACE} http://www.openarchives.org/OAI/2.0/OAI-PMH.xsd",
}
_SECONDS, _DAYS = "%Y-%m-%dT%H:%M:%SZ", "%Y-%m-%d"
_LAST = datetime.max.replace(tzinfo=UTC)
_SETS = {
    "simulated": "由模拟着装的衣物 · Garments dressed by simulation",
    "scanned": "扫描的展品 · Scanned exhibits",
    "model": "现成模型 · Ready-made models",
}


@dataclass(frozen=True)
class _Format:
    schema: str
    namespace: str
    write: Callable[[Collection, Item], Node]


_FORMATS = {
    "oai_dc": _Format(dublin_core.SCHEMA, dublin_core.NAMESPACE, dublin_core.dublin_core),
    "lido": _Format(lido.SCHEMA, lido.NAMESPACE, lido.lido),
}


class _Refused(Exception):
    """The request is answered by an error of the protocol."""

    def __init__(self, code: str, words: str) -> None:
        super().__init__(words)
        self.code = code


@dataclass(frozen=True)
class _List:
    """What a list request asks for. after: id of the last exhibit told before; told: how many were."""

    prefix: str
    begin: str | None = None
    end: str | None = None
    set: str | None = None
    after: str = ""
    told: int = 0


@dataclass(frozen=True)
class _Verb:
    """What a verb needs and takes."""

    answer: Callable[[_Asked], list[Node]]
    needed: frozenset[str] = frozenset()
    taken: frozenset[str] = frozenset()
    resumes: bool = False


@dataclass(frozen=True)
class _Asked:
    """A request whose arguments are allowed."""

    collection: Collection
    arguments: Mapping[str, str]
    page: int


def harvested(
    collection: Collection, arguments: Sequence[tuple[str, str]], now: datetime, *, page: int = PAGE
) -> bytes:
    """The answer to a request.

    arguments: names and values as they came; now: with its zone; page: records in one answer.
    """
    told: Mapping[str, str] = dict(arguments)
    try:
        verb = _verb(arguments)
        inside = [node(told["verb"], *verb.answer(_Asked(collection, told, page)))]
    except _Refused as refusal:
        if refusal.code in ("badVerb", "badArgument"):
            told = {}  # such arguments are not repeated
        inside = [node("error", str(refusal), attributes={"code": refusal.code})]
    asked = node("request", collection.at("/oai"), attributes=told)
    moment = node("responseDate", now.astimezone(UTC).strftime(_SECONDS))
    return document(node("OAI-PMH", moment, asked, *inside, attributes=_ROOT))


def _verb(arguments: Sequence[tuple[str, str]]) -> _Verb:
    """What to do, the arguments checked against what it takes."""
    names = [name for name, _ in arguments]
    verbs = [value for name, value in arguments if name == "verb"]
    if len(verbs) != 1 or verbs[0] not in _VERBS:
        known = ", ".join(_VERBS)
        raise _Refused("badVerb", f"give one verb of these: {known}")
    verb = _VERBS[verbs[0]]
    given = set(names) - {"verb"}
    if len(names) != len(set(names)):
        raise _Refused("badArgument", "an argument is given twice")
    if verb.resumes and "resumptionToken" in given:
        if given != {"resumptionToken"}:
            raise _Refused("badArgument", "resumptionToken stands alone, without other arguments")
        return verb
    if strange := given - verb.needed - verb.taken:
        raise _Refused("badArgument", f"{verbs[0]} takes no {', '.join(sorted(strange))}")
    if missing := verb.needed - given:
        raise _Refused("badArgument", f"{verbs[0]} needs {', '.join(sorted(missing))}")
    return verb


def _identify(asked: _Asked) -> list[Node]:
    collection = asked.collection
    return [
        node("repositoryName", f"{collection.title.zh} · {collection.title.en}"),
        node("baseURL", collection.at("/oai")),
        node("protocolVersion", "2.0"),
        node("adminEmail", collection.contact or NO_CONTACT),
        node("earliestDatestamp", collection.earliest.strftime(_SECONDS)),
        node("deletedRecord", "no"),
        node("granularity", "YYYY-MM-DDThh:mm:ssZ"),
    ]


def _metadata_formats(asked: _Asked) -> list[Node]:
    if "identifier" in asked.arguments:
        _found(asked)
    return [
        node(
            "metadataFormat",
            node("metadataPrefix", prefix),
            node("schema", told.schema),
            node("metadataNamespace", told.namespace),
        )
        for prefix, told in _FORMATS.items()
    ]


def _sets(asked: _Asked) -> list[Node]:
    if "resumptionToken" in asked.arguments:
        raise _Refused("badResumptionToken", "the list of sets is told at once")
    return [node("set", node("setSpec", spec), node("setName", name)) for spec, name in _SETS.items()]


def _record(asked: _Asked) -> list[Node]:
    item = _found(asked)
    return [_whole(asked.collection, item, _format(asked.arguments["metadataPrefix"]))]


def _identifiers(asked: _Asked) -> list[Node]:
    wanted, items, token = _listed(asked)
    return [*(_header(asked.collection, item) for item in items), *token]


def _records(asked: _Asked) -> list[Node]:
    wanted, items, token = _listed(asked)
    told = _format(wanted.prefix)
    return [*(_whole(asked.collection, item, told) for item in items), *token]


_LISTS = (frozenset({"metadataPrefix"}), frozenset({"from", "until", "set"}))
_VERBS: dict[str, _Verb] = {
    "Identify": _Verb(_identify),
    "ListMetadataFormats": _Verb(_metadata_formats, taken=frozenset({"identifier"})),
    "ListSets": _Verb(_sets, resumes=True),
    "ListIdentifiers": _Verb(_identifiers, *_LISTS, resumes=True),
    "ListRecords": _Verb(_records, *_LISTS, resumes=True),
    "GetRecord": _Verb(_record, frozenset({"identifier", "metadataPrefix"})),
}


def _format(prefix: str) -> _Format:
    if prefix not in _FORMATS:
        raise _Refused("cannotDisseminateFormat", f"the formats are {', '.join(_FORMATS)}")
    return _FORMATS[prefix]


def _identifier(collection: Collection, item: Item) -> str:
    return f"oai:{collection.host}:{item.id}"


def _found(asked: _Asked) -> Item:
    identity = asked.arguments["identifier"]
    for item in asked.collection.items:
        if _identifier(asked.collection, item) == identity:
            return item
    raise _Refused("idDoesNotExist", f"there is no {identity}; ListIdentifiers names those that are")


def _header(collection: Collection, item: Item) -> Node:
    return node(
        "header",
        node("identifier", _identifier(collection, item)),
        node("datestamp", item.changed.strftime(_SECONDS)),
        node("setSpec", item.kind),
    )


def _whole(collection: Collection, item: Item, told: _Format) -> Node:
    return node("record", _header(collection, item), node("metadata", told.write(collection, item)))


def _listed(asked: _Asked) -> tuple[_List, list[Item], list[Node]]:
    """What is asked for, this answer's part of it, and the token that leads to the next one."""
    arguments = asked.arguments
    resumed = "resumptionToken" in arguments
    wanted = _resumed(arguments["resumptionToken"]) if resumed else _asked_for(arguments)
    _format(wanted.prefix)
    matching = _matching(asked.collection, wanted)
    left = [item for item in matching if item.id > wanted.after]
    if not left:
        if resumed:
            raise _Refused("badResumptionToken", "what was left of the list is gone: begin it again")
        raise _Refused("noRecordsMatch", "no record was written in that time, or is in that set")
    now, later = left[: asked.page], left[asked.page :]
    if not resumed and not later:
        return wanted, now, []
    after = replace(wanted, after=now[-1].id, told=wanted.told + len(now))
    told = {"completeListSize": str(len(matching)), "cursor": str(wanted.told)}
    return wanted, now, [node("resumptionToken", _token(after) if later else None, attributes=told)]


def _matching(collection: Collection, wanted: _List) -> list[Item]:
    """All records of the list, by id."""
    begin, end = _bounds(wanted)
    found = [
        item
        for item in collection.items
        if begin <= item.changed < end and (wanted.set is None or item.kind == wanted.set)
    ]
    return sorted(found, key=lambda item: item.id)


def _asked_for(arguments: Mapping[str, str]) -> _List:
    wanted = _List(
        arguments["metadataPrefix"], arguments.get("from"), arguments.get("until"), arguments.get("set")
    )
    _bounds(wanted)
    if wanted.begin and wanted.end and len(wanted.begin) != len(wanted.end):
        raise _Refused(
            "badArgument", "from and until are of different granularity: give both as days or seconds"
        )
    return wanted


def _bounds(wanted: _List) -> tuple[datetime, datetime]:
    """The time from which, and the time before which a record was written."""
    begin = _time(wanted.begin, "from")[0] if wanted.begin is not None else datetime.min.replace(tzinfo=UTC)
    end = _time(wanted.end, "until")[1] if wanted.end is not None else _LAST
    if begin >= end:
        raise _Refused("badArgument", "from is later than until")
    return begin, end


def _time(text: str, name: str) -> tuple[datetime, datetime]:
    """When the day or second begins, and when it has passed."""
    forms = {r"\d{4}-\d\d-\d\d": (_DAYS, timedelta(days=1))}
    forms[r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ"] = (_SECONDS, timedelta(seconds=1))
    for shape, (form, length) in forms.items():
        if re.fullmatch(shape, text, re.ASCII):
            try:
                begin = datetime.strptime(text, form).replace(tzinfo=UTC)
            except ValueError:
                break
            return begin, begin + min(length, _LAST - begin)
    raise _Refused("badArgument", f"{name} is no date: write 2026-11-30 or 2026-11-30T12:00:00Z")


def _token(wanted: _List) -> str:
    """Where a list goes on, as one word. It holds all of it: nothing is kept here, so it never expires."""
    told = [wanted.prefix, wanted.begin, wanted.end, wanted.set, wanted.after, wanted.told]
    text = json.dumps(told, separators=(",", ":")).encode()
    return base64.urlsafe_b64encode(_sum(text) + text).decode().rstrip("=")


def _resumed(token: str) -> _List:
    """The list that a token goes on with, checked as any other text from outside."""
    try:
        data = base64.b64decode(token + "=" * (-len(token) % 4), altchars=b"-_", validate=True)
        prefix, begin, end, chosen, after, told = json.loads(data[4:])
        texts = all(isinstance(text, str | None) for text in (begin, end, chosen))
        if _sum(data[4:]) != data[:4] or not texts or not isinstance(after, str) or not isinstance(told, int):
            raise ValueError("not ours")
        wanted = _List(str(prefix), begin, end, chosen, after, told)
        _format(wanted.prefix)
        _bounds(wanted)
        return wanted
    except (ValueError, TypeError, RecursionError, _Refused) as error:
        raise _Refused("badResumptionToken", "this is no token of ours: begin the list again") from error


def _sum(text: bytes) -> bytes:
    return hashlib.sha256(text).digest()[:4]
