"""Path of the run-in of a manoeuvre, steered onto the goal."""

from __future__ import annotations

import pytest

from pushpressslide import load_task
from pushpressslide.core import margins
from pushpressslide.core.path import ArcPath, advance
from pushpressslide.core.pose import Pose2
from pushpressslide.jobs.sampling import random_task
from pushpressslide.modes.press_slide import MODE
from pushpressslide.planning.pressed.driven import steered_path
from pushpressslide.rom.drives import TurnDrive

AHEAD = 0.03  # [m] to the goal: too short for two turns


@pytest.mark.parametrize("share", [0.5 * margins.CORRECTED, 0.9 * margins.MISSED])
def test_a_short_way_is_straight_onto_the_goal(share: float) -> None:
    """Where steering suffices, and where no turns as short as the way lead there."""
    path = onto_goal(share, AHEAD)
    assert [curvature for curvature, _ in path.sections] == [0.0]
    assert path.length == pytest.approx(AHEAD)


def test_what_is_far_from_its_line_is_turned_there() -> None:
    """On a longer way than allowed, so that no plan follows it."""
    path = onto_goal(1.5 * margins.MISSED, AHEAD)
    assert path.length > AHEAD
    assert any(curvature for curvature, _ in path.sections)


def test_a_long_way_turns_onto_its_line() -> None:
    path = onto_goal(0.9 * margins.MISSED, 20.0 * AHEAD)
    assert any(curvature for curvature, _ in path.sections)
    assert path.length < 1.1 * 20.0 * AHEAD


def onto_goal(share: float, ahead: float) -> ArcPath:
    """Return the path of a last turn from beside its line, by a ``share`` of the object's
    radius, ``ahead`` [m] of the goal, no longer than 1.1 times that.
    """
    task = random_task(load_task("press-slide"), 4, seed=7)
    last = MODE.choices(task.query)[0].segments[-1]
    assert isinstance(last.drive, TurnDrive)
    body = task.scene.body
    goal = last.path.end
    back = advance(goal, 0.0, -ahead)
    start = back.compose(Pose2(0.0, share * body.radius, 0.0))
    path = steered_path(body, (start, goal), last.drive, 1.1 * ahead, 0.0)
    assert isinstance(path, ArcPath)
    return path
