"""The report's chapter on two groups: means with intervals, tests, effect sizes."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from survey.analysis.comparison import Comparison, Difference, Effect
from survey.questionnaire import Text
from survey.report.chapters.chapter import Chapter, Drawing
from survey.report.figures import intervals
from survey.report.tables import Table
from survey.report.words import Words, decimal, probability, whole

__all__ = ["comparison_chapter"]


def comparison_chapter(found: Comparison, names: Mapping[str, Text], say: Words) -> Chapter:
    """In one language. names: of groups, where they have better ones than their keys."""
    (first, second), (n, m) = _groups(found, names, say), found.n
    opening = say(
        "compare_text", by=say.way_apart(found.by), first=first, second=second, n=whole(n), m=whole(m)
    )
    tested = [one for one in found.items if one.g is not None and one.p_holm is not None]
    sure = [one for one in tested if one.p_holm is not None and one.p_holm < 0.05]
    verdict = say("compare_verdict", tested=len(tested), sure=len(sure))
    notes = map(say.remark, found.notes)
    drawn = (_drawing(tested, first, second, say),) if tested else ()
    means = _means(found, (first, second), say)
    return Chapter(
        "section_compare",
        (opening, verdict, *notes, *((means,) if means.body else ()), *drawn,
         *((_tests(tested, say),) if tested else ()), say("compare_rules")),
    )  # fmt: skip


def _groups(found: Comparison, names: Mapping[str, Text], say: Words) -> tuple[str, str]:
    first, second = (
        names[key].in_language(say.language) if key in names else say.group(found.by, key)
        for key in found.groups
    )
    return first, second


def _means(found: Comparison, shown: tuple[str, str], say: Words) -> Table:
    body = tuple(
        (
            say.item(one.item),
            *_group(one.n[0], one.mean[0], one.half[0], one.sd[0]),
            *_group(one.n[1], one.mean[1], one.half[1], one.sd[1]),
        )
        for one in found.items
        if one.mean is not None and one.half is not None and one.sd is not None
    )  # fmt: skip
    head = (say("item"), *((say("n"), say("mean"), say("sd")) * 2))
    groups = (("", 1), (shown[0], 3), (shown[1], 3))
    return Table("compare-means", say("compare_means_caption"), head, body, groups=groups)


def _group(n: int, mean: float, half: float, sd: float) -> tuple[str, str, str]:
    return str(n), f"{decimal(mean, 2)} ± {decimal(half, 2)}", decimal(sd, 2)


def _tests(tested: list[Difference], say: Words) -> Table:
    body = tuple(
        (
            say.item(one.item), _shown(one.difference), _p(one.p_holm),
            _shown(one.g), _p(one.p_ranks_holm), _shown(one.delta),
        )
        for one in tested
    )  # fmt: skip
    head = (
        say("item"), f"{say('difference')} [95 %]", f"p ({say('holm')})", "g [95 %]",
        f"p ({say('ranks')})", "δ [95 %]",
    )  # fmt: skip
    bold = frozenset(
        (row, 2) for row, one in enumerate(tested) if one.p_holm is not None and one.p_holm < 0.05
    )
    return Table("compare-tests", say("compare_tests_caption"), head, body, strong=bold)


def _shown(one: Effect | None) -> str:
    return "–" if one is None else f"{decimal(one.value, 2)} [{decimal(one.low, 2)}, {decimal(one.high, 2)}]"


def _p(value: float | None) -> str:
    return "–" if value is None else probability(value).removeprefix("= ")


def _drawing(tested: list[Difference], first: str, second: str, say: Words) -> Drawing:
    values = np.array([(one.g.value, one.g.low, one.g.high) for one in tested if one.g is not None])
    labels = [say.item(one.item) for one in tested]
    caption = say("compare_figure", first=first, second=second)
    return Drawing("compare-effects", caption, partial(_drawn, values, labels, caption))


def _drawn(values, labels: list[str], caption: str, name: str) -> str:
    return intervals(values, labels, [""] * len(labels), (-0.5, 0.5), name, caption)
