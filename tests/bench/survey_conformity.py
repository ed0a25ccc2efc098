"""schemathesis against a running service: its own description, and the same written out for one questionnaire.

The general description cannot say which items a questionnaire has, so nearly every example of it is a 404. Written
out, with the questionnaire's id in the paths and its own schema of a submission, positive examples are stored.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from survey_service import ASSETS, Service, stored

from survey import read_questionnaire
from survey.store import Store

GENERAL = "{key}"
CONFIG = """\
[checks]
positive_data_acceptance.expected-statuses = ["2xx", "401", "403", "404", "409", "410"]

# A good question to answers that cannot be analysed, an item to drop that there is not, or fewer answers than are to
# share what is told of a visitor: 422 with the reason.
[[operations]]
include-path-regex = "/(analysis|export/.*)$"
checks.positive_data_acceptance.expected-statuses = ["2xx", "401", "403", "404", "422"]
"""


def written_out(document: dict, key: str, schema: dict) -> dict:
    """The description of one questionnaire's routes alone, each a path of its own."""
    paths = {}
    for path, methods in document["paths"].items():
        for method in methods.values():
            found = [one for one in method.get("parameters", []) if one["name"] != "key"]
            method["parameters"] = found
        paths[path.replace(GENERAL, key)] = methods
    post = paths[f"/api/v1/questionnaires/{key}/submissions"]["post"]
    post["requestBody"]["content"]["application/json"]["schema"] = schema
    return document | {"paths": paths}


def conform(work: Path, examples: int, key: str = "garment") -> dict:
    """{"failures": exit statuses other than 0, …}; what schemathesis says goes to standard error where it fails."""
    data = work / "conformity"
    store = Store(data)
    token = store.tokens.make("schemathesis")
    store.close()
    service = Service(data)
    (work / "schemathesis.toml").write_text(CONFIG, "utf-8")
    try:
        document = json.loads(service.request("GET", "/api/v1/openapi.json")[1])
        schema = json.loads(service.request("GET", f"/api/v1/questionnaires/{key}/submission.schema.json")[1])
        (work / "general.json").write_text(json.dumps(document), "utf-8")
        (work / "written_out.json").write_text(json.dumps(written_out(document, key, schema)), "utf-8")
        told = {
            name: _run(work, f"{name}.json", service.port, token, examples)
            for name in ("general", "written_out")
        }
    finally:
        service.stop()
    rows, items = stored(data), len(read_questionnaire(ASSETS / "questionnaires" / f"{key}.toml").items)
    return {
        "examples": examples,
        "failures": sum(code != 0 for code, _ in told.values()),
        "cases": sum(cases for _, cases in told.values()),
        "answers_stored": sum(count == items for count in rows.values()),
    }


def _run(work: Path, name: str, port: int, token: str, examples: int) -> tuple[int, int]:
    report = work / f"{name}.junit.xml"
    command = [str(Path(sys.executable).with_name("schemathesis")), "--config-file", "schemathesis.toml"]
    command += ["run", name, "--url", f"http://127.0.0.1:{port}", "--checks", "all", "--seed", "20"]
    command += ["--max-examples", str(examples), "--continue-on-failure", "--no-color"]
    command += [
        "-H",
        f"Authorization: Bearer {token}",
        "--report",
        "junit",
        "--report-junit-path",
        str(report),
    ]
    done = subprocess.run(command, cwd=work, capture_output=True, text=True, check=False)
    if done.returncode:
        print(done.stdout[-12_000:], done.stderr[-2_000:], file=sys.stderr)
    found = [line for line in done.stdout.splitlines() if "generated" in line]
    digits = "".join(c for c in (found[-1].split("generated")[0] if found else "") if c.isdigit())
    return done.returncode, int(digits or 0)
