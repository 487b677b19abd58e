"""Forward kinematics of a serial robot with its tip, for one posture or many at once.

The origin of the tip frame T is the centre of the tip's sphere; its z axis points along
the tool, out of the flange. The tool yaw is defined in ``tool.py``; for an upright tool
it is the angle of T's x axis in the world's horizontal plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.robots.facts import (
    TIP,
    RobotFacts,
    rotation_from_rpy,
)
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

OFF_VERTICAL = 1e-4
"""Deviation [rad; m] below which an axis counts as vertical. It allows for rounded
angles in files.
"""


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


@dataclass(frozen=True)
class ArmKinematics:
    """Poses of the links and the tip of one robot for its n joint positions q.

    Every method takes q of shape (n,) or (..., n) and returns arrays with the same
    leading shape. Axes are those of the world; angles are in [rad], lengths in [m].
    """

    facts: RobotFacts
    # [m] of the base link's origin in the world
    base: tuple[float, float, float] = (0.0, 0.0, 0.0)
    base_yaw: float = 0.0  # [rad] about the world's z
    tip_length: float = 0.15  # [m] from the flange to the centre of the tip's sphere
    tip_radius: float = 0.02  # [m]

    @cached_property
    def _chain(self) -> tuple[Array, Array, Array, Array]:
        """Constant data of each moving joint and of the tip.

        They are the pose of each joint's frame in the previous one, split into
        constant, sine, cosine and slide terms (4, n, 1, 4, 4); the tip's frame in the
        last joint (4, 4); the axes (n, 1, 1, 3); and a mask of the sliding joints (n,
        1).
        """
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = rotation_from_rpy((0.0, 0.0, self.base_yaw)), self.base
        parts = []
        for joint in self.facts.joints:
            step = np.eye(4)
            step[:3, :3], step[:3, 3] = rotation_from_rpy(joint.rpy), joint.xyz
            T = T @ step
            if joint.kind != "fixed":
                constant = T.copy()
                sine = np.zeros((4, 4))
                cosine = np.zeros((4, 4))
                slide = np.zeros((4, 4))
                if joint.kind == "prismatic":
                    slide[:3, 3] = T[:3, :3] @ joint.axis
                else:
                    K = _skew(np.array(joint.axis))
                    sine[:3, :3], cosine[:3, :3] = T[:3, :3] @ K, -T[:3, :3] @ K @ K
                    constant -= cosine
                parts.append((constant, sine, cosine, slide))
                T = np.eye(4)
        T[:3, 3] += self.tip_length * T[:3, 2]
        slides = np.array([[float(j.kind == "prismatic")] for j in self.facts.moving])
        axes = np.array([j.axis for j in self.facts.moving])
        return (
            np.array(parts).swapaxes(0, 1)[:, :, None],
            T,
            axes[:, None, None],
            slides,
        )

    @cached_property
    def span(self) -> tuple[Array, float, float]:
        """Shoulder (3,) [m] in the world, distance [m] of the tip from the wrist along
        the tool, and largest distance [m] between wrist and shoulder.

        The shoulder is a fixed point on the first axis, the wrist a point on the last
        axis. Joint limits are ignored. The largest distance is infinite for an arm with
        slides, or if the tool is off the last axis.
        """
        (constant, _, cosine, _), tip, axes, slides = self._chain
        T = (constant + cosine)[:, 0]
        axis = axes[:, 0, 0]
        out = T[0, :3, :3] @ axis[0]
        shoulder = T[0, :3, 3] + out * (axis[0] @ T[1, :3, 3])
        beside = np.linalg.norm(np.cross(axis[-1], tip[:3, 3])) + np.linalg.norm(
            np.cross(axis[-1], tip[:3, 2])
        )
        if slides.any() or beside > 1e-9:
            return shoulder, 0.0, np.inf
        # the wrist: where the last axis comes nearest to the one before it
        before = T[-1, :3, :3].T @ axis[-2]
        out = axis[-1]
        normal = np.cross(out, before)
        origin = -(T[-1, :3, :3].T @ T[-1, :3, 3])
        wrist = origin @ np.cross(before, normal) / max(normal @ normal, 1e-12) * out
        # the links from each axis to the next, and where it is shorter over two of them
        # at once, the one between turned so that they reach farthest
        links = [T[1, :3, 3] - axis[0] * (axis[0] @ T[1, :3, 3]), *T[2:-1, :3, 3]]
        links.append(T[-1, :3, 3] + T[-1, :3, :3] @ wrist)
        longest = [0.0, float(np.linalg.norm(links[0]))]
        for i in range(1, len(links)):
            path = longest[i] + float(np.linalg.norm(links[i]))
            a = T[i, :3, :3].T @ links[i - 1]
            b = links[i]
            along = axis[i] @ (a + b)
            across = [np.linalg.norm(np.cross(axis[i], v)) for v in (a, b)]
            longest.append(
                min(path, longest[i - 1] + float(np.hypot(along, sum(across))))
            )
        return shoulder, float((tip[:3, 3] - wrist) @ tip[:3, 2]), longest[-1]

    @cached_property
    def turning(self) -> float:
        """Sense in which the first joint turns the arm about the base's vertical: 1 if
        counter-clockwise from above, -1 if clockwise, 0 if it does not.
        """
        _, tip, J = self.tip_and_jacobian(self.facts.home)
        out = tip - self.base
        for sense in (1.0, -1.0):
            turn = sense * np.array([0.0, 0.0, 1.0, -out[1], out[0], 0.0])
            if np.allclose(J[:, 0], turn, rtol=0.0, atol=OFF_VERTICAL):
                return sense
        return 0.0

    def _frames(self, q: Array) -> Array:
        """Frames (n + 1, m, 4, 4) of the n joints and the tip in the world, for q (m,
        n).
        """
        (constant, sine, cosine, slide), tip, _, slides = self._chain
        turns = q.T[:, :, None, None]
        frames = np.empty((len(constant) + 1, len(q), 4, 4))
        frames[:-1] = constant + np.sin(turns) * sine + np.cos(turns) * cosine
        if slides.any():
            frames[:-1] += turns * slide
        for i in range(1, len(constant)):
            np.matmul(frames[i - 1], frames[i].copy(), out=frames[i])
        np.matmul(frames[-2], tip, out=frames[-1])
        return frames

    def tip_pose(self, q: Array) -> tuple[Array, Array]:
        """Rotation R_WT (..., 3, 3) and position p_WT (..., 3) of the tip frame."""
        q = np.asarray(q, dtype=np.float64)
        T = self._frames(q.reshape(-1, q.shape[-1]))[-1].reshape(*q.shape[:-1], 4, 4)
        return T[..., :3, :3], T[..., :3, 3]

    def jacobian(self, q: Array) -> Array:
        """Jacobian J (..., 6, n): the tip frame's [angular; linear] velocity per joint
        speed.

        It is in world axes.
        """
        return self.tip_and_jacobian(q)[2]

    def tip_and_jacobian(self, q: Array) -> tuple[Array, Array, Array]:
        """Pose R_WT (..., 3, 3), p_WT (..., 3) and Jacobian J (..., 6, n) at once."""
        q = np.asarray(q, dtype=np.float64)
        lead = q.shape[:-1]
        n = q.shape[-1]
        frames = self._frames(q.reshape(-1, n))
        _, _, axes, slides = self._chain
        T = frames[-1].reshape(*lead, 4, 4)
        # (n, m) each
        dx, dy, dz = (frames[:-1, :, :3, :3] * axes).sum(axis=-1).transpose(2, 0, 1)
        ax, ay, az = (frames[-1, :, :3, 3] - frames[:-1, :, :3, 3]).transpose(2, 0, 1)
        J = np.array(
            [dx, dy, dz, dy * az - dz * ay, dz * ax - dx * az, dx * ay - dy * ax]
        )
        if slides.any():
            J = np.where(slides, np.concatenate([np.zeros_like(J[:3]), J[:3]]), J)
        return T[..., :3, :3], T[..., :3, 3], J.transpose(2, 0, 1).reshape(*lead, 6, n)

    def link_poses(self, q: Array) -> dict[str, tuple[Array, Array]]:
        """Rotation (..., 3, 3) and origin (..., 3) of every link from base to flange,
        and of ``TIP``.
        """
        q = np.asarray(q, dtype=np.float64)
        lead = q.shape[:-1]
        frames = self._frames(q.reshape(-1, q.shape[-1])).reshape(-1, *lead, 4, 4)
        R = np.broadcast_to(rotation_from_rpy((0.0, 0.0, self.base_yaw)), (*lead, 3, 3))
        p = np.broadcast_to(np.array(self.base, dtype=np.float64), (*lead, 3))
        out = {self.facts.base: (R, p)}
        moved = iter((T[..., :3, :3], T[..., :3, 3]) for T in frames)
        for joint in self.facts.joints:
            if joint.kind == "fixed":
                R, p = out[joint.parent]
                out[joint.child] = (
                    R @ rotation_from_rpy(joint.rpy),
                    p + R @ np.array(joint.xyz),
                )
            else:
                out[joint.child] = next(moved)
        out[TIP] = next(moved)
        return out

    def tool_yaw(self, q: Array, attitude: ToolAttitude = UPRIGHT) -> Array:
        """Tool yaw (...) [rad], in (-pi, pi]."""
        return attitude.yaw(self.tip_pose(q)[0])

    def joint_margin(self, q: Array) -> Array:
        """Smallest distances (...) [rad; m of slides] of the joints from their limits.

        Negative outside the limits.
        """
        q = np.asarray(q, dtype=np.float64)
        out: Array = np.minimum(q - self.facts.lower, self.facts.upper - q).min(axis=-1)
        return out
