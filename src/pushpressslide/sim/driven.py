"""Clearance of the arms along their actual motion, from the record of a run."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform

from pushpressslide.arms.paths.capsules import least_distance
from pushpressslide.arms.paths.clearance import LOOK
from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.true_task import true_task
from pushpressslide.robots.true_arm import true_robot
from pushpressslide.sim.clearance import DrakeClearance
from pushpressslide.sim.convert import transform_from_positions
from pushpressslide.sim.outline import arm_capsules

PERIOD = 0.02  # [s] longest time between two checked postures


def with_clearance(record: Record, world_seed: int = 0) -> Record:
    """A record whose meta has the clearance of the arms' actual motion, in the true world
    drawn by ``world_seed``.
    """
    clearance, pair = clearance_driven(record, world_seed)
    driven = {"clearance_driven": clearance, "clearance_pair": pair}
    return replace(record, meta={**record.meta, **driven})


def clearance_driven(record: Record, world_seed: int = 0) -> tuple[float, str]:
    """Smallest distance [m], at most 0.08, of any arm to its surroundings in a run, and
    the names of the nearest pair.

    The surroundings are object, obstacles, support, table and other arms. The distance
    is negative if two shapes intersect. The distance between the object and a tip in
    contact does not count.
    """
    plan = _truly_placed(record.plan, world_seed)
    times = record.arrays["time"]
    if not len(times):
        return LOOK, "nothing was recorded"
    stride = _stride(times)
    arms = range(len(plan.task.robots))
    postures = [record.arrays[f"joint_position_{i}"][::stride] for i in arms]
    least = LOOK
    pair = "nothing within reach"
    poses = {
        name: [transform_from_positions(q) for q in rows[::stride]]
        for name, rows in record.arrays.items()
        if name.startswith("body_") or name == "object_pose_3d"
    }
    body_poses = {
        name.removeprefix("body_"): poses[name] for name in poses if "body_" in name
    }
    placement = record.arrays["placement"][::stride]
    touching = _touching(plan)
    for arm, q in enumerate(postures):
        model = DrakeClearance(plan, arm)
        touches = np.array([arm in touching[int(number)] for number in placement])
        for ticks, shapes in ((touches, model.sphere), (~touches, set())):
            near, between = model.least_in_space(
                q[ticks],
                _poses_at(poses["object_pose_3d"], ticks),
                shapes,
                {name: _poses_at(path, ticks) for name, path in body_poses.items()},
            )
            if near < least:
                least = near
                pair = f"arm {arm}: {between}"
    outlines = [arm_capsules(robot, i) for i, robot in enumerate(plan.task.robots)]
    for i, one in enumerate(outlines):
        for j in range(i):
            near = least_distance(one, outlines[j], postures[i], postures[j], LOOK)
            if near < least:
                least = near
                pair = f"arms {j} and {i}"
    return least, pair


def _truly_placed(plan: Plan, seed: int) -> Plan:
    """A plan in the true world, with the bases where they really stand."""
    task = true_task(plan.task, seed)
    robots = tuple(true_robot(robot, task.truth) for robot in task.robots)
    return replace(plan, task=replace(task, robots=robots))


def _touching(plan: Plan) -> list[frozenset[int]]:
    """Arms that touch the object in each placement."""
    return [
        frozenset(contact.arm for contact in placement.contacts)
        for placement in plan.by_placement
    ]


def _poses_at(
    poses: list[RigidTransform], ticks: NDArray[np.bool_]
) -> list[RigidTransform]:
    return [pose for pose, taken in zip(poses, ticks, strict=True) if taken]


def _stride(times: Array) -> int:
    """Number of ticks between two checked postures."""
    if len(times) < 2:
        return 1
    period = float(np.median(np.diff(times)))
    return max(1, math.floor(PERIOD / period + 1e-9))
