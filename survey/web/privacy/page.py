"""The privacy page's HTML: a record in, a page out; every text from outside is escaped."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from html import escape
from pathlib import Path

from survey.questionnaire import Language, Questionnaire, Text
from survey.store.publication import STEP
from survey.web.form import document, heading
from survey.web.privacy.controller import CONTROLLER_FILE, Contact
from survey.web.privacy.record import Record

__all__ = ["privacy_page"]


@lru_cache(maxsize=1)
def _texts() -> dict[str, dict[str, str]]:
    return tomllib.loads(Path(__file__).with_name("texts.toml").read_text("utf-8"))


def privacy_page(
    record: Record, language: Language, *, scheme: str | None = None, alone: bool = False
) -> str:
    """The page in a language. scheme: by which it is asked for, http or https; alone: it is made for a file."""
    page = _Page(record, language, scheme)
    say = page.say
    head = heading(say["title"], page.said("intro", date=record.today.isoformat()), language, None)
    sections = [
        page.incomplete(),
        page.section("who", page.who()),
        page.section("what", page.lines("kept", "not_kept", "device", "whose")),
        page.section("why", page.why()),
        page.section("recipients", page.recipients()),
        page.section("rights", page.rights()),
        page.section("safety", page.safety()),
        f'<p class="small">{escape(say["print"])}</p>',
    ]
    return document(say["title"], language, head + "".join(sections), script=False, base="./", alone=alone)


class _Page:
    """The sections of one language; each part is HTML."""

    def __init__(self, record: Record, language: Language, scheme: str | None) -> None:
        self.record, self.scheme = record, scheme
        self.language: Language = language
        self.say = _texts()[language]

    def said(self, key: str, /, **told: object) -> str:
        return self.say[key].format(**told)

    def section(self, key: str, body: str) -> str:
        return f'<section class="module"><h2>{escape(self.say[key])}</h2>{body}</section>'

    def lines(self, *keys: str) -> str:
        return self.list([self.say[key] for key in keys])

    def list(self, texts: list[str]) -> str:
        return f'<ul class="told">{"".join(f"<li>{escape(text)}</li>" for text in texts)}</ul>'

    def incomplete(self) -> str:
        statement = self.record.statement
        if not statement.problems:
            return ""
        keys = (", " if self.language == "en" else "、").join(statement.controller.missing)
        told = self.said(
            "faulty_text" if statement.faults else "missing_text", file=CONTROLLER_FILE, keys=keys
        )
        title = escape(self.say["missing_title"])
        return f'<div class="notice"><strong>{title}</strong>{escape(told)}</div>'

    def labelled(self, key: str, found: Text | str | None) -> str:
        """What is stated under its name, or that it is not yet."""
        stated = found.in_language(self.language) if isinstance(found, Text) else found
        return self.said("labelled", label=self.say[key], text=stated or self.say["missing"])

    def contact(self, found: Contact, key: str) -> str:
        """Name, address and mail; where the law asks for all three, what is not there is said."""
        whole = key == "controller"
        if found == Contact():
            return escape(self.say["missing"])
        name = None if found.name is None else found.name.in_language(self.language)
        parts = [name or self.labelled("name", None)]
        if found.address is not None or whole:
            parts.append(self.labelled("address", found.address))
        if found.email is not None or whole:
            parts.append(self.labelled("email", found.email))
        return "<br>".join(escape(part) for part in parts)

    def who(self) -> str:
        found = self.record.statement.controller
        officer = escape(self.say["no_officer"])
        if found.officer is not None:
            officer = self.contact(found.officer, "officer")
        rows = (
            ("controller", self.contact(found.controller, "controller")),
            ("officer", officer),
            ("authority", self.contact(found.authority, "authority")),
        )
        told = "".join(f"<dt>{escape(self.say[key])}</dt><dd>{value}</dd>" for key, value in rows)
        return f'<dl class="told">{told}</dl>'

    def why(self) -> str:
        keys = ("questionnaire", "purpose", "retention")
        head = "".join(f'<th scope="col">{escape(self.say[key])}</th>' for key in keys)
        rows = "".join(map(self.asked, self.record.asked))
        told = "".join(f"<p>{escape(text)}</p>" for text in self.erased())
        return (
            f"<p>{escape(self.say['basis'])}</p>"
            f'<table class="told"><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{told}'
        )

    def asked(self, asked: Questionnaire) -> str:
        """A row on one version: what it is called, what was consented to, how long it is kept."""
        kept = self.say["no_end"]
        if asked.retain_until is not None:
            key = "overdue" if self.record.overdue(asked) else "until"
            kept = self.said(key, date=asked.retain_until.isoformat())
        title = escape(asked.title.in_language(self.language))
        version = escape(self.said("version", id=asked.id, version=asked.version))
        consent, label = asked.consent.in_language(self.language), self.say["retention"]
        return (
            f'<tr><th scope="row">{title} <span class="small">{version}</span></th><td>{escape(consent)}</td>'
            f'<td data-label="{escape(label)}">{escape(kept)}</td></tr>'
        )

    def erased(self) -> list[str]:
        """What has become of answers whose time is over, and where an end is set that there is not yet."""
        purged = self.record.purged
        last = self.say["never_purged"] if purged is None else self.said("purged", date=f"{purged:%Y-%m-%d}")
        endless = any(asked.retain_until is None for asked in self.record.asked)
        return [self.say["end_where"], last] if endless else [last]

    def recipients(self) -> str:
        others = self.record.statement.controller.others
        return self.list(
            [
                self.said("tokens", n=self.record.tokens),
                self.said("public", n=STEP),
                self.labelled("others", others.recipients),
                self.labelled("transfers", others.transfers),
                self.say["profiling"],
            ]
        )

    def rights(self) -> str:
        frozen = self.record.frozen
        fixed = (
            self.said("erase_frozen", names=", ".join(sorted(frozen))) if frozen else self.say["erase_later"]
        )
        return self.list([self.say["erase"], fixed, self.say["copies"], self.say["access"]])

    def safety(self) -> str:
        record, running = self.record, self.record.running
        told = [
            self.say["sqlite"] if record.database == "sqlite" else self.said("server", name=record.database)
        ]
        if record.others_read is not None:
            told.append(self.say["open" if record.others_read else "closed"])
        if record.database == "sqlite":  # how far a server goes is its own setting
            told.append(self.say["synced"])
        if running.per_minute is None:
            told.append(self.say["limit_unknown"])
        else:
            told.append(
                self.said("limited", n=running.per_minute) if running.per_minute else self.say["unlimited"]
            )
        if running.proxies is None:
            told.append(self.say["proxy_unknown"])
        else:
            n = len(running.proxies)
            told.append(self.said("proxies", n=n) if n else self.say["no_proxy"])
        told.append(self.say["token_hash"])
        if self.scheme is not None:
            told.append(self.say["https" if self.scheme == "https" else "http"])
        return self.list(told)
