"""schemathesis against the office's own description, signed in as an administrator with the seal."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

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
    (work / "office.json").write_text(json.dumps(document), "utf-8")
    cookie = "; ".join(f"{name}={value}" for name, value in one.cookies.items())
    command = [
        *(str(Path(sys.executable).with_name("schemathesis")), "run", "office.json"),
        *("--url", counter.url, "--checks", CHECKS, "--seed", "20", "--max-examples", str(examples)),
        *("--continue-on-failure", "--no-color", "--phases", "examples,coverage,fuzzing"),
        *("-H", f"Cookie: {cookie}", "-H", f"Origin: {counter.url}", "-H", f"X-Seal: {one.seal}"),
    ]
    done = subprocess.run(command, cwd=work, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr
