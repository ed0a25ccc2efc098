"""Nobody learns one visitor's score from the public figures: not who reads all of them and gave four answers himself.

The attacker is `survey_attacker`; here he goes through HTTP, and the rule alone is tried in all its small worlds.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest
from full_matrix import by_day
from hypothesis import given, settings
from hypothesis import strategies as st
from survey_attacker import Figure as Seen
from survey_attacker import Look, Person, possible, read
from survey_samples import submission

from survey.store.publication import KNOWN, STEP, Figure, Scores, Shown, moved_on

NONE = [0] * 5
RESULTS = "/api/v1/questionnaires/garment/results"
Given = dict[str, int | None]


def some(rng, *weights: float) -> int:
    return int(rng.choice(np.arange(1, 6), p=weights))


# How the others score, one way an item: (their number, who of them it is, chance) → score.
WAYS: tuple[Callable[[int, np.random.Generator], int | None], ...] = (
    lambda who, rng: 5,
    lambda who, rng: 1,
    lambda who, rng: 3,
    lambda who, rng: 5 if who % 9 else 4,
    lambda who, rng: 1 if who % 7 else 5,
    lambda who, rng: 2 if who % 10 else 1,
    lambda who, rng: some(rng, 0.2, 0.2, 0.2, 0.2, 0.2),
    lambda who, rng: some(rng, 0.02, 0.08, 0.2, 0.4, 0.3),
    lambda who, rng: 1 if who < 8 else 5,
    lambda who, rng: some(rng, 0.5, 0, 0, 0, 0.5),
    lambda who, rng: some(rng, 0.1, 0.2, 0.3, 0.2, 0.2) if who % 3 else None,
    lambda who, rng: some(rng, 0.1, 0.2, 0.3, 0.2, 0.2) if who % 7 == 0 else None,
)


class Siege:
    """A place, its visitors, and the attacker who looks before and after whatever happens."""

    def __init__(self, hall, seed: int = 0) -> None:
        self.hall, self.rng = hall, np.random.default_rng(seed)
        self.people: list[Person] = []
        self.truth: list[Given] = []
        self.ids: list[str] = []
        self.looks = [self.look()]

    def look(self) -> Look:
        return read(self.hall.client.get(RESULTS).json())

    def visit(self, times: int = 1) -> None:
        for _ in range(times):
            who = sum(None in person.scores.values() for person in self.people)
            self._send(
                {i: way(who, self.rng) for i, way in zip(self.hall.garment.item_ids, WAYS, strict=True)}, None
            )

    def own(self, *scores: int) -> None:
        for score in scores:
            self._send(dict.fromkeys(self.hall.garment.item_ids, score), score)

    def _send(self, scores: Given, known: int | None) -> None:
        body = submission(self.hall.garment, scores=scores)
        assert self.hall.client.post(self.hall.url, json=body).status_code == 201
        seen = {item: known for item, score in scores.items() if score is not None}
        self.people.append(Person(len(self.looks), seen))
        self.truth.append(scores)
        self.ids.append(body["id"])
        self.looks.append(self.look())

    def leave(self, number: int) -> None:
        assert self.hall.client.delete(f"{self.hall.url}/{self.ids[number]}").status_code == 204
        self.people[number] = replace(self.people[number], gone=len(self.looks))
        self.looks.append(self.look())

    def recovered(self) -> list[tuple[int, str, int]]:
        """(person, item, score) of every score that only one value is left for; and it is never a wrong one."""
        found = []
        for item in self.hall.garment.item_ids:
            for number, scores in possible(self.looks, self.people, item, 5).items():
                assert self.truth[number][item] in scores, "what he holds for possible holds the truth"
                found += [(number, item, *scores)] if len(scores) == 1 else []
        return found


def four_at_first(siege: Siege, score: int) -> None:
    siege.own(*[score] * 4)
    siege.visit(36)


def four_at_the_last_places(siege: Siege, score: int) -> None:
    for _ in range(2):
        siege.visit(8)
        siege.own(score, score)
    siege.visit(20)


def four_that_are_taken_back(siege: Siege, score: int) -> None:
    siege.visit(6)
    siege.own(*[score] * 4)
    for number in range(6, 10):
        siege.visit(5)
        siege.leave(number)
    siege.visit(20)


def a_visitor_leaves(siege: Siege, score: int) -> None:
    siege.visit(10)
    siege.leave(3)
    siege.visit(6)
    siege.own(*[score] * 4)
    siege.visit(20)


def visitors_leave_at_any_time(siege: Siege, score: int) -> None:
    siege.own(score)
    siege.visit(11)
    siege.leave(2)
    siege.own(score, score)
    siege.visit(9)
    siege.leave(16)
    siege.leave(0)
    siege.visit(24)
    siege.own(score)
    siege.visit(6)


def one_alone_scores_what_was_withheld(siege: Siege, score: int) -> None:
    """Ten more answers, and of an item that was of one mind one score: had that been looked at, it would be known."""
    items = siege.hall.garment.item_ids
    for own in (1, 1, 2, 3):
        siege.own(own)
    for theirs in (5, 5, 5, 5, 5, 4):
        siege._send(dict.fromkeys(items, theirs), None)
    siege._send(dict.fromkeys(items, 5 - score // 2), None)
    for number in range(9):
        siege._send(dict.fromkeys(items) | {items[number % 3]: 1 + number % 5}, None)
    siege.visit(14)


PLANS = (
    one_alone_scores_what_was_withheld,
    four_at_first,
    four_at_the_last_places,
    four_that_are_taken_back,
    a_visitor_leaves,
    visitors_leave_at_any_time,
)


@pytest.mark.nightly
@pytest.mark.parametrize("score", by_day([3], [1, 3, 5]))
@pytest.mark.parametrize("plan", PLANS, ids=lambda plan: plan.__name__)
def test_who_polls_without_end_and_gave_four_answers_recovers_no_score(hall, plan, score):
    siege = Siege(hall, seed=score)
    plan(siege, score)
    assert siege.recovered() == []
    assert siege.looks[-1].n >= 20  # there was something to see


def test_a_single_visit_between_two_looks_shows_none_of_its_scores(hall):
    siege = Siege(hall)
    siege.visit(9)
    siege.own(3)
    before = hall.client.get(RESULTS).json()
    siege.visit()
    assert hall.client.get(RESULTS).json() == before
    assert siege.recovered() == []


def test_the_attacker_is_not_blind():
    scores = np.random.default_rng(1).integers(1, 6, 12).tolist()
    people = [Person(at, {"a": None}) for at in range(12)]
    naked = [
        Look(n, {"a": Seen(n, total, total) if n >= 5 else None})
        for n, total in enumerate(itertools.accumulate(scores), 1)
    ]
    found = possible(naked, people, "a", 5)
    assert [found[who] for who in range(5, 12)] == [{score} for score in scores[5:]]
    # Four of the first five were his.
    own = [Person(at, {"a": scores[at] if at < 4 else None}) for at in range(5)]
    assert possible(naked[:5], own, "a", 5) == {4: {scores[4]}}


def test_steps_alone_do_not_hide_visitors_of_one_mind():
    counted = [n - n % 10 for n in range(21)]
    looks = [Look(n, {"a": Seen(n, 5 * n, 5 * n) if n else None}) for n in counted]
    people = [Person(at, {"a": None}) for at in range(1, 21)]
    assert set(map(tuple, possible(looks, people, "a", 5).values())) == {(5,)}


def spreads(n: int, points: int = 5) -> Iterator[tuple[int, ...]]:
    """Every way in which n scores may be spread over the scale."""
    if points == 1:
        yield (n,)
        return
    for first in range(n + 1):
        for rest in spreads(n - first, points - 1):
            yield (first, *rest)


@pytest.mark.parametrize("n", by_day([10, 11], range(10, 16)))
def test_of_no_first_window_four_known_scores_pin_another(n):
    """All worlds: whatever four of the scores are his, what is shown, and that nothing is, leaves two to each other."""
    for his in spreads(KNOWN):
        worlds: dict[object, set[int]] = {}
        for others in spreads(n - KNOWN):
            shown = moved_on(Shown(), 1, Scores(NONE, NONE, together(his, others)))
            points = {point for point, times in enumerate(others, 1) if times}
            worlds.setdefault(shown, set()).update(points)
        assert all(len(points) > 1 for points in worlds.values())


@pytest.mark.parametrize("gone", by_day([1], [1, 2]))
@pytest.mark.parametrize("total", by_day([30], [20, 30, 40]))
def test_of_no_second_window_four_known_scores_pin_what_was_taken_back(total, gone):
    """All worlds again: of ten that were shown with that sum some are gone, ten came, and four of these are his."""
    last = Shown(Figure.of(10, total), 1, 1, None)
    lost = list(itertools.combinations_with_replacement(range(1, 6), gone))
    for his in spreads(KNOWN):
        worlds: dict[object, tuple[set[int], set[int]]] = {}
        for others in spreads(10 - KNOWN):
            fresh = together(his, others)
            for scores in lost:
                shown = moved_on(last, 2, Scores(held(10 - gone, total - sum(scores)), NONE, fresh))
                left, came = worlds.setdefault(shown, (set(), set()))
                left.update(scores)
                came.update(point for point, times in enumerate(others, 1) if times)
        assert all(len(left) > 1 and len(came) > 1 for left, came in worlds.values())


@pytest.mark.nightly
@pytest.mark.parametrize("later", range(10, 13))
@pytest.mark.parametrize("early", [True, False])
def test_of_no_two_windows_four_known_scores_pin_another(early, later):
    """All worlds on three points: ten and then some, four of the ten or of the others his, whatever is seen twice."""
    first, second = (list(spreads(n, 3)) for n in ((10 - KNOWN, later) if early else (10, later - KNOWN)))
    none = [0] * 3
    for his in spreads(KNOWN, 3):
        worlds: dict[object, tuple[set[int], set[int]]] = {}
        for before in first:
            one = together(his, before) if early else list(before)
            shown = moved_on(Shown(), 1, Scores(none, none, one))
            counts = (one, none) if shown.figure else (none, one)
            for after in second:
                two = list(after) if early else together(his, after)
                seen = shown, moved_on(shown, 2, Scores(*counts, two))
                came = worlds.setdefault(seen, (set(), set()))
                for group, spread in zip(came, (before, after), strict=True):
                    group.update(point for point, times in enumerate(spread, 1) if times)
        assert all(len(group) > 1 for came in worlds.values() for group in came)


@pytest.mark.parametrize("n", range(1, STEP))
def test_fewer_scores_than_a_step_change_nothing(n):
    """Also where many answered and few scored the item: of one alone the verdict would tell."""
    for ten in spreads(10, 3):
        shown = moved_on(Shown(), 1, Scores([0] * 3, [0] * 3, ten))
        counts = (ten, [0] * 3) if shown.figure else ([0] * 3, ten)
        for fresh in spreads(n, 3):
            assert moved_on(shown, 2, Scores(*counts, fresh)) == shown


def together(his: Sequence[int], others: Sequence[int]) -> list[int]:
    return [a + b for a, b in zip(his, others, strict=True)]


def held(n: int, total: int) -> list[int]:
    """Some n scores of that sum: of those that a figure holds the rule sees no more."""
    low = n * 5 - total
    scores = [5 - low // n - (number < low % n) for number in range(n)]
    return [scores.count(point) for point in range(1, 6)]


EVENTS = st.lists(
    st.one_of(
        st.tuples(st.just("skip"), st.just(0)),
        st.tuples(st.just("visit"), st.integers(1, 5)),
        st.tuples(st.just("visit"), st.sampled_from([1, 5])),
        st.tuples(st.just("own"), st.integers(1, 5)),
        st.tuples(st.just("leave"), st.integers(0, 30)),
    ),
    min_size=14,
    max_size=40,
)


@pytest.mark.nightly
@given(EVENTS, st.sampled_from([1, 3, 5]))
@settings(max_examples=300, deadline=None)
def test_in_no_small_world_a_score_is_left_with_one_value(events, usual):
    """The rule alone, steps as the store takes them: no more than four answers of his, two others taken back."""
    people, truth, looks = played([("visit", usual)] * 6 + events)
    for number, scores in possible(looks, people, "a", 5).items():
        assert truth[number] in scores
        assert len(scores) > 1


def played(events: Sequence[tuple[str, int]]) -> tuple[list[Person], list[int], list[Look]]:
    """What happens to one item, and what is public of it after each event."""
    people: list[Person] = []
    truth: list[int] = []
    last, counted, step = Shown(), {}, 0
    looks = [Look(0, {"a": None}, ruled=True)]
    n = 0
    for what, value in events:
        now = len(looks)
        if what == "leave":
            standing = [p for p, person in enumerate(people) if person.gone is None]
            lost = sum(person.gone is not None and person.scores == {"a": None} for person in people)
            if not standing or lost == 2:
                continue
            number = standing[value % len(standing)]
            people[number] = replace(people[number], gone=now)
        elif what == "skip":  # answered, and has not seen the item
            people.append(Person(now, {}))
            truth.append(0)
        else:
            his = what == "own" and sum(person.scores.get("a") is not None for person in people) < KNOWN
            people.append(Person(now, {"a": value if his else None}))
            truth.append(value)
        here = [p for p, person in enumerate(people) if person.gone is None]
        new = [p for p in here if p not in counted]
        if len(new) >= STEP:
            step, n = step + 1, len(here)
            counted |= dict.fromkeys(new, step)
            parts = [[0] * 5 for _ in range(3)]
            for p in here:
                if truth[p]:
                    part = parts[(counted[p] > last.step) + (counted[p] > last.judged)]
                    part[truth[p] - 1] += 1
            last = moved_on(last, step, Scores(*parts))
        figure = None
        if last.figure is not None and not last.withheld:
            figure = Seen(last.figure.n, *last.figure.totals)
        looks.append(Look(n, {"a": figure}, ruled=True))
    return people, truth, looks
