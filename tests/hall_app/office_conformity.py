"""schemathesis against descriptions that the hall gives of itself: the office's, signed in as an administrator with the
seal, and the open hall's, as a stranger."""

from __future__ import annotations

import json
import subprocess
import sys
import urllib.request
from collections import Counter as Tally
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fastapi import FastAPI
from office_clerk import clerk
from office_stock import OWN, Stock
from open_counter import open_counter
from starlette.concurrency import run_in_threadpool

from hall_app.house.people import Role

CHECKS = "not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance"
PHASES = "examples,coverage,fuzzing"
OFFICE = "/api/office/"


@dataclass
class Watch:
    """Round the application: counts what is answered, and has the stock put back before what may have been taken."""

    app: FastAPI
    stock: Stock | None = None
    answered: dict[str, Tally[int]] = field(default_factory=dict)

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        own = any(name == OWN.lower().encode() for name, _ in scope.get("headers", ()))
        if self.stock is None or own or not scope.get("path", "").startswith(OFFICE):
            return await self.app(scope, receive, send)
        if scope["method"] == "POST" or scope["path"].endswith(
            ("/picture", "/shape")
        ):  # of what an upload replaces
            await run_in_threadpool(self.stock.refresh, scope["path"].removeprefix(OFFICE))

        async def counted(message: Any) -> None:
            if message["type"] == "http.response.start":
                where = getattr(scope.get("route"), "path", scope["path"])
                tally = self.answered.setdefault(f"{scope['method']} {where}", Tally())
                tally[message["status"]] += 1
            await send(message)

        return await self.app(scope, receive, counted)


def conform(work: Path, examples: int, phases: str = PHASES) -> tuple[int, str, dict[str, Tally[int]]]:
    """Exit status of schemathesis, what it says, and operation -> status -> how often the office answered so.

    examples: of each operation, beside one that the house's stock can do; phases: of schemathesis.
    """
    watch: list[Watch] = []

    def around(app: FastAPI) -> Callable[..., Any]:
        watch.append(Watch(app))
        return watch[0]

    with open_counter(work / "counter", around=around) as counter:
        one = clerk(counter, counter.people, Role.ADMINISTRATOR)
        document, stock = one.told("openapi.json"), Stock.of(counter, one)
        described(document, stock)
        cookie = "; ".join(f"{name}={value}" for name, value in one.cookies.items())
        seal = ("-H", f"Cookie: {cookie}", "-H", f"Origin: {counter.url}", "-H", f"X-Seal: {one.seal}")
        watch[0].stock = stock
        asked = work / "asked"
        asked.mkdir()
        status, said = _run(document, counter.url, asked, examples, seal, phases)
        watch[0].stock = None
    listed = {f"{method.upper()} {path}" for path, entry in document["paths"].items() for method in entry}
    return status, said, {name: watch[0].answered.get(name, Tally()) for name in sorted(listed)}


def described(document: dict[str, Any], stock: Stock) -> None:
    """Write into the description what there is: an example of each operation, and ids among other words."""
    for path, entry in document["paths"].items():
        for method, operation in entry.items():
            name = f"{method.upper()} {path.removeprefix(OFFICE)}"
            there = stock.names.get(name, {}) | stock.asked.get(name, {})
            # What is left out is a reference: the seal and the origin, which are sent with every request.
            operation["parameters"] = [given for given in operation["parameters"] if "$ref" not in given]
            for given in operation["parameters"]:
                if words := there.get(given["name"]):
                    _offer(given, words)
            for kind, body in operation.get("requestBody", {}).get("content", {}).items():
                _offer_body(kind, body, stock.given.get(name, {}))


def _offer(given: dict[str, Any], words: list[str]) -> None:
    given["schema"] = {"anyOf": [{"enum": words}, given["schema"]]}
    given["example"] = words[0]


def _offer_body(kind: str, body: dict[str, Any], example: Mapping[str, Any]) -> None:
    """Fields that need a file are an example of a form alone."""
    if ("file" in body["schema"].get("required", ())) != (kind == "multipart/form-data"):
        return
    if kind == "application/json" and "use" in example:
        return
    body["example"] = dict(example)
    for name, value in example.items():
        properties = body["schema"]["properties"]
        if kind == "application/json":
            properties[name] = {"anyOf": [{"enum": [value]}, properties.get(name, {"type": "string"})]}


def conform_open(url: str, work: Path, examples: int) -> tuple[int, str]:
    """The same of what anyone may ask, the survey's API included: of exhibits and questionnaires that are there, and of
    others."""

    def told(path: str) -> Any:
        with urllib.request.urlopen(f"{url}{path}", timeout=30) as answer:
            return json.load(answer)

    document = told("/api/openapi.json")
    there = {
        "exhibit": [exhibit["id"] for exhibit in told("/api/scene")["exhibits"]],
        "key": [questionnaire["id"] for questionnaire in told("/api/v1/questionnaires")],
    }
    for operations in document["paths"].values():
        for operation in operations.values():
            for given in operation.get("parameters", ()):
                if names := there.get(given["name"]):
                    given["schema"] = {"anyOf": [{"enum": names}, given["schema"]]}
    work.mkdir(parents=True, exist_ok=True)
    return _run(document, url, work, examples, ())


def _run(
    document: dict, url: str, work: Path, examples: int, sent: tuple[str, ...], phases: str = PHASES
) -> tuple[int, str]:
    (work / "api.json").write_text(json.dumps(document), "utf-8")
    command = [
        *(str(Path(sys.executable).with_name("schemathesis")), "run", "api.json"),
        *("--url", url, "--checks", CHECKS, "--seed", "20", "--max-examples", str(examples)),
        *("--continue-on-failure", "--no-color", "--phases", phases, "--request-timeout", "300"),
        *sent,
    ]
    done = subprocess.run(command, cwd=work, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr
