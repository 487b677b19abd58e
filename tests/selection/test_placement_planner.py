"""Joint paths of a task's placements: the choice that is run, and the reasons against
the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import pytest

import pushpressslide as pps
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.refusal import SKIPPED, Refusal
from pushpressslide.selection import placement_planner as module
from pushpressslide.selection.select import select

TASK = pps.load_task("parallel-push")
CHOICES = [choice for choice in select(TASK, 3) if choice.feasible]


@dataclass
class Arms:
    """A preparation whose arms have a joint path for some contacts only."""

    reached: Sequence[Choice]
    plans: list[Plan] = field(default_factory=list)
    paths: tuple = ()
    asked: int = 0
    rooms: Sequence[float] = (1.0,)  # that of each choice's arms, in turn

    @property
    def margin_share(self) -> float:
        placed = self.plans[-1].segments
        number = [choice.segments for choice in CHOICES].index(placed)
        return self.rooms[number % len(self.rooms)]

    def keep(self, count: int) -> None:
        del self.plans[count:]

    def add(self, placement: Plan) -> None:
        self.asked += 1
        if placement.segments not in [choice.segments for choice in self.reached]:
            raise InfeasibleTaskError("task: robots: no joint path")
        self.plans.append(placement)


def test_the_first_choice_with_a_joint_path_is_run_and_the_others_say_why() -> None:
    assert len(CHOICES) > 2
    arms = Arms(CHOICES[1:])
    judged = module.prepared(arms, Plan(TASK), list(CHOICES), force=False)
    assert [plan.segments for plan in arms.plans] == [CHOICES[1].segments]
    assert judged[0].refusal is not None
    assert judged[0].refusal.code == "joint_path"
    assert judged[1:] == CHOICES[1:]
    assert arms.asked == 2


@pytest.mark.parametrize(
    ("rooms", "run"),
    [((0.5, 1.0), 1), ((0.5, 0.6), 1), ((0.5, 0.4), 0), ((1.0, 1.0), 0)],
)
def test_arms_that_lack_room_are_compared_to_those_of_the_next_choice(
    rooms: tuple[float, ...], run: int
) -> None:
    arms = Arms(CHOICES, rooms=rooms)
    judged = module.prepared(arms, Plan(TASK), list(CHOICES), force=False)
    assert [plan.segments for plan in arms.plans] == [CHOICES[run].segments]
    assert judged == CHOICES


def test_another_mode_is_no_choice_for_arms_that_lack_room() -> None:
    other = replace(CHOICES[1], mode="rear_push")
    arms = Arms(CHOICES, rooms=(0.5, 1.0))
    module.prepared(arms, Plan(TASK), [CHOICES[0], other], force=False)
    assert [plan.segments for plan in arms.plans] == [CHOICES[0].segments]


def test_without_a_joint_path_the_task_is_refused() -> None:
    with pytest.raises(InfeasibleTaskError, match="no joint path"):
        module.prepared(Arms(()), Plan(TASK), list(CHOICES), force=False)


def test_further_choices_are_not_taken_where_they_change_the_placements(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    skipped = Refusal(SKIPPED, "enough choices are feasible")
    choices = [CHOICES[0], CHOICES[1].refused(skipped)]
    asked = []

    def fewer(task, enough, first):
        asked.append(enough)
        return []

    monkeypatch.setattr(module, "placements", fewer)
    with pytest.raises(InfeasibleTaskError, match="no joint path"):
        module.prepared(Arms(()), Plan(TASK), choices, force=False)
    assert asked == [module.MANY]
