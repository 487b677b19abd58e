"""A policy learns the tasks from demonstrations, as the example shows."""

import runpy
from pathlib import Path

import pytest

from pushpressslide.learning.registration import TASKS

EXAMPLE = Path(__file__).parents[2] / "examples" / "11_learn_from_demonstrations.py"


@pytest.mark.long
@pytest.mark.parametrize("task", TASKS.values())
def test_a_network_learns_a_task_from_demonstrations(task) -> None:
    learn = runpy.run_path(str(EXAMPLE))["learn"]
    assert learn(task) >= 0.9
