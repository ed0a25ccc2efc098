"""What is written round a drawing: title, facts, sett and author, colours with their yarns, the foot."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim_core.weave.files.sources import ASSUMED

if TYPE_CHECKING:
    from sim_core.weave.chart.values import Swatch, View, Window
    from sim_core.weave.files.sources import Source

__all__ = ["MOST_SHAFTS", "credits_of", "facts_of", "foot_of", "swatches_of", "title_of"]

MOST_SHAFTS = 80  # more are no loom with shafts: only the drawdown is drawn
MOST_SWATCHES = 24
INCH = 0.0254


def one_line(name: str, most: int = 70) -> str:
    """One line of letters that can be printed."""
    line = " ".join("".join(letter if letter.isprintable() else " " for letter in name).split())
    return line if len(line) <= most else line[: most - 1] + "…"


def title_of(name: str) -> str:
    """The title of a draft; of a path that a program left there, the name of the file."""
    return one_line(re.split(r"[\\/]", name)[-1] if re.match(r"[A-Za-z]:\\|/\w+/", name) else name)


def facts_of(source: Source) -> str:
    """Size, loom, repeat, floats, and whether the cloth hangs together."""
    facts, factors, harness = source.facts, source.factors, source.harness
    how = "lift plan" if source.plan else f"{harness.tieup.shape[1]} treadles"
    picks, ends = factors.periods
    return (
        f"{factors.ends:,} ends x {factors.picks:,} picks · {harness.tieup.shape[0]:,} shafts, {how} · repeat "
        f"{_often(ends, factors.ends)} x {_often(picks, factors.picks)}{_longest(source)} · "
        + ("hangs together" if facts.integral else "falls apart")
    )


def _longest(source: Source) -> str:
    """The longest floats of the sides that have any."""
    told = [f"{one.longest} {side}" for side, one in source.floats.items() if one]
    return f" · longest float {', '.join(told)}" if told else ""


def _often(period: int, count: int) -> str:
    """A repeat, how often it is there, and what is left: "10 (3 times + 1)"."""
    times, rest = divmod(count, period)
    if times < 2:
        return f"{count:,}"
    return f"{period:,} ({times:,} times" + (f" + {rest:,})" if rest else ")")


def credits_of(source: Source) -> str:
    """Author, file, and sett with the width in the reed, as far as they are known."""
    parts = []
    if source.wif is not None:
        parts += [one_line(value.strip('" ')) for key, value in source.wif.text if key.lower() == "author"]
    if Path(source.path).suffix:  # a profile may be a word such as twill:1/3
        parts.append(one_line(Path(source.path).name))
    apart = (None, None) if source.wif is None else source.wif.spacing
    if source.made is not None and source.made[1] != ASSUMED:
        apart = source.made[0].end_spacing, source.made[0].pick_spacing
    ends, picks = apart
    if ends and picks:
        parts.append(
            f"sett {0.01 / ends:.3g} x {0.01 / picks:.3g} per cm ({INCH / ends:.3g} x {INCH / picks:.3g} per inch)"
        )
        parts.append(f"{source.factors.ends * ends * 100:.3g} cm in the reed")
    return " · ".join(part for part in parts if part)


def swatches_of(source: Source) -> tuple[Swatch, ...]:
    """Each colour of the draft with its number and how many ends and picks have it, the most frequent first."""
    size = len(source.palette)
    counts = [np.bincount(colours, minlength=size) for colours in (source.warp_colours, source.weft_colours)]
    used = np.flatnonzero(counts[0] + counts[1])
    used = used[np.argsort(-(counts[0] + counts[1])[used], kind="stable")]
    made: list[Swatch] = []
    for k in used[:MOST_SWATCHES].tolist():
        yarns = [
            f"{n:,} {what if n > 1 else what[:-1]}"
            for n, what in zip((int(count[k]) for count in counts), ("ends", "picks"), strict=True)
            if n
        ]
        red, green, blue = source.palette[k].tolist()
        made.append(((red, green, blue), f"colour {k + 1}: {', '.join(yarns)}"))
    if len(used) > MOST_SWATCHES:
        made.append((None, f"and {len(used) - MOST_SWATCHES} more colours"))
    return tuple(made)


def foot_of(source: Source, view: View, window: Window, blocks: set[str], marked: bool) -> str:
    """What the drawing shows and how it is read. marked: repeats are."""
    parts = []
    if (window.ends, window.picks) != ((0, source.factors.ends), (0, source.factors.picks)):
        parts.append(
            f"ends {window.ends[0] + 1} to {window.ends[1]}, picks {window.picks[0] + 1} to {window.picks[1]}"
        )
    parts.append("colour and weave" if view.colour else "filled: warp on top")
    if "tie-up" in blocks:
        parts.append("tie-up: filled shafts rise")
    if source.harness.tieup.shape[0] > MOST_SHAFTS:
        parts.append(f"more than {MOST_SHAFTS} shafts are not drawn")
    if view.floats:
        counts = [sum(c for n, c in side if n > view.floats) for side in (
            (*source.facts.warp.face, *source.facts.weft.face), (*source.facts.warp.back, *source.facts.weft.back),
        )]  # fmt: skip
        parts.append(
            f"floats over {view.floats}: {counts[0]:,} on the face (red), {counts[1]:,} on the back (blue, "
            "dashed), a repeat"
        )
    if marked:
        parts.append("green: repeats")
    return " · ".join(parts)
