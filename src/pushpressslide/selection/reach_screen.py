"""Reach of the arms for many motions at once, before any of them is evaluated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import Scene
from pushpressslide.modes import MODES
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.contact_reach import contacts_reached

Able = NDArray[np.bool_]


class ReachScreen:
    """Cache of the contacts that the arms of a task reach, by pose of the object."""

    def __init__(self, query: MotionQuery) -> None:
        """Start with an empty cache."""
        self._query = query
        self._spans: list[Able] = []  # (arms,) at each pose
        self._contacts: dict[str, list[Able]] = {}  # (arms, places) at each pose

    def can_reach(
        self, mode: str, poses: Sequence[Pose2], start: int, end: int
    ) -> bool:
        """Whether ``mode`` may move the object between two of ``poses`` X_WG with the
        same contacts.

        ``start`` and ``end`` are indices of ``poses``; between calls, ``poses`` may
        only be extended. If the result is False, the motion is certainly out of reach.
        If it is True, the motion may still be out of reach.
        """
        new = poses[len(self._spans) :]
        if new:
            self._spans += list(_in_span(self._query.scene, new))
        arms = int((self._spans[start] & self._spans[end]).sum())
        if arms < MODES[mode].arms:
            return False
        known = self._contacts.setdefault(mode, [])
        new = poses[len(known) :]
        if new:
            known += list(touching(self._query, mode, new))
        return bool((known[start] & known[end]).any())


def touching(query: MotionQuery, mode: str, poses: Sequence[Pose2]) -> Able:
    """Mask (n, arms, contacts) of the contacts of ``mode`` that each arm reaches at n
    ``poses`` X_WG.

    The arms are those that may touch the object. If the mode names no candidate
    contacts, there is a single column of True.
    """
    scene = query.scene
    contacts = MODES[mode].candidate_contacts(query)
    if not contacts:
        return np.full((len(poses), len(scene.arms), 1), True)
    bodies = [X.compose(query.X_GB) for X in poses]
    by_arm = [contacts_reached(scene, arm, contacts, bodies) for arm in scene.arms]
    return np.stack(by_arm, axis=1)


def _in_span(scene: Scene, poses: Sequence[Pose2]) -> Able:
    """Mask (n, arms) of the arms that are long enough to touch the object anywhere, at
    n poses.

    Joint limits are ignored, so an object out of span is certainly out of reach.
    """
    import shapely

    shape = scene.body.shape
    placed = [shape.placed(X) for X in poses]
    out = []
    for robot in scene.robots:
        shoulder, wrist, span = arm_kinematics(robot).span
        x, y, z = scene.support.frame.coordinates(shoulder.tolist())
        level = max(z - shape.height - robot.tip_radius, 0.0)
        distances = shapely.distance(placed, shapely.Point(x, y)) - robot.tip_radius
        out.append(np.hypot(distances, level) <= span + abs(wrist))
    return np.column_stack(out)
