"""Visitors' waiting while researchers export and analyse a large store, and how long the analysis takes."""

from __future__ import annotations

import http.client
import json
import os
import statistics
import subprocess
import sys
import threading
import time
import uuid
from contextlib import closing
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
from survey_service import ASSETS, ROOT, Service, submission

from survey import Store, read_questionnaire
from survey.questionnaire import Questionnaire
from survey.store.database import tables

KEY, ITEMS = "wide", 25
FORMATS = ("csv", "xlsx", "sav", "json")


def content(work: Path) -> Path:
    """A content folder with one questionnaire of 25 items and the garment's, which visitors answer meanwhile."""
    folder = work / "content" / "questionnaires"
    folder.mkdir(parents=True)
    garment = ASSETS / "questionnaires" / "garment.toml"
    (folder / garment.name).write_bytes(garment.read_bytes())
    head, _, _ = garment.read_text("utf-8").partition("[[module]]")
    told = head.replace('id = "garment"', f'id = "{KEY}"')
    told += '[[module]]\nid = "all"\ntitle = { zh = "全部", en = "All" }\n'
    told += 'suggestion = { zh = "建议", en = "Suggestions" }\n'
    for at in range(ITEMS):
        told += f'[[module.item]]\nid = "item_{at}"\nlabel = {{ zh = "项{at}", en = "Item {at}" }}\n'
    (folder / f"{KEY}.toml").write_text(told, "utf-8")
    return work / "content"


def fill(data: Path, asked: Questionnaire, n: int) -> str:
    """n answers to any questionnaire with three factors, a text in every tenth; a token to read them with."""
    rng = np.random.default_rng(19)
    wide = len(asked.item_ids)
    loads = 0.8 * (np.arange(wide)[:, None] % 3 == np.arange(3))
    drawn = rng.normal(size=(n, 3)) @ loads.T + 0.6 * rng.normal(size=(n, wide))
    scores = np.clip(np.rint(3 + drawn), 1, 5).astype(int).tolist()
    with closing(Store(data)) as store:
        store.publish(asked)
        token = store.tokens.make("bench")
        start, items = datetime(2026, 1, 1, tzinfo=UTC), asked.item_ids
        for low in range(0, n, 5000):
            ids = [str(uuid.UUID(bytes=rng.bytes(16), version=4)) for _ in scores[low : low + 5000]]
            same = {"questionnaire": asked.id, "version": asked.version, "digest": ""}
            heads = [
                {"id": one, "language": "zh" if at % 3 else "en", "exhibit": "pibo" if at % 2 else None}
                | {"received": start + timedelta(seconds=low + at)}
                | same
                for at, one in enumerate(ids)
            ]
            rows = [
                {"submission": one, "item": item, "score": point}
                for one, line in zip(ids, scores[low : low + 5000], strict=True)
                for item, point in zip(items, line, strict=True)
            ]
            texts = [
                {"submission": one, "module": asked.modules[0].id, "text": "袖口可以再宽一些"}
                for one in ids[::10]
            ]
            with store._write() as connection:
                for table, found in (
                    (tables.submission, heads),
                    (tables.answer, rows),
                    (tables.suggestion, texts),
                ):
                    connection.execute(table.insert(), found)
    return token


class _Visitors:
    """Two who submit and two who read results, each with a request after the other; how long each took."""

    def __init__(self, port: int) -> None:
        self.port, self.over = port, threading.Event()
        self.garment = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
        self.times: dict[str, list[float]] = {"submissions": [], "results": []}
        self.unexpected: dict[str, int] = {}
        self.threads = [threading.Thread(target=self._go, args=(what,)) for what in [*self.times] * 2]

    def _go(self, what: str) -> None:
        with closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)) as line:
            while not self.over.is_set():
                start = time.perf_counter()
                base = "/api/v1/questionnaires/garment"
                if what == "submissions":
                    body = json.dumps(submission(self.garment))
                    line.request("POST", f"{base}/submissions", body, {"Content-Type": "application/json"})
                else:
                    line.request("GET", f"{base}/results")
                reply = line.getresponse()
                reply.read()
                self.times[what].append(time.perf_counter() - start)
                if reply.status not in (200, 201):
                    self.unexpected[str(reply.status)] = self.unexpected.get(str(reply.status), 0) + 1
                time.sleep(0.1)  # so few that their own answers do not weigh on what is measured

    def __enter__(self) -> _Visitors:
        for thread in self.threads:
            thread.start()
        return self

    def __exit__(self, *_) -> None:
        self.over.set()
        for thread in self.threads:
            thread.join()

    def told(self) -> dict:
        return {
            what: {
                "n": len(times),
                "p50_ms": 1e3 * statistics.median(times),
                "p99_ms": 1e3 * sorted(times)[int(0.99 * len(times))],
            }
            for what, times in self.times.items()
        }


def _fetch(port: int, token: str, path: str) -> tuple[float, int, int]:
    """Seconds, status and bytes of one request."""
    start = time.perf_counter()
    with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=600)) as line:
        line.request(
            "GET", f"/api/v1/questionnaires/{KEY}/{path}", headers={"Authorization": f"Bearer {token}"}
        )
        reply = line.getresponse()
        size = len(reply.read())
    return time.perf_counter() - start, reply.status, size


def exported(work: Path, answers: int, seconds: float) -> dict:
    """p50 and p99 of visitors alone and beside back-to-back exports, seconds of each export and of the analysis."""
    folder, data = content(work), work / "exports"
    token = fill(data, read_questionnaire(folder / "questionnaires" / f"{KEY}.toml"), answers)
    service = Service(data, content=folder)
    spent: dict[str, float] = {}
    bad: dict[str, int] = {}
    try:
        _fetch(service.port, token, "export/codebook")  # whatever the first request loads
        with _Visitors(service.port) as alone:
            time.sleep(seconds)
        with _Visitors(service.port) as visitors:
            for kind in (*(f"export/{kind}" for kind in FORMATS), "analysis"):
                took, status, _ = _fetch(service.port, token, kind)
                spent[kind.removeprefix("export/")] = took
                if status != 200:
                    bad[str(status)] = bad.get(str(status), 0) + 1
        over_http, status, _ = _fetch(service.port, token, "analysis")
        start = time.perf_counter()
        command = [
            sys.executable,
            "-m",
            "survey.cli",
            "analyse",
            "--questionnaire",
            KEY,
            "--json",
        ]
        command += ["--content", str(folder), "--data", str(data)]
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        subprocess.run(
            command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment
        )
        by_command = time.perf_counter() - start
    finally:
        service.stop()
    return {
        "answers": answers,
        "items": ITEMS,
        "alone": alone.told(),
        **visitors.told(),
        "export_s": spent,
        "analysis_s": {"http": over_http, "command": by_command},
        "unexpected": alone.unexpected
        | visitors.unexpected
        | bad
        | ({} if status == 200 else {str(status): 1}),
    }
