"""Arms that follow their commands too late for a press."""

from __future__ import annotations

import pytest

import pushpressslide as pps
from pushpressslide.core import margins
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Contact
from pushpressslide.core.scene import Robot

LONGEST = margins.ARM.longest_reaction
PERIOD = 0.008  # [s] of the commands
INTERFACES = ["position", "velocity"]


def late(name: str, reaction: float, interface: str = "position") -> pps.Task:
    """A shipped task for one arm with a ``reaction`` [s]."""
    changes = {
        "robots.0.interface": interface,
        "robots.0.rate": 1.0 / PERIOD,
        "robots.0.lag": 0.6 * (reaction - PERIOD),
        "robots.0.delay": 0.4 * (reaction - PERIOD),
    }
    return pps.load_task(name, changes)


def test_the_reaction_is_period_delay_and_lag() -> None:
    robot = Robot("panda", interface="velocity", rate=50.0, lag=0.03, delay=0.01)
    assert robot.reaction == pytest.approx(0.06)
    torques = Robot("panda", rate=50.0, lag=0.03, delay=0.01)
    assert torques.reaction == 0.0


@pytest.mark.parametrize("interface", INTERFACES)
@pytest.mark.parametrize("model", ["panda", "hand"])
def test_a_press_beyond_the_longest_reaction_is_refused_with_both_figures(
    model: str, interface: str
) -> None:
    task = late("press-slide", LONGEST + 0.01, interface)
    robot = pps.load_task("press-slide", {"robots.0.model": model}).robots[0]
    press = pps.plan("press-slide").contacts[0]
    assert isinstance(press, Contact)
    scene = task.believed().scene if hasattr(task, "believed") else task
    del robot, scene
    with pytest.raises(InfeasibleTaskError, match="allows at most") as caught:
        pps.plan(task, mode="press_slide")
    assert f"{LONGEST + 0.01:.3f} s" in str(caught.value)
