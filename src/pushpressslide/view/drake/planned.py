"""Camera of a live run, chosen from the plan before the run starts."""

from __future__ import annotations

import numpy as np

from pushpressslide.core.control import Vector3
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Robot
from pushpressslide.view.drake.camera import FIELD, Directions, View, fit_view
from pushpressslide.view.drake.sight import Block, Limb, Moment
from pushpressslide.view.drake.subject import LINK_RADIUS, WRIST, corners

SHOULDER = 0.35  # [m] of an arm above its base
ARM_HEIGHT = 0.75  # [m] of an arm above its base that is held in the picture
POSES = 12  # of each segment


def planned_view(plan: Plan, field: float = FIELD, aspect: float = 16 / 9) -> View:
    """View that shows the contacts at their start, and includes object, goal and arms.
    ``field`` [rad] is the vertical field of view.
    """
    task = plan.task
    frame = task.support.frame
    shape = task.object.shape
    points = corners(shape, task.goal)
    for segment in plan.segments:
        for s in np.linspace(0.0, segment.path.length, POSES):
            points += corners(shape, plan.object_pose(segment, float(s)))
    held = [frame.point(point) for point in points]
    arms = [robot for robot in task.robots if robot.model != "hand"]
    for x, y, z in (robot.base for robot in arms):
        held += [(x, y, z), (x, y, z + ARM_HEIGHT)]
    moments = [_moment(part) for part in plan.by_placement]
    pushes = [
        _start(part).rotate(contact.normal)
        for part in plan.by_placement
        for contact in part.contacts
        if contact.kind == "side"
    ]
    along = np.array(pushes).reshape(-1, 2)
    whole = np.array(held)
    towards = Directions(frame, moments, along, whole).best()
    return fit_view(whole, towards, field, aspect)


def _start(placement: Plan) -> Pose2:
    """X_WB at the start of a placement."""
    return placement.segments[0].body_pose(0.0)


def _moment(placement: Plan) -> Moment:
    """Contacts at the start of a placement, and the bodies around them."""
    task = placement.task
    X_WB = _start(placement)
    X_WG = X_WB.compose(task.X_GB.inverse())
    bodies = [(task.object.shape, X_WG), *((o.shape, o.pose) for o in task.obstacles)]
    tips = []
    limbs = []
    for contact in placement.contacts:
        robot = task.robots[contact.arm]
        point, height = contact.tip_place(robot.tip_radius)
        tip = (*X_WB.apply(point), height)
        tips.append(tip)
        limbs += _limbs(placement, robot, tip)
    blocks = [
        Block(tuple(X.apply(c) for c in shape.outline()), shape.height)
        for shape, X in bodies
    ]
    return Moment(tuple(tips), tuple(blocks), tuple(limbs))


def _limbs(placement: Plan, robot: Robot, tip: Vector3) -> list[Limb]:
    """Approximate position of an arm with its tip in contact."""
    frame = placement.task.support.frame
    x, y, z = robot.base
    shoulder = frame.coordinates((x, y, z + SHOULDER))
    hand = (tip[0], tip[1], tip[2] + WRIST)
    above = (tip[0], tip[1], tip[2] + 2.0 * WRIST)
    return [Limb(hand, above, LINK_RADIUS), Limb(above, shoulder, LINK_RADIUS)]
