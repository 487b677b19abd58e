"""The forward model of one action, without the package."""

import math

import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide_studies.pusht.forward import predicted
from pushpressslide_studies.pusht.pushes import Push, pushed_pose
from pushpressslide_studies.pusht.servo import Pusher
from pushpressslide_studies.pusht.tee import FACES

START = Pose2(250.0, 240.0, 0.4)
SHORT = 0.5  # [px] of a push, in which the contact hardly slides


def touching(index: int, left: float) -> Pusher:
    return Pusher(START.apply(FACES[index].pusher(left)), (0.0, 0.0))


def test_the_action_to_a_target_ends_there() -> None:
    pusher = Pusher((100.0, 300.0), (70.0, -200.0))
    action = pusher.action_to((110.0, 280.0))
    assert pusher.after(action).position == pytest.approx((110.0, 280.0))


def test_a_pusher_that_does_not_touch_moves_nothing() -> None:
    pusher = Pusher(START.apply((200.0, 0.0)), (0.0, 0.0))
    target = START.apply((230.0, 40.0))
    assert predicted(START, pusher, pusher.action_to(target)) == START


def test_a_pusher_that_slides_along_a_face_moves_nothing() -> None:
    pusher = touching(0, -30.0)
    action = pusher.action_to(START.apply(FACES[0].pusher(30.0)))
    end = predicted(START, pusher, action)
    assert end.position == pytest.approx(START.position, abs=1e-9)
    assert end.yaw == pytest.approx(START.yaw, abs=1e-12)


@pytest.mark.parametrize("index", range(len(FACES)))
def test_a_short_push_is_the_arc_of_the_limit_surface(index: int) -> None:
    face = FACES[index]
    left = 0.5 * (face.left + face.right) + 2.0
    pusher = touching(index, left)
    push = Push(index, left, SHORT)
    target = pushed_pose(START, push).apply(face.pusher(left))
    end = predicted(START, pusher, pusher.action_to(target))
    moved = math.dist(end.position, START.position)
    direction = (
        (end.x - START.x) / moved,
        (end.y - START.y) / moved,
    )
    # the contact slides by the part of a pixel that the T turns
    assert direction == pytest.approx(START.rotate(face.normal), abs=0.01)
    turn = (end.yaw - START.yaw) / moved
    assert turn == pytest.approx(push.curvature, rel=0.02)


def test_a_pusher_in_the_corner_moves_both_parts_alike() -> None:
    # bar and stem are touched at once, and the T moves along the pusher's way
    corner = (30.0, 0.0)
    pusher = Pusher(START.apply(corner), (0.0, 0.0))
    target = START.apply((corner[0] - 3.0, corner[1] - 3.0))
    end = predicted(START, pusher, pusher.action_to(target))
    x, y = end.unapply(pusher.after(pusher.action_to(target)).position)
    assert x == pytest.approx(corner[0], abs=0.6)
    assert y == pytest.approx(corner[1], abs=0.6)
