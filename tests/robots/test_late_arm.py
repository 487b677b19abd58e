"""Arms that follow their commands too late for a press."""

from __future__ import annotations

import pytest

import pushpressslide as pps
from pushpressslide.core import margins
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import Robot

LONGEST = margins.ARM.longest_reaction
PERIOD = 0.008  # [s] of the commands
INTERFACES = ["position", "velocity"]


def late_task(name: str, reaction: float, interface: str = "position") -> pps.Task:
    """A shipped task for one arm with a ``reaction`` [s]."""
    return pps.load_task(
        name,
        {
            "robots.0.interface": interface,
            "robots.0.rate": 1.0 / PERIOD,
            "robots.0.lag": 0.6 * (reaction - PERIOD),
            "robots.0.delay": 0.4 * (reaction - PERIOD),
        },
    )


def refusals(task: pps.Task, mode: str) -> list[Refusal]:
    """Refusals of a mode that is not possible, those of its loops left out."""
    choices = [choice for choice in pps.select(task) if choice.mode == mode]
    found = [choice.refusal for choice in choices if choice.refusal is not None]
    assert len(found) == len(choices) > 0
    return [refusal for refusal in found if refusal.code != "loop"]


def test_the_reaction_is_period_delay_and_lag() -> None:
    robot = Robot("panda", interface="velocity", rate=50.0, lag=0.03, delay=0.01)
    assert robot.reaction == pytest.approx(0.06)
    torques = Robot("panda", rate=50.0, lag=0.03, delay=0.01)
    assert torques.reaction == 0.0


@pytest.mark.parametrize("interface", INTERFACES)
def test_a_press_beyond_the_longest_reaction_is_refused_with_both_figures(
    interface: str,
) -> None:
    task = late_task("press-slide", LONGEST + 0.01, interface)
    found = refusals(task, "press_slide")
    assert found
    for refusal in found:
        assert refusal.code == "late_arm"
        assert refusal.figure == pytest.approx(LONGEST + 0.01)
        assert refusal.allowed == LONGEST
        assert refusal.unit == "s"


@pytest.mark.parametrize("interface", INTERFACES)
def test_a_press_within_it_is_planned(interface: str) -> None:
    task = late_task("press-slide", LONGEST - 0.001, interface)
    assert pps.plan(task).contacts[0].load > 0.0


def test_a_free_tip_is_refused_likewise() -> None:
    robot = {"model": "hand", "interface": "position", "lag": LONGEST}
    task = pps.load_task("press-slide", {"robots": [robot]})
    codes = {refusal.code for refusal in refusals(task, "press_slide")}
    assert codes == {"late_arm"}


@pytest.mark.parametrize("interface", INTERFACES)
def test_an_arm_too_late_for_a_press_still_pushes(interface: str) -> None:
    task = late_task("rear-push-rear", LONGEST + 0.01, interface)
    record = pps.run(task, engine="planar")
    assert record.success, record.reason_text
    assert record.figures["final_position_error"] < 5e-3
