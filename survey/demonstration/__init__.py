"""Synthetic samples after the paper's Table 3. Nobody answered them; `recipe` tells how they were made."""

from __future__ import annotations

from pathlib import Path

__all__ = ["FOLDER", "SAMPLES", "sample_file"]

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
