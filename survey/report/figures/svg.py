"""How every figure of the report is drawn: by matplotlib, as SVG, with the browser's fonts.

Text stays text (svg.fonttype none), so Chinese needs no font on the server; matplotlib then measures it with a font
that lacks the characters and says so for every glyph, which is silenced here and nowhere else.
"""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = [
    "BLUE",
    "INK",
    "MARKERS",
    "QUIET",
    "RED",
    "RULE",
    "SERIES",
    "WIDTH",
    "figure_of",
    "style",
    "svg_of",
]

INK, QUIET, RULE = "#1c1a18", "#6f6a64", "#d8d2ca"
RED, BLUE = "#9d2f2a", "#2b5077"
SERIES = ("#2b5077", "#9d2f2a", "#4c7a51", "#b5812f", "#6b4c86", "#3f8a92")
MARKERS = "osD^vP"
FONT = "'Source Sans 3', 'Helvetica Neue', Arial, 'Noto Sans CJK SC', 'Source Han Sans SC', sans-serif"
WIDTH = 7.2  # [inch] of the text column


@contextmanager
def style() -> Iterator[None]:
    """The house's look, for as long as a figure is drawn."""
    import matplotlib

    settings: dict[Any, Any] = {
        "svg.fonttype": "none", "svg.hashsalt": "survey", "font.family": "sans-serif", "font.size": 8.5,
        "font.sans-serif": ["DejaVu Sans"], "axes.edgecolor": QUIET, "axes.labelcolor": INK, "text.color": INK,
        "xtick.color": QUIET, "ytick.color": QUIET, "xtick.labelcolor": INK, "ytick.labelcolor": INK,
        "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "axes.spines.top": False,
        "axes.spines.right": False, "axes.unicode_minus": True, "path.simplify": False,
    }  # fmt: skip
    with matplotlib.rc_context(settings), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing", category=UserWarning)
        yield


def figure_of(width: float, height: float) -> Any:
    """An empty figure of so many inches."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasSVG(figure)
    return figure


def svg_of(figure: Any, name: str, title: str) -> str:
    """The <svg> element alone, ids made unique to `name`, scaled by the page."""
    file = io.StringIO()
    figure.savefig(file, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = file.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{name}-", text)
    text = re.sub(r"'DejaVu Sans'(, sans-serif)?", FONT, text)
    text = re.sub(
        r'<svg [^>]*?viewBox="([^"]*)"[^>]*>',
        r'<svg viewBox="\1" role="img" xmlns="http://www.w3.org/2000/svg"'
        r' xmlns:xlink="http://www.w3.org/1999/xlink">',
        text,
        count=1,
    )
    label = title.replace("&", "&amp;").replace("<", "&lt;")
    return text.replace(">", f"><title>{label}</title>", 1)
