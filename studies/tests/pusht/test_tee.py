"""The T as an object of the package."""

import math

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.core.wrench import Twist
from pushpressslide_studies.pusht.pushes import Push, curvature, pushed_pose
from pushpressslide_studies.pusht.tee import (
    BODY,
    CENTER,
    FACES,
    GOAL_BODY,
    OUTLINE,
    PUSHER_RADIUS,
    RHO,
    SURFACE,
    overlap,
)

every_face = pytest.mark.parametrize("index", range(len(FACES)))


def places(index: int) -> list[float]:
    face = FACES[index]
    return np.linspace(face.right, face.left, 5).tolist()


def test_the_pusher_can_touch_all_eight_faces() -> None:
    assert sorted(face.face.index for face in FACES) == list(range(len(OUTLINE)))


@every_face
def test_a_pusher_at_a_face_touches_nothing_else(index: int) -> None:
    for left in places(index):
        x, y = FACES[index].pusher(left)
        distance = BODY.shape.distance((x + CENTER[0], y + CENTER[1]))
        assert distance == pytest.approx(PUSHER_RADIUS, abs=1e-9)
        assert FACES[index].place((x, y)) == pytest.approx(left)


@every_face
def test_without_friction_the_curvature_is_the_offset_over_rho_squared(
    index: int,
) -> None:
    for left in places(index):
        assert curvature(FACES[index], left) == pytest.approx(-left / RHO**2)


@every_face
def test_the_force_of_a_push_is_along_the_normal_through_the_contact(
    index: int,
) -> None:
    face = FACES[index]
    for left in places(index):
        nx, ny = face.normal
        needed = SURFACE.wrench(Twist(nx, ny, curvature(face, left)))
        force = (needed.fx, needed.fy)
        x, y = face.contact(left)
        assert nx * force[1] - ny * force[0] == pytest.approx(0.0, abs=1e-12)
        assert x * force[1] - y * force[0] == pytest.approx(needed.tau)


@every_face
def test_a_push_in_parts_is_the_whole_push(index: int) -> None:
    for left in places(index):
        start = Pose2(200.0, 150.0, 0.7)
        whole = pushed_pose(start, Push(index, left, 60.0))
        part = start
        for _ in range(3):
            part = pushed_pose(part, Push(index, left, 20.0))
        assert part.position == pytest.approx(whole.position)
        assert part.yaw == pytest.approx(whole.yaw)


def test_the_goal_is_covered_by_the_t_at_the_goal_alone() -> None:
    assert overlap(GOAL_BODY) == pytest.approx(1.0)
    aside = Pose2(GOAL_BODY.x + 1.0, GOAL_BODY.y, GOAL_BODY.yaw)
    turned = Pose2(GOAL_BODY.x, GOAL_BODY.y, GOAL_BODY.yaw + math.pi)
    assert overlap(turned) < overlap(aside) < 1.0
