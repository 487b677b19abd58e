"""Joint torques that the model of an arm does not explain: weight and friction that it
lacks, and errors of the motors.

They are observed from the joints' acceleration under known torques and a measured
contact force (De Luca and Mattone, ICRA 2005, with the contact force known).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.execution.arm import ArmDynamics

FILTER_TIME = 0.1
"""Time constant [s] of the estimate, slower than a touch and quicker than a motion."""
RESOLUTION = 0.01
"""Share of a joint's effort limit below which its estimate counts as zero: torques are
not known better.
"""


@dataclass(slots=True)
class TorqueErrorObserver:
    """Estimate of the unexplained torques of one arm.

    It corrects nothing before one of them is above what the arm resolves.
    """

    effort: Array  # (n,) [N m]
    estimate: Array = field(init=False)  # (n,) [N m] acting along the joints
    awake: bool = False
    _before: ArmDynamics | None = None  # at the last tick
    _known: Array = field(init=False)  # (n,) [N m] then acting, by the model
    _resolved: Array = field(init=False)  # (n,) [N m] below which it counts as zero

    def __post_init__(self) -> None:
        self.estimate = np.zeros(len(self.effort))
        self._known = np.zeros(len(self.effort))
        self._resolved = RESOLUTION * self.effort

    def observe(self, arm: ArmDynamics, elapsed: float) -> None:
        """Take the joints' velocity ``elapsed`` [s] after the torques of ``acted`` began
        to change it.
        """
        before = self._before
        if before is None or elapsed <= 0.0:
            return
        error = before.M @ (arm.v - before.v) / elapsed - self._known
        share = min(1.0, elapsed / FILTER_TIME)
        self.estimate += share * (error - self.estimate)
        self._before = None
        if not self.awake:
            self.awake = bool((abs(self.estimate) > self._resolved).any())

    def acted(self, arm: ArmDynamics, torque: Array, force: Array) -> None:
        """Note the ``torque`` (n,) [N m] that is applied in this tick, and the
        ``force`` (3,) [N] of the tip on the object, in world axes.
        """
        self._before = arm
        self._known = torque - arm.bias - arm.J[3:].T @ force

    def corrected(self, arm: ArmDynamics) -> ArmDynamics:
        """An arm whose bias also compensates the estimate."""
        if not self.awake:
            return arm
        return replace(arm, bias=arm.bias - self.estimate)
