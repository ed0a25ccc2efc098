"""A browser without pictures: keeps cookies, reads forms and sends them as a browser would."""

import http.client
import urllib.parse
from dataclasses import dataclass, field
from html.parser import HTMLParser
from urllib.parse import urlencode, urlsplit


class Forms(HTMLParser):
    """The forms of a page: id or action -> its address and the fields that stand in it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.all: list[tuple[str, str, dict[str, str]]] = []
        self._choices = self._typed = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs) -> None:
        given = dict(attrs)
        if tag == "form":
            self.all.append((given.get("id", ""), given.get("action", ""), {}))
        elif tag == "input" and self.all and "name" in given:
            if given.get("type") != "checkbox" or "checked" in given:
                self.all[-1][2][given["name"]] = given.get("value", "")
        elif tag in ("select", "textarea") and self.all:
            self._choices = given["name"]
            self.all[-1][2].setdefault(self._choices, "")
            self._typed = self._choices if tag == "textarea" else ""
        elif tag == "option" and "selected" in given:
            self.all[-1][2][self._choices] = given["value"]

    def handle_data(self, data) -> None:
        if self._typed and self.all:
            self.all[-1][2][self._typed] += data

    def handle_endtag(self, tag) -> None:
        if tag == "textarea" and self._typed:
            fields = self.all[-1][2]
            fields[self._typed] = fields[self._typed].removeprefix("\n")
            self._typed = ""


@dataclass
class Answer:
    status: int
    headers: http.client.HTTPMessage
    body: bytes
    address: str

    @property
    def text(self) -> str:
        return self.body.decode()

    def form(self, named: str, **fields: str) -> dict[str, str]:
        """The fields of the form whose id or action is `named` and whose fields have the values of `fields`."""
        for key, action, given in Forms(self.text).all:
            if named in (key, action) and fields.items() <= given.items():
                return given
        raise AssertionError(f"no form {named} at {self.address}")


@dataclass
class Visitor:
    """Of one hall. url: of the hall."""

    url: str
    cookies: dict[str, str] = field(default_factory=dict)

    def ask(self, method: str, path: str, body: bytes | None = None, headers: dict | None = None) -> Answer:
        """One request, redirections not followed."""
        where = urlsplit(self.url)
        line = http.client.HTTPConnection(where.hostname or "", where.port, timeout=120)
        told = {"Cookie": "; ".join(f"{name}={value}" for name, value in self.cookies.items())}
        line.request(method, urllib.parse.quote(path, safe="/?=&%#"), body, told | (headers or {}))
        answer = line.getresponse()
        data = answer.read()
        line.close()
        for cookie in answer.headers.get_all("Set-Cookie") or ():
            name, _, value = cookie.partition(";")[0].partition("=")
            self.cookies[name] = value.strip('"')
            if not value.strip('"'):
                del self.cookies[name]
        return Answer(answer.status, answer.headers, data, path)

    def get(self, path: str) -> Answer:
        """Follows redirections."""
        answer = self.ask("GET", path)
        while answer.status in (302, 303, 307):
            answer = self.ask("GET", answer.headers["Location"].partition("#")[0])
        return answer

    def post(self, path: str, fields: dict[str, str], **headers: str) -> Answer:
        """As the browser sends a form of this hall; redirections not followed."""
        told = {"Content-Type": "application/x-www-form-urlencoded", "Origin": self.url} | {
            name.replace("_", "-"): value for name, value in headers.items()
        }
        return self.ask("POST", path, urlencode(fields).encode(), told)

    def send(
        self, page: str | Answer, named: str, *, found: dict[str, str] | None = None, **fields: str
    ) -> Answer:
        """Fill in the form of that id or action on a page, send it, follow where it leads.

        found: values by which one of several forms is told.
        """
        shown = self.get(page) if isinstance(page, str) else page
        answer = self._sent(shown, named, found or {}, fields)
        while answer.status in (302, 303, 307):
            answer = self.ask("GET", answer.headers["Location"].partition("#")[0])
        return answer

    def _sent(self, shown: Answer, named: str, found: dict[str, str], fields: dict[str, str]) -> Answer:
        for key, action, given in Forms(shown.text).all:
            if named in (key, action) and found.items() <= given.items():
                return self.post(action, given | fields)
        raise AssertionError(
            f"no form {named} at {shown.address}: {[one[:2] for one in Forms(shown.text).all]}"
        )
