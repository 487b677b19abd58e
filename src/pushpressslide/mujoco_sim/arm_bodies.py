"""One robot as bodies of a MuJoCo model, made from its facts in memory."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.core.truth import EXACT, Truth
from pushpressslide.mujoco_sim.shapes import UNTOUCHED
from pushpressslide.robots.arm_files import mounts_tip, robot_facts, rod_length
from pushpressslide.robots.facts import (
    TIP,
    TIP_MASS,
    JointFacts,
    LinkFacts,
    RobotFacts,
    rotation_from_rpy,
)
from pushpressslide.robots.true_arm import tip_center, true_facts, true_robot

LEAST_INERTIA = 1e-12
"""Inertia [kg m^2] that a link without any is given: MuJoCo refuses zero."""
WEIGHTLESS = 1e-12
"""Mass [kg] of a moving link without one, for the same reason."""


@dataclass(frozen=True)
class ArmNames:
    """Names of one robot's elements in a model."""

    facts: RobotFacts
    joints: tuple[str, ...]  # moving joints, from the base to the tip
    tip: str  # body whose frame is T
    sphere: str  # geom that touches


def add_arm(spec: Any, robot: Robot, index: int, truth: Truth = EXACT) -> ArmNames:
    """Add robot number ``index`` to a specification, with its base fixed in the world.

    The arm differs from the robot by ``truth``. Raises as ``robots.arm_files.robot_facts``.
    """
    robot = true_robot(robot, truth)
    facts = true_facts(robot_facts(robot), truth)
    prefix = f"robot_{index}_"
    links = {link.name: link for link in facts.links}
    turn = quaternion(rotation_from_rpy((0.0, 0.0, robot.base_yaw)))
    base = spec.worldbody.add_body(
        name=prefix + facts.base, pos=list(robot.base), quat=turn
    )
    bodies = {facts.base: base}
    for joint in (*facts.joints, *facts.branches):
        body = bodies[joint.parent].add_body(
            name=prefix + joint.child,
            pos=list(joint.xyz),
            quat=quaternion(rotation_from_rpy(joint.rpy)),
        )
        bodies[joint.child] = body
        moves = joint.kind != "fixed"
        if moves:
            _add_joint(body, joint, prefix)
        _add_inertia(body, links.get(joint.child, LinkFacts(joint.child)), moves)
    tip = _add_tip(bodies[facts.flange], robot, prefix, truth)
    names = tuple(prefix + joint.name for joint in facts.moving)
    return ArmNames(facts, names, tip, prefix + "tip_sphere")


def quaternion(rotation: Array) -> Array:
    """Unit quaternion (w, x, y, z) of a rotation matrix (3, 3)."""
    out = np.zeros(4)
    mujoco.mju_mat2Quat(out, np.ascontiguousarray(rotation).ravel())
    return out


def _add_joint(body: Any, joint: JointFacts, prefix: str) -> None:
    """Add a moving joint with its limits, damping and rotor."""
    turns = joint.kind == "revolute"
    kinds = mujoco.mjtJoint
    added = body.add_joint(
        name=prefix + joint.name,
        type=kinds.mjJNT_HINGE if turns else kinds.mjJNT_SLIDE,
        axis=list(joint.axis),
        armature=joint.armature,
        damping=joint.damping,
    )
    limits = (joint.lower, joint.upper)
    if all(map(math.isfinite, limits)):
        added.range = list(limits)
        added.limited = mujoco.mjtLimited.mjLIMITED_TRUE


def _add_inertia(body: Any, link: LinkFacts, moves: bool) -> None:
    """Give a body the mass and inertia of a link."""
    if link.mass <= 0.0 and not moves:
        return
    xx, yy, zz, xy, xz, yz = link.inertia
    own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    turn = rotation_from_rpy(link.rpy)
    inertia = turn @ own @ turn.T + LEAST_INERTIA * np.eye(3)
    body.explicitinertial = True
    body.mass = max(link.mass, WEIGHTLESS)
    body.ipos = list(link.com)
    rows, columns = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)
    body.fullinertia = inertia[rows, columns]


def _add_tip(flange: Any, robot: Robot, prefix: str, truth: Truth) -> str:
    """Add the tip's body with rod and sphere, and return its name.

    The rod has two thirds of the mass, the sphere one third. A tip that comes from the
    robot's file has no mass of its own.
    """
    name = prefix + TIP
    length = rod_length(robot)
    mass = truth.link_mass * TIP_MASS if mounts_tip(robot) else 0.0
    radius = robot.tip_radius
    tip = flange.add_body(name=name, pos=tip_center(length, truth))
    tip.add_geom(
        name=prefix + "tip_sphere",
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        size=[radius, 0.0, 0.0],
        **(UNTOUCHED | {"mass": mass / 3.0}),
    )
    if length > 0.0:
        tip.add_geom(
            name=prefix + "tip_rod",
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[margins.rod_radius(radius), 0.5 * length, 0.0],
            pos=[0.0, 0.0, -0.5 * length],
            **(UNTOUCHED | {"mass": 2.0 / 3.0 * mass}),
        )
    return name
