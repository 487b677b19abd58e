"""Input of planner and controller: the belief if it is given, otherwise the truth."""

from dataclasses import replace

import pytest

from pushpressslide.core import margins
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import (
    Belief,
    Box,
    ObjectModel,
    Obstacle,
    Support,
    Task,
)

TASK = Task(
    "t",
    ObjectModel(Box((0.4, 0.2, 0.1)), 2.0, (0.01, 0.0)),
    Pose2(0.5, 0.0, 0.0),
    Pose2(0.6, 0.0, 0.0),
    (),
    support=Support(friction=0.3),
    obstacles=(
        Obstacle("post", Box((0.1, 0.1, 0.1)), Pose2(1.0, 0.0), True, 0.5, 0.4),
    ),
    start_error=Pose2(0.01, 0.0, 0.1),
)
WRONG = Belief(0.5, 0.7, 3.0, (0.0, 0.02), 0.11)


def test_without_a_belief_the_truth_is_told() -> None:
    scene = TASK.scene
    assert (scene.body, scene.support) == (TASK.object, TASK.support)
    assert scene.contact_friction == TASK.contact_friction
    assert scene.obstacles == TASK.obstacles


def test_what_is_believed_is_told_in_place_of_the_truth() -> None:
    scene = replace(TASK, belief=WRONG).scene
    assert scene.support.friction == 0.5
    assert scene.contact_friction == 0.7
    assert scene.body.mass == 3.0
    assert scene.body.center_of_mass == (0.0, 0.02)
    assert scene.rho == 0.11


def test_how_sure_a_belief_is_is_told_along_with_it() -> None:
    unsure = replace(WRONG, friction_error=0.2, center_error=0.01)
    scene = replace(TASK, belief=unsure).scene
    assert scene.center_error == 0.01
    assert scene.least_contact_friction == pytest.approx(0.8 * 0.7)
    # a use as believed, times what it is at worst, is within what is allowed
    for use, allowed in zip(scene.friction_uses, margins.FRICTION_USES, strict=True):
        assert use * (1.2 / 0.8) == pytest.approx(allowed)
    assert replace(TASK, belief=WRONG).scene.friction_uses == margins.FRICTION_USES


def test_a_changed_truth_is_believed_unless_a_belief_was_given() -> None:
    heavy = replace(TASK, object=replace(TASK.object, mass=5.0))
    assert heavy.scene.body.mass == 5.0
    assert heavy.scene.weight_on == pytest.approx(5.0 * 9.81)
    assert replace(heavy, belief=WRONG).scene.body.mass == 3.0


def test_masses_and_frictions_of_other_bodies_are_believed() -> None:
    (post,) = TASK.obstacles
    other = replace(post, believed_mass=0.8, believed_friction=0.6)
    task = replace(TASK, obstacles=(other,))
    (told,) = task.scene.obstacles
    assert (told.mass, told.friction) == (0.8, 0.6)
    assert task.obstacles[0].mass == 0.5


def test_the_body_frame_has_its_origin_where_the_centre_of_mass_is_believed() -> None:
    task = replace(TASK, belief=WRONG)
    frame = task.X_GB
    assert frame == Pose2(0.0, 0.02, 0.0)
    assert frame == task.scene.body.X_GB
    assert task.center_error == pytest.approx((-0.01, 0.02))
    assert task.query.body_ends[0] == task.start.compose(task.X_GB)


def test_a_task_that_dares_is_planned_without_errors_and_keeps_them() -> None:
    unsure = replace(WRONG, friction_error=0.2, center_error=0.01, mass_error=0.3)
    sure = replace(TASK, belief=WRONG).scene
    daring = replace(TASK, belief=unsure, dares=True)
    scene = daring.scene
    assert scene.planned_center_error == 0.0
    assert scene.least_contact_friction == sure.least_contact_friction
    assert scene.friction_uses == sure.friction_uses
    assert scene.most_friction == sure.most_friction
    assert scene.run_ins == sure.run_ins
    # the controller still knows that it does not know
    assert (scene.friction_error, scene.center_error, scene.mass_error) == (
        0.2,
        0.01,
        0.3,
    )
    assert daring.full_belief == unsure
