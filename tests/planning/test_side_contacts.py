"""Positions at which two arms push, with their assignment to arms."""

from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core import margins
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Sensing
from pushpressslide.mechanics.faces import faces
from pushpressslide.planning.side_contacts import (
    assignments,
    contact_height,
    drag_refusal,
    given_to,
    least_distance,
    lone_contact_height,
)

TASK = load_task(
    "parallel-push",
    [
        "object.shape.box=[0.4, 0.4, 0.2]",
        "start.x=0.40",
        "start.y=0.08",
        "goal.x=0.86",
        "goal.y=0.10",
    ],
)
REAR = next(face for face in faces(TASK.object, 0.01) if face.index == 3)
BASES = ((0.0, 0.5, 0.0), (0.0, -0.5, 0.0))


def test_each_arm_takes_the_contact_on_its_own_side_where_they_would_cross_else() -> (
    None
):
    points = ((-0.2, 0.1), (-0.2, -0.1))  # left, right
    assert assignments(BASES, points, [Pose2(0.6, 0.0, 0.0)]) == [(0, 1)]
    assert assignments(BASES, points[::-1], [Pose2(0.6, 0.0, 0.0)]) == [(1, 0)]


def test_contacts_in_line_away_from_the_arms_go_either_way_nearest_first() -> None:
    near = (-0.2, 0.05)
    far = (0.2, 0.0)
    assert assignments(BASES, (near, far), [Pose2(0.6, 0.0, 0.0)]) == [(0, 1), (1, 0)]


def test_a_motion_on_which_either_way_crosses_has_no_assignment() -> None:
    points = ((-0.2, 0.1), (-0.2, -0.1))
    turned = [Pose2(0.6, 0.0, 0.0), Pose2(0.6, 0.0, 3.1)]
    assert assignments(BASES, points, turned) == []


def test_given_contacts_are_in_the_order_of_their_arms() -> None:
    contacts = tuple(
        Contact(i, "side", (0.1 * i, 0.0), (1.0, 0.0), 0.05) for i in range(2)
    )
    given = given_to(contacts, (1, 0))
    assert [c.arm for c in given] == [0, 1]
    assert given[0].point == contacts[1].point


def test_of_given_contacts_the_press_is_first_whichever_arm_has_it() -> None:
    press = Contact(0, "top", (0.0, 0.0), (0.0, 0.0), 0.2)
    push = Contact(1, "side", (-0.2, 0.0), (1.0, 0.0), 0.05)
    assert [c.kind for c in given_to((press, push), (1, 0))] == ["top", "side"]


def test_tips_touch_low_but_keep_their_wrists_above_the_object() -> None:
    def at(height: float) -> float:
        body = replace(TASK.object, shape=Box((0.4, 0.4, height)))
        return contact_height(replace(TASK, object=body).scene, TASK.motion)

    reach = TASK.robots[0].tip_length
    assert at(0.10) == pytest.approx(0.04)
    assert at(0.20) == pytest.approx(0.20 + 0.04 - reach)
    assert contact_height(TASK.scene, replace(TASK.motion, contact_height=0.11)) == 0.11


def test_tools_lean_where_a_push_over_the_wrist_would_tip_the_object() -> None:
    def at(width: float, friction: float) -> float:
        body = replace(TASK.object, shape=Box((width, width, 0.20)))
        support = replace(TASK.support, friction=friction)
        task = replace(TASK, object=body, support=support)
        return lone_contact_height(task.scene, TASK.motion)

    upright = 0.20 + 0.04 - TASK.robots[0].tip_length
    stands = margins.PUSH_STANDS * 0.5 / upright  # width over friction
    assert at(0.3 / stands * 1.01, 0.3) == pytest.approx(upright)
    assert at(0.3 / stands * 0.99, 0.3) == pytest.approx(0.04)
    assert at(0.05, 1e-9) == pytest.approx(upright)  # nothing tips without friction


def test_the_ends_of_a_face_is_told_from_the_com() -> None:
    body = replace(TASK.object, shape=Box((0.4, 0.3, 0.2)), center_of_mass=(0.0, 0.05))
    rear = next(face for face in faces(body, 0.01) if face.index == 3)
    assert rear.ends == pytest.approx((-0.2, 0.1))


def test_what_stands_against_a_push_is_told_with_the_number() -> None:
    assert drag_refusal(TASK.query, (REAR,), 1, 0.09) is None
    assert "200 mm high" in str(drag_refusal(TASK.query, (REAR,), 1, 0.21))
    heavy = replace(TASK, belief=replace(TASK.full_belief, mass=20.0))
    assert "needs 58.9 N" in str(drag_refusal(heavy.query, (REAR,), 1, 0.09))
    tall = replace(TASK, object=replace(TASK.object, shape=Box((0.1, 0.4, 0.9))))
    rear = next(face for face in faces(tall.object, 0.01) if face.index == 3)
    assert "allowed up to 158.3 mm" in str(drag_refusal(tall.query, (rear,), 1, 0.4))


def test_a_tip_may_be_a_little_over_the_edge_and_less_where_it_is_smooth() -> None:
    radius = max(robot.tip_radius for robot in TASK.robots)
    top = TASK.object.shape.height

    def refused(over: float, friction: float) -> bool:
        task = replace(TASK, contact_friction=friction)
        refusal = drag_refusal(task.query, (REAR,), 1, top + over * radius)
        return refusal is not None and refusal.code == "above_object"

    assert not refused(0.99 * margins.OVER_EDGE, 0.8)
    assert refused(1.01 * margins.OVER_EDGE, 0.8)
    smooth = margins.OVER_EDGE_FRICTION * 0.2
    assert not refused(0.99 * smooth, 0.2)
    assert refused(1.01 * smooth, 0.2)


def test_a_push_that_is_not_felt_before_the_object_slides_is_refused() -> None:
    """A box of 15 g slides at 0.045 N; a contact is felt from 0.05 N on."""
    light = replace(TASK, belief=replace(TASK.full_belief, mass=0.015))
    refusal = drag_refusal(light.query, (REAR,), 1, 0.09)
    assert refusal is not None
    assert refusal.code == "light"
    assert refusal.allowed == margins.ARM.felt_force
    refusal = drag_refusal(light.query, (REAR,), 2, 0.09)
    assert refusal is not None
    assert refusal.allowed == margins.ARM.least_friction
    noisy = replace(TASK, sensing=Sensing(force_noise=1.0))
    # of a mean of 25 measurements, whose variance is that of one over 49
    assert noisy.sensing.felt_force == pytest.approx(4.0 / 7.0)
    # what noise hides is seen to move: it refuses no more than an exact sensor does
    assert drag_refusal(noisy.query, (REAR,), 2, 0.09) is None
    hidden = replace(light, sensing=noisy.sensing)
    for contacts in (1, 2):
        exact = drag_refusal(light.query, (REAR,), contacts, 0.09)
        assert drag_refusal(hidden.query, (REAR,), contacts, 0.09) == exact


def test_tools_need_room() -> None:
    assert least_distance(TASK.scene) == pytest.approx(0.10)
