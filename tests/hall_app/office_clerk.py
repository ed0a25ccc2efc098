"""Somebody of the staff, at work by pages and by program."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, field

from form_visitor import Answer, Visitor

from hall_app.house.people import People, Role

PASSWORD = "a robe of blue ramie"
NUMBERS = itertools.count()


@dataclass
class Clerk(Visitor):
    """Somebody at work in the office, by pages and by program."""

    person: str = ""
    seal: str = field(default="", repr=False)

    def api(self, path: str, given: object = None) -> Answer:
        """GET, or POST of `given`."""
        if given is None:
            return self.ask("GET", f"/api/office/{path}")
        told = {"Content-Type": "application/json", "Origin": self.url, "X-Seal": self.seal}
        return self.ask("POST", f"/api/office/{path}", json.dumps(given).encode(), told)

    def bring(self, exhibit: str, files: list[tuple[str, bytes]], **fields: str) -> Answer:
        """Files as a form brings them. files: name and content."""
        edge, parts = b"----edge-of-a-form", []
        for name, value in fields.items():
            parts.append(
                b'Content-Disposition: form-data; name="' + name.encode() + b'"\r\n\r\n' + value.encode()
            )
        for name, data in files:
            told = name.encode("utf-8", "surrogateescape").replace(b'"', b"%22")
            head = b'Content-Disposition: form-data; name="file"; filename="' + told + b'"\r\n'
            parts.append(head + b"Content-Type: text/html\r\n\r\n" + data)
        body = b"".join(b"--" + edge + b"\r\n" + part + b"\r\n" for part in parts) + b"--" + edge + b"--\r\n"
        kind = f"multipart/form-data; boundary={edge.decode()}"
        told = {"Content-Type": kind, "Origin": self.url, "X-Seal": self.seal}
        return self.ask("POST", f"/api/office/collection/{exhibit}/upload", body, told)

    def drop(self, exhibit: str) -> None:
        """Its draft, as it is now."""
        at = f"collection/{exhibit}"
        self.told(f"{at}/drop", {"seen": self.told(at)["mark"]})

    def told(self, path: str, given: object = None):
        answer = self.api(path, given)
        assert answer.status == 200, answer.text
        return json.loads(answer.body)


def clerk(hall, people: People, role: Role) -> Clerk:
    address = f"{role}{next(NUMBERS)}@example.org"
    person = people.accounts.sign_up(address, PASSWORD)
    people.roles.set("console", person.id, frozenset({role}))
    one = Clerk(hall.url, person=person.id)
    entered = one.send("/office?lang=en", "form-sign-in", address=address, password=PASSWORD)
    assert "Sign out" in entered.text
    one.seal = one.told("me")["seal"]
    return one
