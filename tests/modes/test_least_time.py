"""The lower bound of a mode's time never exceeds the time of its choices."""

from __future__ import annotations

import pytest

from pushpressslide.jobs.sampling import random_task
from pushpressslide.modes import MODES
from pushpressslide.selection.select import select
from pushpressslide.taskfile.load import load_task

TASKS = (
    "rear-push-rear",
    "press-slide",
    "parallel-push",
    "orthogonal-push",
    "bimanual-slide",
)
DRAWN = 8


@pytest.mark.parametrize("name", TASKS)
def test_no_choice_is_quicker_than_the_least_time_of_its_mode(name: str) -> None:
    base = load_task(name)
    compared = 0
    for index in range(DRAWN):
        task = random_task(base, index, 17)
        for choice in select(task, 3):
            if choice.segments:
                taken = sum(piece.profile.duration for piece in choice.segments)
                least = MODES[choice.mode].least_time(task.query)
                assert least <= taken + 1e-6, f"{index}: {choice.reason}"
                compared += 1
    assert compared >= DRAWN
