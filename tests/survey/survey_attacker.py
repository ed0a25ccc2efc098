"""Who reads every public figure and gave some answers himself: which scores of the others are still possible.

He is stronger than anybody who only looks on: he knows when each visitor answered or took an answer back, and which
items each of them scored. Of every item he follows the sum of the scores that stand, person by person, as the set of
all sums that there can be; a figure cuts it down to those that are rounded to it. Where the place says why it shows
nothing he uses its rule too: that a figure moved on says that no score was given by all but five or fewer of those it
took in, that it did not move on, though ten scores had come since that was looked at last, says that one was.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import product
from math import ceil

__all__ = ["Figure", "Look", "Person", "possible", "read"]

LEAST, UNLIKE = 10, 6  # as the place's README states its rule


@dataclass(frozen=True)
class Figure:
    """n scores whose sum is from `least` to `most`."""

    n: int
    least: int
    most: int


@dataclass(frozen=True)
class Look:
    """What was public after the event of that number. ruled: the place says why it shows nothing."""

    n: int
    figures: Mapping[str, Figure | None]
    ruled: bool = False


@dataclass(frozen=True)
class Person:
    """An answer: the event with which it came, and went. scores: what is known of it, None: scored and not known."""

    came: int
    scores: Mapping[str, int | None]
    gone: int | None = None

    def stands(self, event: int) -> bool:
        return self.came <= event and (self.gone is None or self.gone > event)


def read(results: dict) -> Look:
    """A look from the JSON of the public results, of any release."""
    rows = results["items"] or []
    return Look(
        results["n"], {row["id"]: _figure(row) for row in rows}, any("withheld" in row for row in rows)
    )


def _figure(row: dict) -> Figure | None:
    if row["mean"] is None:
        return None
    n = row["n"]
    if "decimals" not in row:
        total = round(row["mean"] * n)
        return Figure(n, total, total)
    unit = Fraction(1, 10 ** row["decimals"])
    units = round(row["mean"] / unit)
    return Figure(n, ceil((units - Fraction(1, 2)) * unit * n), ceil((units + Fraction(1, 2)) * unit * n) - 1)


def possible(looks: Sequence[Look], people: Sequence[Person], item: str, points: int) -> dict[int, set[int]]:
    """Number of a person whose score of the item is not known → scores that fit all looks.

    looks: one after each event. Whoever is in no figure may have given anything and is left out.
    """
    checks = list(_checks(looks, people, item))
    moves = [event for event, figure in checks if figure is not None]
    mine = {
        number: person
        for number, person in enumerate(people)
        if item in person.scores and any(person.stands(event) for event in moves)
    }
    plan = list(_plan(checks, mine, people, item, looks))
    free = tuple(range(1, points + 1))
    options = {
        number: free if (known := person.scores[item]) is None else (known,)
        for number, person in mine.items()
    }
    lost = [number for number, person in mine.items() if options[number] is free and person.gone is not None]
    found, alike = {}, {}
    for number, person in mine.items():
        if options[number] is not free:
            continue
        # Whoever came and went between the same figures cannot be told apart.
        key = _between(checks, person.came), person.gone if person.gone is None else number
        if key not in alike:
            alike[key] = {score for score in free if _fits(plan, options | {number: (score,)}, lost, points)}
        found[number] = alike[key]
    return found


def _checks(
    looks: Sequence[Look], people: Sequence[Person], item: str
) -> Iterator[tuple[int, Figure | None]]:
    """(event, figure) where the item's figure moved on, (event, None) where others did and it did not."""
    before = Look(0, {})
    for event, look in enumerate(looks):
        figure = look.figures.get(item)
        if figure is not None and figure != before.figures.get(item):
            yield event, figure
        elif look.ruled and (look.n, look.figures) != (before.n, before.figures):
            yield event, None
        before = look


def _between(checks: Sequence[tuple[int, Figure | None]], event: int) -> int:
    return sum(1 for at, _ in checks if at < event)


def _plan(checks, mine: Mapping[int, Person], people: Sequence[Person], item: str, looks: Sequence[Look]):
    """What happens to the sum: ("add", who), ("drop", who), ("move", figure, by rule), ("stay",)."""
    moves = [event for event, figure in checks if figure is not None]
    within: set[int] = set()  # who is in the last figure
    added: set[int] = set()  # who came since, and stands when it moves on
    last = judged = -1  # when it moved on, when it was last looked at whether it may
    for event, figure in checks:
        until = next((move for move in moves if move >= event), None)
        if until is None:
            return
        for number, person in mine.items():
            if number not in within | added and person.came <= event and person.stands(until):
                added.add(number)
                yield "add", number
        if figure is None:
            scored = [p for p in people if item in p.scores]
            if sum(judged < p.came <= event and p.stands(event) for p in scored) < LEAST:
                continue  # nobody looked
            judged = event
            left = (p for p in scored if p.came <= event and p.gone is not None)
            if not any(last < (p.gone or 0) <= until for p in left):
                yield ("stay",)
            continue
        for number in sorted(within):
            if not mine[number].stands(event):
                within.remove(number)
                yield "drop", number
        within, added, last, judged = within | added, set(), event, event
        assert figure.n == len(within), "he understands what the figure counts"
        yield "move", figure, looks[event].ruled


def _fits(plan, options: Mapping[int, Sequence[int]], lost: Sequence[int], points: int) -> bool:
    """Whether there are scores among the options that lead through the whole plan."""
    # Who is taken out of a sum again must go with the score he came with.
    for scores in product(*(options[number] for number in lost)):
        if _leads(plan, {**options, **{n: (s,) for n, s in zip(lost, scores, strict=True)}}, points):
            return True
    return False


def _leads(plan, options: Mapping[int, Sequence[int]], points: int) -> bool:
    start = (0,) * points
    sums = {start: 1}  # how many scores are unlike each point, up to UNLIKE → possible sums, as bits
    for what, *rest in plan:
        after: dict[tuple[int, ...], int] = {}
        if what == "add":
            for unlike, bits in sums.items():
                for score in options[rest[0]]:
                    key = _unlike(unlike, score)
                    after[key] = after.get(key, 0) | bits << score
        elif what == "drop":
            (score,) = options[rest[0]]
            after = {unlike: bits >> score for unlike, bits in sums.items()}
        elif what == "stay":
            after = {unlike: bits for unlike, bits in sums.items() if min(unlike) < UNLIKE}
        else:
            figure, ruled = rest
            kept = (bits for unlike, bits in sums.items() if not ruled or min(unlike) == UNLIKE)
            among = (1 << figure.most + 1) - (1 << figure.least)
            union = 0
            for bits in kept:
                union |= bits & among
            after = {start: union} if union else {}
        if not after:
            return False
        sums = after
    return True


@cache
def _unlike(unlike: tuple[int, ...], score: int) -> tuple[int, ...]:
    return tuple(min(UNLIKE, count + (point != score)) for point, count in enumerate(unlike, 1))
