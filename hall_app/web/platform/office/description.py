"""The office's API described as OpenAPI 3.1, made of the same readings and deeds that answer it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from hall_app.house.people import ACTS, REFUSALS
from hall_app.web.platform.office.deeds import Deed, Reading

__all__ = ["description"]

_REFUSED = {
    "400": "Refused as it stands, or no JSON object of texts, numbers and truths",
    "401": "Nobody is signed in",
    "403": "The role does not allow it, or seal or origin is wrong",
    "404": "What the address names is not there",
    "409": "The name or address is taken, or what is changed is another by now than it was when it was read",
    "413": "Too large",
    "429": "Too often: the text says for how many seconds",
    "503": "Accounts or answers cannot be reached at the moment",
}
_JSON = "application/json"
_VALUE = {
    "anyOf": [
        {"type": "string"},
        {"type": "number"},
        {"type": "boolean"},
        {"type": "array", "items": {"type": "string"}},
    ]
}


def description(readings: Iterable[Reading], deeds: Iterable[Deed]) -> dict[str, Any]:
    """The document. Addresses are those below /api/office."""
    paths: dict[str, Any] = {
        "/api/office/me": {"get": _operation("me", "Who asks, and the seal", "", (), {})}
    }
    for one in readings:
        entry = paths.setdefault(f"/api/office/{one.path}", {})
        entry["get"] = _operation(f"read {one.path}", "", one.act, _names(one.path), one.query)
    for one in deeds:
        entry = paths.setdefault(f"/api/office/{one.path}", {})
        entry["post"] = _operation(f"do {one.path}", "", one.act, _names(one.path), {})
        entry["post"]["parameters"].append({"$ref": "#/components/parameters/seal"})
        entry["post"]["parameters"].append({"$ref": "#/components/parameters/origin"})
        entry["post"]["requestBody"] = {"required": True, "content": _body(one)}
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "The office",
            "version": "1",
            "description": "Sign in at /office; its cookie is the session. A POST names the hall as its Origin and "
            "brings the seal of /api/office/me in X-Seal. Whoever may not gets 403, and it stands in the journal.",
        },
        "paths": paths,
        "components": {
            "parameters": {
                "seal": _header("X-Seal", "of /api/office/me"),
                "origin": _header("Origin", "scheme and host of the hall"),
            },
            "responses": {
                f"refused-{status}": {
                    "description": words,
                    "content": {_JSON: {"schema": {"$ref": "#/components/schemas/refusal"}}},
                }
                for status, words in _REFUSED.items()
            },
            "schemas": {"refusal": _refusal()},
            "securitySchemes": {"session": {"type": "apiKey", "in": "cookie", "name": "hall-office"}},
        },
        "security": [{"session": []}],
    }


def _operation(key: str, told: str, act: str, names: Iterable[str], query: Any) -> dict[str, Any]:
    lang = {"name": "lang", "in": "query", "schema": {"enum": ["zh", "en"]}}
    asked = [
        {"name": name, "in": "query", "description": words, "schema": {"type": "string"}}
        for name, words in query.items()
    ]
    inside = [
        {"name": name, "in": "path", "required": True, "schema": {"type": "string", "minLength": 1}}
        for name in names
    ]
    answers: dict[str, Any] = {
        "200": {"description": "Done", "content": {_JSON: {"schema": {"type": ["object", "array"]}}}}
    }
    answers |= {status: {"$ref": f"#/components/responses/refused-{status}"} for status in _REFUSED}
    return {
        "operationId": re.sub("[^a-z]+", "-", key).strip("-"),
        "summary": told or (ACTS[act].en if act else ""),
        "tags": [act] if act else [],
        "parameters": [*inside, *asked, lang],
        "responses": answers,
    }


def _body(one: Deed) -> dict[str, Any]:
    told = {name: _VALUE | {"description": words} for name, words in one.fields.items()}
    plain = {_JSON: {"schema": {"type": "object", "properties": told, "additionalProperties": _VALUE}}}
    if not one.takes.files:
        return plain
    fields = {name: {"type": "string", "description": words} for name, words in one.fields.items()}
    files = {"file": {"type": "string", "format": "binary"}}
    whole = {"type": "object", "properties": fields | files, "required": ["file", "use"]}
    return plain | {"multipart/form-data": {"schema": whole}}


def _names(path: str) -> list[str]:
    return re.findall("{([a-z]+)}", path)


def _header(name: str, told: str) -> dict[str, Any]:
    return {"name": name, "in": "header", "required": True, "description": told, "schema": {"type": "string"}}


def _refusal() -> dict[str, Any]:
    keys = {"type": "string", "enum": [*REFUSALS, "store"]}
    return {
        "type": "object",
        "required": ["error", "text"],
        "properties": {"error": keys, "text": {"type": "string"}},
    }
