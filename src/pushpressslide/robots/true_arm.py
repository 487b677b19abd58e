"""The real arm, for physics: a robot and its facts with the errors of ``core.truth``."""

from __future__ import annotations

import math
from dataclasses import replace

from pushpressslide.core.control import Vector3
from pushpressslide.core.task import Robot
from pushpressslide.core.truth import EXACT, Truth
from pushpressslide.robots.facts import JointFacts, RobotFacts


def true_robot(robot: Robot, truth: Truth) -> Robot:
    """A robot with its base where it really stands."""
    dx, dy = truth.arm_base
    x, y, z = robot.base
    yaw = robot.base_yaw + truth.arm_base_yaw
    return replace(robot, base=(x + dx, y + dy, z), base_yaw=yaw)


def true_facts(facts: RobotFacts, truth: Truth) -> RobotFacts:
    """Facts about a robot with the true masses and viscous frictions."""
    if truth == EXACT:
        return facts
    factor = truth.link_mass
    links = tuple(
        replace(
            link,
            mass=factor * link.mass,
            inertia=tuple(factor * value for value in link.inertia),
        )
        for link in facts.links
    )
    joints = tuple(_damped(joint, truth.viscous_friction) for joint in facts.joints)
    return replace(facts, links=links, joints=joints)


def _damped(joint: JointFacts, share: float) -> JointFacts:
    """A joint with more viscous friction. A joint without limits has no more."""
    added = share * joint.effort / joint.velocity
    if share == 0.0 or not math.isfinite(added):
        return joint
    return replace(joint, damping=joint.damping + added)


def tip_center(length: float, truth: Truth) -> Vector3:
    """Position [m] of the tip's centre in the flange's frame. ``length`` [m] is that of
    the rod.
    """
    x, y, z = truth.tip_offset
    return (x, y, length + z)
