"""What the controller is given instead of the truth: noise, bias, delay and drop-outs of
each sensor (task field ``sensing``).
"""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from typing import Generic, TypeVar

import numpy as np

from pushpressslide.core.control import Measurement, TipState, Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Sensing

T = TypeVar("T")


class DelayLine(Generic[T]):
    """Returns what went in a fixed number of ticks ago; at first, the first that did."""

    def __init__(self, delay: float, dt: float) -> None:
        """Delay by ``delay`` [s], rounded to ticks of ``dt`` [s]."""
        self._line: deque[T] = deque(maxlen=1 + round(delay / dt))

    def through(self, value: T) -> T:
        """Put ``value`` in and return what comes out."""
        self._line.append(value)
        return self._line[0]


class Sensor:
    """The sensors of a run: object pose, tips by the joints, contact forces.

    Asked at every tick of a run, whether or not the controller uses the measurement, so
    that a delay is always one in time. Each sensor has its own stream of noise. What
    ``sensing`` leaves out is exact.
    """

    def __init__(self, sensing: Sensing, seed: int, dt: float) -> None:
        """Prepare the streams and the delay lines; ``dt`` [s] is the control period."""
        self._sensing = sensing
        self._exact = sensing == Sensing()
        streams = np.random.default_rng(seed).spawn(3)
        self._pose_random, self._tip_random, self._force_random = streams
        self._poses: DelayLine[Pose2 | None] = DelayLine(sensing.delay_of_pose, dt)
        self._tips: DelayLine[tuple[TipState, ...]] = DelayLine(
            sensing.delay_of_tips, dt
        )
        self._forces: DelayLine[tuple[Vector3, ...]] = DelayLine(
            sensing.delay_of_force, dt
        )
        self._last_pose: Pose2 | None = None

    def measure(self, truth: Measurement) -> Measurement:
        """Return what is measured at the present time, which is its time stamp.

        A measurement without a new pose holds the last one; the first one is never
        without.
        """
        if self._exact:
            return truth
        pose = self._poses.through(self._pose(truth.object_pose))
        seen = pose is not None
        if pose is None:
            pose = self._last_pose
        self._last_pose = pose
        assert pose is not None
        tips = self._tips.through(tuple(self._tip(tip) for tip in truth.tips))
        forces = self._forces.through(tuple(self._force(t.force) for t in truth.tips))
        felt = tuple(
            replace(tip, force=force) for tip, force in zip(tips, forces, strict=True)
        )
        return Measurement(truth.time, pose, felt, pose_seen=seen)

    def _pose(self, pose: Pose2) -> Pose2 | None:
        s = self._sensing
        x, y, yaw = (float(v) for v in self._pose_random.normal(size=3))
        dropped = float(self._pose_random.random()) < s.pose_dropout
        if dropped and self._last_pose is not None:
            return None
        bias_x, bias_y = s.position_bias
        seen = Pose2(
            pose.x + bias_x + s.position_noise * x,
            pose.y + bias_y + s.position_noise * y,
            pose.yaw + s.yaw_bias + s.yaw_noise * yaw,
        )
        if self._last_pose is None:
            self._last_pose = seen
        return seen

    def _tip(self, tip: TipState) -> TipState:
        s = self._sensing
        noise = s.tip_noise * self._tip_random.normal(size=3)
        return replace(tip, position=_moved(tip.position, s.tip_bias, noise))

    def _force(self, force: Vector3) -> Vector3:
        s = self._sensing
        noise = s.force_noise * self._force_random.normal(size=3)
        return _moved(force, s.force_bias, noise)


def _moved(value: Vector3, bias: Vector3, noise: np.ndarray) -> Vector3:
    x, y, z = (v + b + float(n) for v, b, n in zip(value, bias, noise, strict=True))
    return (x, y, z)
