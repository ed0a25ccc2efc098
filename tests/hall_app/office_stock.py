"""A house in which every deed of the office has something to be done to, and how it is put back for the next."""

from __future__ import annotations

import json
import shutil
import uuid
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import Any

import event_loop
from office_clerk import Clerk
from open_counter import OpenCounter, answered

from hall_app.house.baking import Bake, BakingQueue
from hall_app.house.people.records import Plan

OWN = "X-Stock"  # header of what the stock asks for itself: neither counted nor prepared
POOL = 4  # of what is used up by being done
ANSWERS = 12
PASSWORD = "a robe of blue ramie"
# A scan that is text, since a description in JSON holds no other.
SCAN = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
TITLES = {"title_zh": "缂丝工作坊", "title_en": "Tapestry weaving"}


class Slow:
    """A bake that never ends by itself."""

    def poll(self) -> None:
        return None

    def line(self) -> str:
        return " 40% cloth <b>"

    def outcome(self) -> str:
        return ""

    def end(self) -> None:
        self.ended = True


@dataclass
class Stock:
    """names: operation -> name in its path -> ids that are there; given: operation -> a body it takes; asked: the same
    of its query. Operations are methods and paths of the description.
    """

    counter: OpenCounter
    clerk: Clerk
    names: dict[str, dict[str, list[str]]] = field(default_factory=dict)
    given: dict[str, dict[str, Any]] = field(default_factory=dict)
    asked: dict[str, dict[str, list[str]]] = field(default_factory=dict)
    _texts: dict[str, bytes] = field(default_factory=dict)
    _name: str = ""
    _person: str = ""
    _backup: bytes = b""

    @classmethod
    def of(cls, counter: OpenCounter, clerk: Clerk) -> Stock:
        made = cls(counter, clerk)
        made._exhibit()
        made._people()
        made._programme()
        made._survey()
        made._backups()
        made._bakes()
        return made

    def refresh(self, path: str) -> None:
        """Before a deed is asked for at that path of the API: what the last one did to its thing is taken back."""
        if path.startswith("collection/chest/"):
            self._exhibit_again(path.rpartition("/")[2])
        elif path == f"people/{self._person}/code":
            self.counter.people.accounts.close("console", self._person, closed=False)
        elif path.startswith("backups/"):
            kept = self.counter.data / "backups" / self._name
            if not kept.exists():
                kept.write_bytes(self._backup)
            shutil.rmtree(self.counter.data / "restored", ignore_errors=True)
        elif path.startswith("restored/"):
            (self.counter.data / "restored" / "hall-20200101-000000").mkdir(parents=True, exist_ok=True)

    def _tell(self, path: str, given: object = None) -> Any:
        """As Clerk.told, and marked as the stock's own."""
        told = {OWN: "1", "Origin": self.clerk.url, "X-Seal": self.clerk.seal}
        body = None if given is None else json.dumps(given).encode()
        kind = {} if given is None else {"Content-Type": "application/json"}
        answer = self.clerk.ask("GET" if given is None else "POST", f"/api/office/{path}", body, told | kind)
        assert answer.status == 200, answer.text
        return json.loads(answer.body)

    def _exhibit(self) -> None:
        """The chest as it was published twice: the second publication can be undone."""
        home, one = self.counter.content / "exhibits" / "chest", "collection/chest"
        for text in ("first", "second"):
            self._tell(f"{one}/fields", {"caption.zh": "一只箱子", "caption.en": f"A chest, {text}"})
            self._tell(f"{one}/publish", {})
            self._texts[text] = (home / "exhibit.toml").read_bytes()
        newest = max(entry["id"] for entry in self._tell(f"{one}/history"))
        for path in (
            *("", "/text", "/file", "/picture", "/shape", "/preview", "/place", "/history"),
            *("/fields", "/upload", "/remove", "/drop", "/publish", "/undo"),
        ):
            for method in ("GET", "POST"):
                self.names[f"{method} collection/{{key}}{path}"] = {"key": ["chest"]}
        self.asked["GET collection/{key}/text"] = {"file": ["exhibit.toml", "text.zh.md"]}
        self.asked["GET collection/{key}/file"] = {"name": ["media/front.jpg", "media/chest.glb"]}
        for path in ("picture", "shape"):
            self.asked[f"GET collection/{{key}}/{path}"] = {"name": ["media/chest.glb"]}
        self.given |= {
            "POST collection": {"id": "new-one", "title.zh": "新箱", "title.en": "A new chest"},
            "POST collection/{key}/fields": {"title.zh": "旧箱", "title.en": "An old chest"},
            "POST collection/{key}/text": {"file": "text.en.md", "text": "A chest of camphor wood.\n"},
            "POST collection/{key}/upload": {"use": "scan", "file": SCAN},
            "POST collection/{key}/remove": {"file": "media/front.jpg"},
            "POST collection/{key}/place": {"place.x": 1.5, "place.z": -1.0},
            "POST collection/{key}/undo": {"revision": newest},
        }
        self._exhibit_again("drop")
        self.given["POST collection/{key}/drop"] = {
            "seen": self._tell(one)["mark"]
        }  # the same for the same files

    def _exhibit_again(self, deed: str) -> None:
        home = self.counter.content / "exhibits" / "chest"
        self._drop()
        if (home / "exhibit.toml").read_bytes() != self._texts["second"]:
            (home / "exhibit.toml").write_bytes(self._texts["second"])
        if deed in ("publish", "drop"):
            self._tell("collection/chest/fields", {"licence": "CC-BY-4.0"})

    def _drop(self) -> None:
        if (told := self._tell("collection/chest"))["draft"]:
            self._tell("collection/chest/drop", {"seen": told["mark"]})

    def _people(self) -> None:
        people = self.counter.people
        person = people.accounts.make("console", "stock@example.org")
        self._person = person.id
        people.accounts.use_code(people.accounts.code_for("console", person.id), PASSWORD)
        people.sessions.sign_in("stock@example.org", PASSWORD, "", office=False)
        for path in ("", "/roles", "/code", "/close", "/open", "/sign-out", "/second-factor"):
            for method in ("GET", "POST"):
                self.names[f"{method} people/{{key}}{path}"] = {"key": [person.id]}
        leaving = people.accounts.make("console", "leaving@example.org")
        self.names["POST people/{key}/delete"] = {"key": [leaving.id]}
        self.given["POST people/{key}/delete"] = {"address": leaving.address}
        self.asked["GET people"] = {"q": ["stock"]}
        self.given |= {
            "POST people": {"address": "somebody@example.org", "name": "Somebody"},
            "POST people/{key}/roles": {"roles": ["curator"]},
        }

    def _programme(self) -> None:
        soon = datetime.now(UTC).replace(microsecond=0) + timedelta(days=2)
        times = {"begins": soon, "ends": soon + timedelta(hours=1)}
        plan = Plan(kind="activity", places=20, party=4, **times, **TITLES)
        people, told = self.counter.people, {name: at.isoformat() for name, at in times.items()}
        kept, *off = people.occasions.plan("console", *[plan] * (POOL + 1))
        for method in ("GET", "POST"):
            self.names[f"{method} events/{{key}}"] = {"key": [kept]}
        self.names["POST events/{key}/off"] = {"key": off}
        guests = [people.accounts.make("console", f"guest{n}@example.org").id for n in range(POOL + 1)]
        made = [people.bookings.book(guest, kept, 1, f"{guest}-form") for guest in guests]
        first, *others = made
        for deed, booked in (("arrive", [first]), ("leave", [first]), ("cancel", others)):
            path = f"POST events/{{key}}/bookings/{{booking}}/{deed}"
            self.names[path] = {"key": [kept], "booking": [str(one.id) for one in booked]}
            self.given[path] = {"turn": booked[0].turn}
        whole = {"kind": "activity", "places": 20, "party": 4} | told | TITLES
        self.given |= {"POST events": whole, "POST events/{key}": whole}
        self.given["POST visits"] = whole | {"kind": "visit", "minutes": 20}
        self.given["POST events/{key}/off"] = {"sure": True}
        self.asked["GET day"] = {"day": [f"{soon.astimezone():%Y-%m-%d}"]}
        self.asked["GET events"] = {"past": ["1"]}

    def _survey(self) -> None:
        asked = json.loads(self.clerk.get("/api/v1/questionnaires/garment").text)
        items = [item["id"] for module in asked["modules"] for item in module["items"]]
        for number in range(ANSWERS):
            told = {"id": str(uuid.uuid4()), "version": asked["version"], "language": "zh", "consent": True}
            scores = {item: 1 + (number * (3 + at % 4) + at) % 5 for at, item in enumerate(items)}
            answer = self.clerk.ask(
                "POST",
                "/api/v1/questionnaires/garment/submissions",
                json.dumps(told | {"scores": scores}).encode(),
                {"Content-Type": "application/json"},
            )
            assert answer.status in (200, 201), answer.text
        for path in ("analysis", "export"):
            self.names[f"GET questionnaires/{{key}}/{path}"] = {"key": ["garment"]}
        self.asked["GET questionnaires/{key}/export"] = {"kind": ["csv"]}
        answered(self.counter)
        (said, *_) = self.counter.survey.suggestions()
        self.names["POST suggestions/{key}"] = {"key": [said["id"]]}
        self.given["POST suggestions/{key}"] = {"state": "answered", "note": "Letters of 18 px"}
        for number in range(POOL):
            self._tell("tokens", {"label": f"of number {number}"})
        numbers = [str(one["id"]) for one in self._tell("tokens")]
        self.names["POST tokens/{key}/revoke"] = {"key": numbers}
        self.given["POST tokens"] = {"label": "for the paper"}

    def _backups(self) -> None:
        self._name = self._tell("backups", {})["name"]
        self._backup = (self.counter.data / "backups" / self._name).read_bytes()
        for path in ("GET backups/{key}/file", "POST backups/{key}/remove", "POST backups/{key}/restore"):
            self.names[path] = {"key": [self._name]}
        self.given["POST backups/{key}/restore"] = {"name": self._name}
        self.names["POST restored/{key}/remove"] = {"key": ["hall-20200101-000000"]}
        self.given["POST restored/{key}/remove"] = {"name": "hall-20200101-000000"}

    def _bakes(self) -> None:
        """One that runs, which may be stopped, and one that failed, which may be tried again."""
        queue = BakingQueue(lambda _: Slow())
        event_loop.run(queue.want((Bake("chest", "1"), Bake("room", "2", patient=True))))
        queue.ask("stop", "room")
        queue.stopped()
        self.counter.house.queue = queue
        self.names["POST bakes/{key}/stop"] = {"key": ["chest"]}
        self.names["POST bakes/{key}/again"] = {"key": ["room"]}
