"""Capabilities of a robot over a table: its reach, and its largest press and push."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.constants import GRAVITY
from pushpressslide.robots.facts import RobotFacts, rotation_from_rpy
from pushpressslide.robots.inverse import solve_ik
from pushpressslide.robots.kinematics import ArmKinematics

STEP = 1e-5  # [rad; m] step for the derivative of the potential energy
POINTS = 15  # points along a side of the grid over the table
HEIGHT = 0.1  # [m] height of the tip above the base's foot, as on a low object
MARGIN = 0.05  # [rad] distance from the joint limits


@dataclass(frozen=True)
class Workspace:
    """Tip positions over a table with the tool pointing down, and the largest forces
    there.
    """

    points: Array  # (k, 3) [m] in the base's frame
    reached: NDArray[np.bool_]  # (k,)
    # (k,) [N] down; NaN if out of reach, infinite without torque limits
    press: Array
    push: Array  # (k,) [N] in the worst horizontal direction


def potential_energy(kin: ArmKinematics, q: Array) -> Array:
    """Potential energy (...) [J] of the links in postures (..., n). The rod is assumed
    to be massless.
    """
    poses = dict(kin.link_poses(q))
    for joint in kin.facts.branches:
        R, p = poses[joint.parent]
        poses[joint.child] = (
            R @ rotation_from_rpy(joint.rpy),
            p + R @ np.array(joint.xyz),
        )
    total: Array = np.zeros(q.shape[:-1])
    for link in kin.facts.links:
        if link.mass > 0.0 and link.name in poses:
            R, p = poses[link.name]
            total = total + GRAVITY * link.mass * (p + R @ np.array(link.com))[..., 2]
    return total


def gravity_torque(kin: ArmKinematics, q: Array) -> Array:
    """Torque (m, n) [N m] that holds the arm's own weight in postures (m, n)."""
    out = np.empty_like(q)
    for i in range(q.shape[-1]):
        step = np.zeros(q.shape[-1])
        step[i] = STEP
        rise = potential_energy(kin, q + step) - potential_energy(kin, q - step)
        out[..., i] = rise / (2.0 * STEP)
    return out


def largest_force(kin: ArmKinematics, q: Array, direction: Array) -> Array:
    """Largest force (m,) [N] of the tip along a unit ``direction`` (3,) in the world,
    in postures (m, n).

    The joint torques must also hold the arm's own weight.
    """
    effort = kin.facts.effort_limit
    weight = gravity_torque(kin, q)
    per_newton = kin.jacobian(q)[:, 3:].transpose(0, 2, 1) @ direction
    with np.errstate(divide="ignore", invalid="ignore"):
        left = (effort - np.sign(per_newton) * weight) / np.abs(per_newton)
    left[np.isnan(left)] = np.inf
    out: Array = np.maximum(left.min(axis=1), 0.0)
    return out


def largest_press(kin: ArmKinematics) -> float:
    """Largest downward force [N] of an arm anywhere over the table, with the tool down.
    Infinite without torque limits, or if no position is within reach.
    """
    found = workspace(kin)
    return float(found.press[found.reached].max(initial=0.0)) or math.inf


def too_weak(kin: ArmKinematics) -> tuple[str, float, float] | None:
    """Joint that cannot hold the arm's own weight in its ready posture, with the
    required torque and its limit [N m; N]. None if all joints can.
    """
    facts = kin.facts
    needed = np.abs(gravity_torque(kin, facts.home[None])[0])
    worst = int(np.argmax(needed / facts.effort_limit))
    limit = float(facts.effort_limit[worst])
    if needed[worst] <= limit:
        return None
    return facts.moving[worst].name, float(needed[worst]), limit


def workspace(kin: ArmKinematics, height: float = HEIGHT) -> Workspace:
    """Workspace with the tip at ``height`` [m] above the foot of the base, which is at
    the origin.
    """
    reach = float(np.linalg.norm(kin.tip_pose(kin.facts.home)[1]))
    side = np.linspace(-2.0 * reach, 2.0 * reach, POINTS)
    x, y = np.meshgrid(side, side, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, height)], axis=1)
    found = solve_ik(kin, points, joint_margin=MARGIN)
    ok = found.converged
    press = np.full(len(points), np.nan)
    push = np.full(len(points), np.nan)
    if ok.any():
        q = found.q[ok]
        press[ok] = largest_force(kin, q, np.array([0.0, 0.0, -1.0]))
        angles = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
        along = [np.array([np.cos(a), np.sin(a), 0.0]) for a in angles]
        push[ok] = np.min([largest_force(kin, q, u) for u in along], axis=0)
    return Workspace(points, ok, press, push)


def missing_limits(facts: RobotFacts) -> Mapping[str, list[str]]:
    """Joints without a limit of speed or torque, by the limit's field."""
    out = {}
    for key, name in (("speed_deg_s", "velocity"), ("torque", "effort")):
        without = [j.name for j in facts.moving if np.isinf(getattr(j, name))]
        if without:
            out[key] = without
    return out


def limits_to_fill(facts: RobotFacts) -> str:
    """Text for the task file with the limits that a robot's file lacks, with ``...``
    for numbers to fill in. Empty if none are missing.
    """
    lacking = missing_limits(facts)
    items = []
    for joint in facts.moving:
        keys = [f"{key}: ..." for key, names in lacking.items() if joint.name in names]
        if keys:
            items.append(f"{{joint: {joint.name}, {', '.join(keys)}}}")
    return f"[{', '.join(items)}]" if items else ""
