"""Forms as HTML: a label to every field, its hint read with it, the seal in every form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape

from hall_app.web.platform.counter.asking import Asking
from hall_app.web.platform.counter.guard import SEAL

__all__ = ["Field", "button", "form"]


@dataclass(frozen=True)
class Field:
    """One field. kind: of an input, "select", "textarea" or "check"; choices: value -> words; given: other attributes.

    keep: whether what was typed stands there again when the form is refused; a password never does.
    """

    name: str
    label: str
    kind: str = "text"
    value: str = ""
    hint: str = ""
    needed: bool = True
    choices: Mapping[str, str] = field(default_factory=dict)
    given: Mapping[str, str] = field(default_factory=dict)

    def html(self, asking: Asking, prefix: str) -> str:
        key, value = f"{prefix}-{self.name}", self.value
        if self.kind != "password" and asking.refusal and asking.form.get("of") == prefix:
            value = asking.form.get(self.name, "")
        more = "".join(f' {name}="{escape(told)}"' for name, told in self.given.items())
        more += f' aria-describedby="{key}-hint"' if self.hint else ""
        more += " required" if self.needed and self.kind != "check" else ""
        hint = f'<span class="hint" id="{key}-hint">{escape(self.hint)}</span>' if self.hint else ""
        name, label = escape(self.name), escape(self.label)
        if self.kind == "check":
            ticked = " checked" if value else ""
            box = f'<input type="checkbox" id="{key}" name="{name}" value="on"{ticked}{more}>'
            return f'<p class="field tick">{box}<label for="{key}">{label}</label>{hint}</p>'
        return f'<p class="field"><label for="{key}">{label}</label>{hint}{self._input(key, value, more)}</p>'

    def _input(self, key: str, value: str, more: str) -> str:
        name = escape(self.name)
        if self.kind == "select":
            listed = "".join(
                f'<option value="{escape(one)}"{" selected" if one == value else ""}>{escape(words)}</option>'
                for one, words in self.choices.items()
            )
            return f'<select id="{key}" name="{name}"{more}>{listed}</select>'
        if self.kind == "textarea":
            rows = "" if "rows" in self.given else ' rows="4"'
            # A browser leaves out a line break that comes first.
            return f'<textarea id="{key}" name="{name}"{rows}{more}>\n{escape(value)}</textarea>'
        kept = "" if self.kind == "password" else f' value="{escape(value)}"'
        return f'<input type="{self.kind}" id="{key}" name="{name}"{kept}{more}>'


def form(
    asking: Asking,
    key: str,
    to: str,
    fields: tuple[Field, ...],
    words: str,
    *,
    hidden: Mapping[str, str] | None = None,
    style: str = "",
) -> str:
    """A form that is sent to the path `to`. key: names it within the page; words: on its button."""
    here = asking.form.get("of") == key and asking.refusal
    why = f'<p class="refused" role="alert">{escape(asking.refusal)}</p>' if here else ""
    inside = "".join(one.html(asking, key) for one in fields)
    kept = {SEAL: asking.seal, "lang": asking.lang, "of": key} | dict(hidden or {})
    unseen = "".join(
        f'<input type="hidden" name="{escape(name)}" value="{escape(value)}">' for name, value in kept.items()
    )
    kind = f' class="{style}"' if style else ""
    return f"""<form method="post" action="{escape(to)}" id="form-{key}"{kind}>{why}{unseen}{inside}
<p class="send"><button>{escape(words)}</button></p></form>"""


def button(
    asking: Asking, key: str, to: str, words: str, *, about: str = "", hidden: Mapping[str, str]
) -> str:
    """A form of one button. about: what it is done to, for who hears the page."""
    kept = {SEAL: asking.seal, "lang": asking.lang, "of": key} | dict(hidden)
    unseen = "".join(
        f'<input type="hidden" name="{escape(name)}" value="{escape(value)}">' for name, value in kept.items()
    )
    spoken = f'<span class="unseen"> {escape(about)}</span>' if about else ""
    return f"""<form method="post" action="{escape(to)}" class="small-act">{unseen}
<button class="plain">{escape(words)}{spoken}</button></form>"""
