"""A motion between two poses with given contacts, without the arms."""

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import same_places
from pushpressslide.core.pose import Pose2
from pushpressslide.modes import MODES


@pytest.mark.parametrize("name", MODES)
def test_it_finds_the_motion_of_the_chosen_contacts_again(
    name: str, task_of_mode: dict[str, str]
) -> None:
    task = pps.load_task(task_of_mode[name])
    best = next(choice for choice in pps.select(task) if choice.feasible)
    mode = MODES[name]
    again = mode.connect(task.query, best.contacts)
    assert again.feasible
    assert same_places(again.contacts, best.contacts)
    assert again.time is not None
    assert best.time is not None
    assert mode.least_time(task.query) <= again.time <= best.time + 1e-9


@pytest.mark.parametrize("name", MODES)
def test_it_says_that_there_is_no_such_placement(
    name: str, task_of_mode: dict[str, str]
) -> None:
    task = pps.load_task(task_of_mode[name])
    best = pps.select(task)[0]
    elsewhere = [replace(contact, point=(9.0, 9.0)) for contact in best.contacts]
    choice = MODES[name].connect(task.query, elsewhere)
    assert choice.refusal is not None
    assert choice.refusal.code == "placement"


def test_the_arms_are_left_aside() -> None:
    task = pps.load_task("rear-push-rear")
    best = next(choice for choice in pps.select(task) if choice.feasible)
    far = [Pose2(X.x + 5.0, X.y, X.yaw) for X in (task.start, task.goal)]
    choice = MODES["rear_push"].connect(task.query.between(*far), best.contacts)
    assert choice.feasible
    assert choice.time == pytest.approx(best.time)
