"""Printed in the paper / computed from its own Table 3 / yours: one row for each inconsistency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from survey.analysis import Analysis, adequacy_of, grim, least_n, varimax
from survey.demonstration import TABLE_3, N
from survey.report.tables.table import Table
from survey.report.words import Words

__all__ = ["MEANS", "Row", "paper_rows", "paper_table"]

# The thirteen means of III.C as printed.
MEANS = "4.15 4.46 4.35 4.88 4.84 4.55 4.60 4.98 4.92 4.57 4.94 4.27 4.78".split()
EIGENVALUES = (6.067, 2.084, 1.036, 0.584, 0.485, 0.362, 0.213, 0.167, 0.064, 0.046)
PERCENT = (56.326, 24.808, 9.335)
ROTATED, ROTATED_PERCENT = (3.573, 3.027, 1.398), (36.482, 28.187, 23.325)


@dataclass(frozen=True)
class Row:
    """Texts as (zh, en). printed, computed, yours are figures; "–" where the quantity has no counterpart."""

    quantity: tuple[str, str]
    printed: str
    computed: str
    yours: str
    verdict: tuple[str, str]


def paper_rows(analysis: Analysis | None) -> list[Row]:
    """Every row computed now. analysis: yours, where it is of the same ten items' kind; None leaves the column "–"."""
    return [
        *_eigenvalue_rows(analysis),
        *_test_rows(analysis),
        *_loading_rows(analysis),
        *_mean_rows(analysis),
    ]


def paper_table(analysis: Analysis | None, say: Words) -> Table:
    """The rows in one language."""
    body = tuple(
        (say.either(row.quantity), row.printed, row.computed, row.yours, say.either(row.verdict))
        for row in paper_rows(analysis)
    )
    head = (say("quantity"), say("printed"), say("computed"), say("yours"), say("verdict"))
    return Table("paper", say("section_paper"), head, body, left=5, rules=frozenset(range(1, len(body))))


def _some(values: object, digits: int = 3) -> str:
    return " / ".join(f"{float(value):.{digits}f}" for value in np.atleast_1d(np.asarray(values)))


def _eigenvalue_rows(analysis: Analysis | None) -> list[Row]:
    mine = None if analysis is None else analysis.components
    squares = np.sort((TABLE_3**2).sum(axis=0))[::-1]
    p = len(TABLE_3)
    values = np.linalg.eigvalsh(TABLE_3.T @ TABLE_3)[::-1]
    kept = 0 if mine is None else mine.kept
    share = 0.0 if mine is None else 100 * mine.rotated.sum() / len(mine.eigenvalues)
    return [
        Row(("特征值之和", "Sum of the eigenvalues"), f"{sum(EIGENVALUES):.3f}", f"{p}",
            "–" if mine is None else f"{mine.eigenvalues.sum():.3f}",
            ("相关矩阵的特征值之和等于项目数", "The eigenvalues of a correlation matrix sum to the number of items")),
        Row(("前三个特征值的方差 %", "% of variance of the first three eigenvalues"), _some(PERCENT),
            f"{_some(100 * np.array(EIGENVALUES[:3]) / p, 2)} (λ/{p})",
            "–" if mine is None else _some(100 * mine.eigenvalues[:kept] / len(mine.eigenvalues), 2),
            ("两列出自不同的运算：若百分比为真，则 λ₃ = .9335 < 1，Kaiser 只保留两个",
             "The two columns come from different runs: if the % is right, λ₃ = .9335 < 1 and Kaiser keeps two")),
        Row(("前三个初始特征值", "First three initial eigenvalues"), _some(EIGENVALUES[:3]), _some(values),
            "–" if mine is None else _some(mine.eigenvalues[:kept]),
            ("表 3 的载荷给出另外三个值", "The loadings of Table 3 give three others")),
        Row(("旋转后载荷平方和", "Rotated sums of squares"), _some(ROTATED), _some(squares),
            "–" if mine is None else _some(mine.rotated),
            (f"其自身的百分比意味着 {_some(np.array(ROTATED_PERCENT) * p / 100)}",
             f"Its own percentages mean {_some(np.array(ROTATED_PERCENT) * p / 100)}")),
        Row(("累计方差 %", "Cumulative % of variance"), "90.469 / 87.994 / 90.17 / 87.433",
            f"{100 * squares.sum() / p:.2f}", "–" if mine is None else f"{share:.2f}",
            ("旋转不改变总和：初始 = 旋转", "Rotation keeps the total: initial = rotated")),
    ]  # fmt: skip


def _test_rows(analysis: Analysis | None) -> list[Row]:
    p = len(TABLE_3)
    r = TABLE_3 @ TABLE_3.T
    np.fill_diagonal(r, 1.0)
    implied = adequacy_of(r, N, [str(at) for at in range(p)])
    mine = None if analysis is None else analysis.adequacy
    return [
        Row(("Bartlett 自由度", "Degrees of freedom of Bartlett's test"), "48", f"{implied.bartlett.df}",
            "–" if mine is None else f"{mine.bartlett.df}",
            ("p(p − 1)/2：10 个项目为 45，12 个为 66；48 不是三角数",
             "p(p − 1)/2: 45 for 10 items, 66 for 12; 48 is no such number")),
        Row(("Bartlett χ²", "Bartlett's χ²"), "167.23", f"{implied.bartlett.chi2:.2f}  (n = {N})",
            "–" if mine is None else f"{mine.bartlett.chi2:.2f}",
            ("与表 3 在 n = 20 时相符（n 为推断，论文未印出）",
             "Agrees with Table 3 at n = 20 (inferred; the paper prints no n there)")),
        Row(("KMO", "KMO"), "0.824", f"{implied.kmo:.3f}", "–" if mine is None else f"{mine.kmo:.3f}",
            ("有与表 3 相符且 KMO 恰为 .824 的相关矩阵",
             "There are correlation matrices with Table 3 and a KMO of exactly .824")),
    ]  # fmt: skip


def _loading_rows(analysis: Analysis | None) -> list[Row]:
    mine = None if analysis is None else analysis.components
    home = np.abs(TABLE_3).max(axis=1)
    communality = (TABLE_3**2).sum(axis=1)
    turned = varimax(TABLE_3)
    moved = np.abs(turned - TABLE_3[:, np.argsort(-(TABLE_3**2).sum(axis=0))]).max()
    lower = np.tril_indices(len(TABLE_3), -1)
    implied = (TABLE_3 @ TABLE_3.T)[lower]
    t = stdtrit(N - 2, np.array([0.975, 0.995]))
    needed = t / np.sqrt(N - 2 + t**2)
    own = None if analysis is None or mine is None else _own_correlations(analysis)
    return [
        Row(("最小的主载荷", "Least of the main loadings"), "> .78", f"{home.min():.3f}",
            "–" if mine is None else f"{np.abs(mine.loadings).max(axis=1).min():.3f}",
            ("有一个为 .764", "One is .764")),
        Row(("解释的项目方差（共同度）", "Explained variance of the items (communality)"), "> 67.38 %",
            f"{communality.min():.3f} – {communality.max():.3f}",
            "–" if mine is None else f"{mine.communalities.min():.3f} – {mine.communalities.max():.3f}",
            ("67.38 % 无从推出", "67.38 % cannot be derived")),
        Row(("表 3 是方差最大化的结果", "Table 3 is a varimax solution"), "varimax",
            f"max |Δ| = {moved:.3f}", "–" if mine is None else f"{mine.rotation}",
            ("并非驻点：再旋转仍会移动，故在 .05 以内比较",
             "It is not at rest: varimax still moves it, so compare within .05")),
        Row(("小于 .3 的相关", "Correlations below .3"), "“generally > .3”",
            f"{100 * (implied < 0.3).mean():.0f} % (min {implied.min():.3f})",
            "–" if own is None else f"{100 * (own < 0.3).mean():.0f} % (min {own.min():.3f})",
            (f"n = 20 时需 ≥ {needed[0]:.3f}（*）/ {needed[1]:.3f}（**）才显著",
             f"At n = 20 significance needs ≥ {needed[0]:.3f} (*) / {needed[1]:.3f} (**)")),
    ]  # fmt: skip


def _own_correlations(analysis: Analysis) -> np.ndarray | None:
    if analysis.correlation is None:
        return None
    at = [analysis.items.index(item) for item in analysis.factored]
    return analysis.correlation.r[np.ix_(at, at)][np.tril_indices(len(at), -1)]


def _mean_rows(analysis: Analysis | None) -> list[Row]:
    impossible = [mean for mean in MEANS if not grim(mean, N)]
    least = least_n(MEANS, half_up=True)
    return [
        Row(("III.C 的平均分（n = 20）", "Means of III.C at n = 20"), f"{len(MEANS)}",
            f"GRIM: {len(impossible)} ✗  ({' '.join(impossible)})", "–",
            (f"20 个整数的平均分不可能是这些；全部可能的最小 n 为 {least}",
             f"No 20 whole numbers have these means; the smallest n that fits all is {least}")),
        Row(("“4.94 为所有模块最高”", "“4.94, the highest among all modules”"), "4.94", f"{max(MEANS, key=float)}", "–",
            ("另一维度有 4.98", "4.98 stands in another dimension")),
        Row(("操作必要性、便捷性、逻辑", "Necessity, convenience, logic"), "–", "–", "–",
            ("问了，却没有报告", "Asked, never reported")),
    ]  # fmt: skip
