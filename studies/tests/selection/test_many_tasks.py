"""Selection evaluates few choices in full and ranks as if it had evaluated them all."""

import pytest

from pushpressslide.core.plan import Choice
from pushpressslide.core.task import Task
from pushpressslide.modes.base import ENOUGH
from pushpressslide.selection.select import select
from pushpressslide_studies.bench.selection import CASES


def bests(task: Task, enough: int) -> dict[str, Choice]:
    """The best feasible choice of each mode."""
    out: dict[str, Choice] = {}
    for choice in select(task, enough):
        if choice.feasible:
            out.setdefault(choice.mode, choice)
    return out


@pytest.mark.parametrize("case", CASES[::3], ids=lambda case: case.name)
def test_the_first_of_each_mode_is_the_same_however_many_are_judged(case) -> None:
    assert bests(case.task, 1) == bests(case.task, ENOUGH)


def test_what_is_not_judged_in_full_says_so_and_is_no_quicker_than_the_first_of_its_mode() -> (
    None
):
    task = next(case.task for case in CASES if case.name == "large box ahead")
    first = bests(task, 1)
    skipped = [c for c in select(task) if not c.evaluated]
    assert skipped
    for choice in skipped:
        assert not choice.feasible
        assert "not evaluated: enough choices" in choice.reason
        assert (choice.time or 0.0) > (first[choice.mode].time or 0.0) - 1e-3


def test_of_equally_quick_modes_that_one_is_first_whose_contacts_do_not_push_against_each_other() -> (
    None
):
    task = next(case.task for case in CASES if case.name == "large box ahead")
    both = [choice for choice in bests(task, 1).values() if len(choice.contacts) == 2]
    first, second = both[:2]
    assert (first.mode, second.mode) == ("parallel_push", "orthogonal_push")
    assert first.time == pytest.approx(second.time, abs=1e-3)
