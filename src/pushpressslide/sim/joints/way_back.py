"""The way on which a tip is drawn back from the end of its path."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.planning.side_contacts import room_before
from pushpressslide.robots.continuation import continuation
from pushpressslide.sim.joints.arm_problem import CLEARANCE, ArmProblem
from pushpressslide.sim.joints.postures import Posture

SAMPLES = 7
LEAST = 3  # samples of a way back on which a tip is clear of the object


def way_back(problem: ArmProblem, posture: Posture) -> tuple[Array, float]:
    """Return the postures (b, n) [rad] of an arm whose tip is drawn back from its
    contact, evenly spaced, as far as the arm can and is clear; and that way [m].

    The first one is the end of the path along the contact.
    """
    along = problem.along
    assert along is not None
    task = problem.plan.task
    q = posture.q[-1]
    objects = problem.object_path
    room = room_before(task, along.contact, margins.ARM.retreat)
    R, p = problem.kin.tip_pose(q)
    direction = along.contact.direction(objects.bodies[-1])
    normal = np.array(task.support.frame.direction(direction))
    points = np.linspace(p, p - room * normal, SAMPLES)
    yaws = np.full(len(points), posture.attitude.yaw(R))
    way = continuation(
        problem.kin, points, yaws, q, posture.attitude, margins.ARM.joint_buffer
    )
    end = objects.shapes[-1:]

    def clear(i: int) -> bool:
        distance, _ = problem.clearance.least(way.q[i : i + 1], end, touching=True)
        return distance >= CLEARANCE

    reached = len(way.q) if way.failed_at is None else max(1, way.failed_at)
    count = clear_count(clear, reached)
    return way.q[:count], room * (count - 1) / (SAMPLES - 1)


def clear_count(clear: Callable[[int], bool], count: int) -> int:
    """Return how many of ``count`` samples in turn are clear; the first is given."""
    blocked = (i for i in range(1, count) if not clear(i))
    return next(blocked, count)
