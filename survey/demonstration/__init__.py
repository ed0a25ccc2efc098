"""Synthetic samples after the paper's Table 3. Nobody answered them; `recipe` tells how they were made.

`table3` is what the paper prints and a population that has it, `indicators` what it asked, `opinions` what people might
think of these. All but the files are handed out late (PEP 562): whoever lists the samples makes none.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from survey.demonstration.indicators import (
        Primary,
        intermediate,
        merged,
        primary,
        questionnaire_id,
        sample_name,
    )
    from survey.demonstration.opinions import primary_opinions, primary_sample
    from survey.demonstration.recipe import (
        ITEMS,
        annealed_sample,
        drawn_opinions,
        drawn_sample,
        exact_sample,
        gappy,
        solved_population,
        with_moments,
    )
    from survey.demonstration.table3 import (
        ALPHA,
        CHI2,
        CLOSE,
        KMO,
        TABLE_3,
        TABLE_3_ITEMS,
        N,
        correlation_of_ten,
        correlation_of_twelve,
        deviations,
        kmo_of,
    )

__all__ = [
    "ALPHA",
    "CHI2",
    "CLOSE",
    "ITEMS",
    "KMO",
    "SAMPLES",
    "TABLE_3",
    "TABLE_3_ITEMS",
    "N",
    "Primary",
    "annealed_sample",
    "correlation_of_ten",
    "correlation_of_twelve",
    "deviations",
    "drawn_opinions",
    "drawn_sample",
    "exact_sample",
    "gappy",
    "intermediate",
    "kmo_of",
    "merged",
    "primary",
    "primary_opinions",
    "primary_sample",
    "questionnaire_id",
    "sample_file",
    "sample_name",
    "solved_population",
    "with_moments",
]

_LATE = {
    "Primary": "indicators",
    "intermediate": "indicators",
    "merged": "indicators",
    "primary": "indicators",
    "questionnaire_id": "indicators",
    "sample_name": "indicators",
    "primary_opinions": "opinions",
    "primary_sample": "opinions",
    "ITEMS": "recipe",
    "annealed_sample": "recipe",
    "drawn_opinions": "recipe",
    "drawn_sample": "recipe",
    "exact_sample": "recipe",
    "gappy": "recipe",
    "solved_population": "recipe",
    "with_moments": "recipe",
    "ALPHA": "table3",
    "CHI2": "table3",
    "CLOSE": "table3",
    "KMO": "table3",
    "N": "table3",
    "TABLE_3": "table3",
    "TABLE_3_ITEMS": "table3",
    "correlation_of_ten": "table3",
    "correlation_of_twelve": "table3",
    "deviations": "table3",
    "kmo_of": "table3",
}

FOLDER = Path(__file__).parent / "samples"

# Name -> what it is, in zh and en; the files are FOLDER / NAME.csv.
SAMPLES = {
    "exact-20": (
        "合成数据：20 行，矩与论文表 3 精确一致（KMO .824，χ² 167.23）",
        "synthetic: 20 rows whose moments are exactly those of the paper's Table 3 (KMO .824, χ² 167.23)",
    ),
    "likert-20": (
        "合成数据：20 行 1–5 分整数，退火至论文表 3",
        "synthetic: 20 rows of whole scores 1–5, annealed towards the paper's Table 3",
    ),
    "likert-200": (
        "合成数据：自表 3 总体抽取的 200 行 1–5 分整数",
        "synthetic: 200 rows of whole scores 1–5 drawn from Table 3's population",
    ),
    "likert-200-gaps": (
        "合成数据：同上，5 % 缺失",
        "synthetic: the same with 5 % of the scores missing",
    ),
    "primary-200": (
        "合成数据：200 行论文 25 项初始指标的 1–5 分整数，经合并、删除得 12 项，再到 10 项",
        "synthetic: 200 rows of whole scores 1–5 of the paper's 25 primary indicators, for its way to 12 and to 10",
    ),
}


def sample_file(name: str) -> Path:
    """The CSV of a sample. Raises KeyError for a name that is not in SAMPLES."""
    if name not in SAMPLES:
        raise KeyError(name)
    return FOLDER / f"{name}.csv"


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
