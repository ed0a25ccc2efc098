"""schemathesis against descriptions that the hall gives of itself: the office's, signed in as an administrator with the
seal, and the open hall's, as a stranger."""

from __future__ import annotations

import json
import subprocess
import sys
import urllib.request
from pathlib import Path
from typing import Any

from office_clerk import clerk
from open_counter import OpenCounter

from hall_app.house.people import Role

# What would end the session that asks is left out, and what is only there to be waited for.
KEPT_OUT = ("/api/office/people/{key}/close", "/api/office/people/{key}/sign-out")
CHECKS = "not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance"


def conform(counter: OpenCounter, work: Path, examples: int) -> tuple[int, str]:
    """Exit status of schemathesis, and what it says; examples: of each operation."""
    one = clerk(counter, counter.people, Role.ADMINISTRATOR)
    document = one.told("openapi.json")
    for path in KEPT_OUT:
        del document["paths"][path]
    work.mkdir(parents=True, exist_ok=True)
    for operations in document["paths"].values():
        for operation in operations.values():
            operation["parameters"] = [
                given for given in operation["parameters"] if "$ref" not in given
            ]  # sent with every request
    cookie = "; ".join(f"{name}={value}" for name, value in one.cookies.items())
    seal = ("-H", f"Cookie: {cookie}", "-H", f"Origin: {counter.url}", "-H", f"X-Seal: {one.seal}")
    return _run(document, counter.url, work, examples, seal)


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


def _run(document: dict, url: str, work: Path, examples: int, sent: tuple[str, ...]) -> tuple[int, str]:
    (work / "api.json").write_text(json.dumps(document), "utf-8")
    command = [
        *(str(Path(sys.executable).with_name("schemathesis")), "run", "api.json"),
        *("--url", url, "--checks", CHECKS, "--seed", "20", "--max-examples", str(examples)),
        *("--continue-on-failure", "--no-color", "--phases", "examples,coverage,fuzzing"),
        *sent,
    ]
    done = subprocess.run(command, cwd=work, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr
