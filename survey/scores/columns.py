"""Which columns of a foreign table are items: not who the people are, when they answered, or what was summed up.

Careful by design: what is left out is named with the way to keep it, and an item is rather kept than lost.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.errors import SurveyError

__all__ = ["Choice", "no_items"]

# Names that no rating bears; ambiguous ones (weight, time, major, 收入, 专业) are left to their values.
_NAMES = """
id nr no idx index row rowid rowname case caseid subject subjectid participant participantid respondent respondentid
userid username person personid code uuid age agegroup ageband gender sex birthyear birthdate yearofbirth dateofbirth
birthday education educ edu educationlevel degree date datetime timestamp startdate enddate starttime endtime duration
group groupid cohort condition treatment country nationality ethnicity race region city province school income
occupation job marital maritalstatus ipaddress email phone telephone total totalscore sum sumscore average
编号 序号 学号 工号 用户编号 受访者编号 答卷编号 问卷编号 姓名 年龄 年龄段 年龄组 性别 出生年份 出生年月 出生日期
学历 教育程度 受教育程度 文化程度 最高学历 日期 时间戳 提交时间 提交答卷时间 填写时间 开始时间 结束时间 答题时间
所用时间 用时 组别 分组 班级 年级 国籍 民族 籍贯 地区 省份 城市 来源 来自ip 所在地 职业 月收入
年收入 婚姻状况 电话 手机 手机号 邮箱 总分 合计 平均分 均分
""".split()
NAMES = frozenset(_NAMES)
MOST_POINTS = 11  # of a scale of ratings: 0 to 10
COMMON = 2 / 3  # share of the columns that must look like one scale before values tell what is none of it


@dataclass(frozen=True)
class Choice:
    """What the user says of the columns: `items`, exactly these are; `keep`, these are, whatever they look like."""

    items: tuple[str, ...] = ()
    keep: tuple[str, ...] = ()

    def check(self, header: Sequence[str], where: object) -> None:
        """Raises SurveyError for a column that is not there, or named twice: it would be two items, with r = 1."""
        absent = [name for name in (*self.items, *self.keep) if name not in header]
        if absent:
            known = ", ".join(name for name in header if name)
            raise SurveyError(f"{where}: no column {absent[0]!r} – the columns are {known[:300]}")
        for names in (self.items, self.keep):
            twice = [name for name in names if names.count(name) > 1]
            if twice:
                raise SurveyError(f"{where}: column {twice[0]!r} is named twice – name it once")


def no_items(columns: Mapping[str, NDArray[np.float64]], keep: Sequence[str] = ()) -> dict[str, str]:
    """Column → "name" or "scale" for those that are no items. columns: name → (n,) numbers, NaN where missing.

    By name from a list; by values where at least two thirds of the other columns are whole scores on one scale of at
    most eleven points, and at least half of this column's values lie beyond it. A single slip is no such thing.
    """
    found = {name: "name" for name in columns if _plain(name) in NAMES and name not in keep}
    rest = {name: values[~np.isnan(values)] for name, values in columns.items() if name not in found}
    rest = {name: values for name, values in rest.items() if len(values)}
    scale = _common_scale(list(rest.values()))
    if scale is not None:
        low, high = scale
        for name, values in rest.items():
            if name not in keep and 2 * np.count_nonzero((values < low) | (values > high)) >= len(values):
                found[name] = "scale"
    # A table of nothing but such columns is meant as it is.
    return {} if len(found) == len(columns) else found


def _plain(name: str) -> str:
    """A name without signs, and without the number and the "your" that a form puts before it: 1、您的性别 → 性别."""
    bare = re.sub(r"[\s_.\-:：（）()#]+", "", name).casefold()
    return re.sub(r"^(?:q?\d+[、．]?)?(?:您的|你的)?", "", bare)


def _common_scale(columns: Sequence[NDArray[np.float64]]) -> tuple[float, float] | None:
    """Lowest and highest score of the scale that most columns share, or None."""
    # Quantiles rather than extremes: a slip such as 55 makes no scale longer. With few answers they are the extremes.
    ends = [
        (float(low), float(high))
        for values in columns
        for low, high in [np.quantile(values, (0.02, 0.98), method="inverted_cdf")]
        if (values == np.rint(values)).all()
    ]
    like = [(low, high) for low, high in ends if high - low < MOST_POINTS and abs(low) < MOST_POINTS]
    if len(like) < 3 or len(like) < COMMON * len(columns):
        return None
    low, high = min(low for low, _ in like), max(high for _, high in like)
    return (low, high) if high - low < MOST_POINTS else None
