"""What the controller is given instead of the truth: noise and delay (task field
``sensing``).
"""

from __future__ import annotations

from collections import deque

import numpy as np

from pushpressslide.core.control import Measurement, TipState, Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Sensing


class Sensor:
    """Adds seeded white noise and a constant delay to measurements.

    Measurements are exact where the task asks for neither.
    """

    def __init__(self, sensing: Sensing, seed: int, dt: float) -> None:
        """Prepare the noise and the delay line for a control period ``dt`` [s]."""
        self._sensing = sensing
        self._random = np.random.default_rng(seed)
        self._line: deque[Measurement] = deque(maxlen=1 + round(sensing.delay / dt))

    def measure(self, truth: Measurement) -> Measurement:
        """Return what is measured now; the time stamp is always the present."""
        s = self._sensing
        pose = truth.object_pose
        tips = truth.tips
        if s.position_noise > 0.0 or s.yaw_noise > 0.0:
            x, y, yaw = self._random.normal(size=3)
            pose = Pose2(
                pose.x + s.position_noise * x,
                pose.y + s.position_noise * y,
                pose.yaw + s.yaw_noise * yaw,
            )
        if s.force_noise > 0.0:
            tips = tuple(
                TipState(t.position, t.velocity, self._noisy(t.force)) for t in tips
            )
        self._line.append(Measurement(truth.time, pose, tips))
        seen = self._line[0]
        return Measurement(truth.time, seen.object_pose, seen.tips)

    def _noisy(self, force: Vector3) -> Vector3:
        x, y, z = self._sensing.force_noise * self._random.normal(size=3)
        return (force[0] + float(x), force[1] + float(y), force[2] + float(z))
