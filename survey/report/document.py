"""The HTML document around the report's two halves: style, and the one script that turns the language."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from pathlib import Path

__all__ = ["document"]


def document(bodies: Iterable[str], english: str, chinese: str) -> str:
    """One page of both languages' <article>; english, chinese: its titles."""
    style = (Path(__file__).parent / "style.css").read_text("utf-8")
    # The only script: which of the two languages is shown. Without scripts both are, one after the other.
    script = (
        "const root=document.documentElement,both="
        + f'{{en:"{_quoted(english)}",zh:"{_quoted(chinese)}"}};'
        + "function show(l){root.className=l;root.lang=l==='zh'?'zh-Hans':'en';document.title=both[l]}"
        + "function turn(){show(root.className==='zh'?'en':'zh');scrollTo(0,0)}"
        + "show(location.hash==='#zh'||location.hash!=='#en'&&/^zh/i.test(navigator.language)?'zh':'en');"
    )
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(english)}</title>
<link rel="icon" href="data:,">
<style>{style}</style>
<script>{script}</script>
</head>
<body>
{"".join(bodies)}
</body>
</html>
"""


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ")
    return escaped.replace("<", "\\u003c").replace("\u2028", " ").replace("\u2029", " ")
