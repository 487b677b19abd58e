"""Forward kinematics of a serial robot with its tip: arrays in, arrays out, one posture or many at once.

Tip frame T: origin at the centre of the tip's sphere, z along the tool out of the flange. The tool yaw is
defined in ``tool.py``; for an upright tool it is the angle of T's x axis in the world's horizontal plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.task import Robot
from pushpressslide.robots.facts import MODELS, RobotFacts, load_facts, rotation_from_rpy
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

Array = NDArray[np.float64]


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


@dataclass(frozen=True)
class ArmKinematics:
    """Where the links and the tip of one robot are, for its n joint positions q.

    Every method takes q of shape (n,) or (..., n) and returns arrays with the same leading shape. World axes;
    angles in rad, lengths in m.
    """

    facts: RobotFacts
    base: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m] of the base link's origin in the world
    base_yaw: float = 0.0  # [rad] about the world's z
    tip_length: float = 0.15  # [m] from the flange to the centre of the tip's sphere
    tip_radius: float = 0.02  # [m]

    @cached_property
    def _chain(self) -> tuple[Array, Array, Array, Array, Array, Array, Array]:
        """Of each joint, in the frame before it: R, p, axis, K, K^2, whether it slides; last: the tip."""
        R, p = rotation_from_rpy((0.0, 0.0, self.base_yaw)), np.array(self.base, dtype=np.float64)
        rotations, positions, axes = [], [], []
        for joint in self.facts.joints:
            p = p + R @ np.array(joint.xyz)
            R = R @ rotation_from_rpy(joint.rpy)
            if joint.kind != "fixed":
                rotations.append(R)
                positions.append(p)
                axes.append(np.array(joint.axis))
                R, p = np.eye(3), np.zeros(3)
        p = p + R @ np.array([0.0, 0.0, self.tip_length])
        K = np.stack([_skew(a) for a in axes])
        slides = np.array([j.kind == "prismatic" for j in self.facts.moving])
        tip = np.concatenate([R, p[:, None]], axis=1)
        return (
            np.stack(rotations),
            np.stack(positions),
            np.stack(axes),
            K,
            K @ K,
            slides.astype(np.float64),
            tip,
        )

    def _frames(self, q: Array) -> tuple[list[Array], list[Array]]:
        """Rotations and origins of the n moved joint frames, and of the tip, in the world."""
        R0, p0, axes, K, KK, slides, tip = self._chain
        turn = q * (1.0 - slides)
        local = np.eye(3) + np.sin(turn)[..., None, None] * K + (1.0 - np.cos(turn))[..., None, None] * KK
        local = R0 @ local
        shift = p0 + (R0 @ axes[..., None])[..., 0] * (q * slides)[..., None]
        R, p = local[..., 0, :, :], shift[..., 0, :]
        rotations, origins = [R], [p]
        for i in range(1, self.facts.size):
            p = p + (R @ shift[..., i, :, None])[..., 0]
            R = R @ local[..., i, :, :]
            rotations.append(R)
            origins.append(p)
        rotations.append(R @ tip[:, :3])
        origins.append(p + R @ tip[:, 3])
        return rotations, origins

    def tip_pose(self, q: Array) -> tuple[Array, Array]:
        """Return R_WT (..., 3, 3) and p_WT (..., 3) of the tip frame."""
        rotations, origins = self._frames(np.asarray(q, dtype=np.float64))
        return rotations[-1], origins[-1]

    def jacobian(self, q: Array) -> Array:
        """Return J (..., 6, n): [angular; linear] velocity of the tip frame, world axes, per joint speed."""
        return self.tip_and_jacobian(q)[2]

    def tip_and_jacobian(self, q: Array) -> tuple[Array, Array, Array]:
        """Return R_WT (..., 3, 3), p_WT (..., 3) and J (..., 6, n) at once."""
        rotations, origins = self._frames(np.asarray(q, dtype=np.float64))
        axes, slides = self._chain[2], self._chain[5]
        direction = (np.stack(rotations[:-1], axis=-3) @ axes[..., None])[..., 0]  # (..., n, 3)
        arm = origins[-1][..., None, :] - np.stack(origins[:-1], axis=-2)
        turning = (1.0 - slides)[:, None]
        J = np.concatenate(
            [direction * turning, np.cross(direction, arm) * turning + direction * slides[:, None]], axis=-1
        )
        return rotations[-1], origins[-1], np.swapaxes(J, -1, -2)

    def link_poses(self, q: Array) -> dict[str, tuple[Array, Array]]:
        """Return rotation (..., 3, 3) and origin (..., 3) of every link from base to flange, and of "tip"."""
        q = np.asarray(q, dtype=np.float64)
        rotations, origins = self._frames(q)
        lead = q.shape[:-1]
        R = np.broadcast_to(rotation_from_rpy((0.0, 0.0, self.base_yaw)), (*lead, 3, 3))
        p = np.broadcast_to(np.array(self.base, dtype=np.float64), (*lead, 3))
        out = {self.facts.base: (R, p)}
        moved = iter(zip(rotations, origins, strict=True))
        for joint in self.facts.joints:
            if joint.kind == "fixed":
                R, p = out[joint.parent]
                out[joint.child] = (R @ rotation_from_rpy(joint.rpy), p + R @ np.array(joint.xyz))
            else:
                out[joint.child] = next(moved)
        out["tip"] = next(moved)
        return out

    def tool_yaw(self, q: Array, attitude: ToolAttitude = UPRIGHT) -> Array:
        """Return the tool yaw (...) [rad], in (-pi, pi]."""
        return attitude.yaw(self.tip_pose(q)[0])

    def joint_margin(self, q: Array) -> Array:
        """Return the least distance (...) [rad; m of slides] of a joint to its limits; negative outside."""
        q = np.asarray(q, dtype=np.float64)
        out: Array = np.minimum(q - self.facts.lower, self.facts.upper - q).min(axis=-1)
        return out


def arm_kinematics(robot: Robot) -> ArmKinematics:
    """Return the kinematics of a task's robot.

    Raises PushPressSlideError for a model that is not in ``facts.MODELS`` nor a readable URDF or SDF file.
    """
    if robot.model in MODELS:
        facts, tip_length = load_facts(robot.model), robot.tip_length
    else:
        from pushpressslide.robots.description import read_description

        facts, tip_length = read_description(robot.model, robot.tip_frame), 0.0
    return ArmKinematics(facts, robot.base, robot.base_yaw, tip_length, robot.tip_radius)
