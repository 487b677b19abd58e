"""The one search of all modes: candidates made, candidates evaluated, and their order."""

import math
from collections.abc import Sequence

import pytest

from pushpressslide import load_task
from pushpressslide.core.motion import Limits
from pushpressslide.core.plan import Choice
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import Scene
from pushpressslide.modes import base
from pushpressslide.modes.base import (
    MOST_BLOCKED,
    PATIENCE,
    Candidate,
    Feasibility,
    search,
)

TASK = load_task("rear-push-rear")
OUT_OF_REACH = Refusal("reach", "out of reach")
LAST = f"{PATIENCE + 5:g}/0"


class Bench:
    """Candidates that log when they are made, and arms that log what they are asked for."""

    def __init__(self, refused: Sequence[str] = ()) -> None:
        self.made: list[tuple[str, bool]] = []
        self.asked: list[str] = []
        self.refused = refused

    def candidate(
        self, least: float, *times: float | None, ordered: bool = False
    ) -> Candidate:
        """A candidate of one choice for each time; None: one that is refused at once."""

        def make(evaluated: bool) -> list[Choice]:
            self.made.append((f"{least:g}", evaluated))
            return [
                Choice("m", f"{least:g}/{i}", time=time)
                if time is not None
                else Choice("m", f"{least:g}/{i}", refusal=Refusal("tipping", "tips"))
                for i, time in enumerate(times)
            ]

        return Candidate(least, make, ordered)

    def arms(
        self, scene: Scene, limits: Limits, choice: Choice, quick: bool
    ) -> Refusal | None:
        """Stand in for ``arms_refusal``."""
        self.asked.append(choice.label)
        return OUT_OF_REACH if choice.label in self.refused else None

    def search(self, *candidates: Candidate | Choice, enough: int = 8) -> list[Choice]:
        """Search with these arms."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(base, "arms_refusal", self.arms)
            return search(candidates, enough, Feasibility(TASK.query))


def test_candidates_are_expanded_in_the_order_of_their_least_times() -> None:
    bench = Bench()
    found = bench.search(*(bench.candidate(t, t) for t in (5.0, 3.0, 9.0, 4.0)))
    assert bench.made == [("3", True), ("4", True), ("5", True), ("9", True)]
    assert [choice.time for choice in found] == [3.0, 4.0, 5.0, 9.0]


def test_after_enough_feasible_ones_no_other_is_evaluated() -> None:
    bench = Bench(refused=["2/0"])
    candidates = [bench.candidate(t, t) for t in (1.0, 2.0, 3.0, 4.0, 5.0)]
    found = bench.search(*candidates, enough=2)
    assert bench.asked == ["1/0", "2/0", "3/0"]
    assert [evaluated for _, evaluated in bench.made] == [True] * 3 + [False] * 2
    assert [c.label for c in found if c.feasible] == ["1/0", "3/0"]
    skipped = [c for c in found if not c.evaluated]
    assert [c.label for c in skipped] == ["4/0", "5/0"]
    assert all("rank before it are feasible (2)" in c.reason for c in skipped)


def test_after_many_blocked_ones_no_other_is_evaluated_and_each_says_so() -> None:
    in_the_way = Refusal("obstacle", "an obstacle is in the way")
    bench = Bench()
    candidates = [bench.candidate(float(i), float(i)) for i in range(MOST_BLOCKED + 2)]
    feasibility = Feasibility(TASK.query, lambda _: in_the_way, arms=False)
    found = search(candidates, 1, feasibility)
    skipped = [c for c in found if not c.evaluated]
    assert [c.time for c in skipped] == [float(MOST_BLOCKED), float(MOST_BLOCKED + 1)]
    for choice in skipped:
        assert "24 choices of this mode are blocked" in choice.reason
        assert "feasible" not in choice.reason


def test_the_arms_are_asked_once_no_draft_that_is_left_can_be_quicker() -> None:
    bench = Bench()
    found = bench.search(
        bench.candidate(0.0, 10.0), bench.candidate(5.0, 6.0), enough=1
    )
    assert bench.asked == ["5/0"]
    assert [choice.label for choice in found] == ["5/0", "0/0"]
    assert not found[1].evaluated


def test_a_draft_that_cannot_be_quicker_is_not_evaluated() -> None:
    bench = Bench()
    bench.search(bench.candidate(0.0, 4.0), bench.candidate(5.0, 6.0), enough=1)
    assert bench.made == [("0", True), ("5", False)]
    assert bench.asked == ["0/0"]


def test_ordered_drafts_are_evaluated_in_their_own_order_whatever_their_times() -> None:
    bench = Bench()
    slow = bench.candidate(0.0, 10.0, ordered=True)
    quick = bench.candidate(1.0, 5.0, ordered=True)
    found = bench.search(quick, slow, enough=1)
    assert bench.asked == ["0/0"]
    assert [choice.feasible for choice in found] == [True, False]
    assert found[0].time == 10.0
    both = Bench()
    slow = both.candidate(0.0, 10.0, ordered=True)
    quick = both.candidate(1.0, 5.0, ordered=True)
    found = both.search(quick, slow, enough=2)
    assert both.asked == ["0/0", "1/0"]
    assert [choice.time for choice in found] == [5.0, 10.0]


def test_refused_choices_come_last_and_are_never_asked_for_again() -> None:
    bench = Bench(refused=["1/0"])
    at_once = Choice("m", "no face", refusal=Refusal("no_faces", "no flat face"))
    found = bench.search(
        at_once, bench.candidate(1.0, 1.0, None), bench.candidate(3.0, 3.0)
    )
    assert [choice.label for choice in found] == ["3/0", "1/0", "no face", "1/1"]
    assert found[1].refusal == OUT_OF_REACH
    assert bench.asked == ["1/0", "3/0"]


def test_of_equally_quick_choices_the_first_draft_is_first() -> None:
    bench = Bench()
    found = bench.search(
        bench.candidate(0.0, 2.0004), bench.candidate(0.0, 2.0, 2.0001)
    )
    assert {round(choice.time or math.inf, 3) for choice in found} == {2.0}
    assert bench.asked == ["0/0", "0/1", "0/0"]
    assert [choice.time for choice in found] == [2.0, 2.0001, 2.0004]


def test_without_drafts_there_is_nothing() -> None:
    assert Bench().search() == []


def test_patience_with_arms_that_do_not_reach_ends() -> None:
    """After so many the tables alone are asked; what they know is still found."""
    asked: list[bool] = []

    def far(
        scene: Scene, limits: Limits, choice: Choice, quick: bool
    ) -> Refusal | None:
        asked.append(quick)
        return None if choice.label == LAST else OUT_OF_REACH

    bench = Bench()
    candidates = [bench.candidate(float(i), float(i)) for i in range(PATIENCE + 6)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(base, "arms_refusal", far)
        found = search(candidates, 1, Feasibility(TASK.query))
    assert asked == [False] * PATIENCE + [True] * 6
    assert [choice.label for choice in found if choice.feasible] == [LAST]
