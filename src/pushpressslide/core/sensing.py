"""Imperfections of a simulated robot's sensors (task field ``sensing``).

SI units and radians; docs/task-file.md documents the fields with the units of a task
file.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core import margins
from pushpressslide.core.checks import check_fields
from pushpressslide.core.control import Vector3
from pushpressslide.core.field_spec import documented, setting
from pushpressslide.core.pose import Point


@documented
@dataclass(frozen=True, slots=True)
class Sensing:
    """Imperfections of the sensors: of the object's pose, of the tips' positions (from
    the joints), and of the contact forces. Noise is white, with a new sample in every
    control period, and that of the pose in every picture.
    """

    position_noise: float = setting(
        0.0, "standard deviation of the object's x and y", "m", "[0, 0.1]"
    )
    yaw_noise: float = setting(
        0.0, "standard deviation of the object's yaw", "deg", "[0, 45]"
    )
    tip_noise: float = setting(
        0.0, "standard deviation of a tip's position, each axis", "m", "[0, 0.01]"
    )
    force_noise: float = setting(
        0.0, "standard deviation of a contact force, each axis", "N", "[0, 100]"
    )
    position_bias: Point = setting(
        (0.0, 0.0), "constant error of the object's x and y", "m", "[-0.1, 0.1]"
    )
    yaw_bias: float = setting(
        0.0, "constant error of the object's yaw", "deg", "[-45, 45]"
    )
    tip_bias: Vector3 = setting(
        (0.0, 0.0, 0.0), "constant error of every tip's position", "m", "[-0.01, 0.01]"
    )
    force_bias: Vector3 = setting(
        (0.0, 0.0, 0.0), "constant error of every contact force", "N", "[-20, 20]"
    )
    delay: float = setting(0.0, "delay of every sensor", "s", "[0, 1]")
    pose_delay: float | None = setting(
        None, "delay of the object's pose; null: `delay`", "s", "[0, 1]"
    )
    tip_delay: float | None = setting(
        None, "delay of the tips' positions; null: `delay`", "s", "[0, 1]"
    )
    force_delay: float | None = setting(
        None, "delay of the contact forces; null: `delay`", "s", "[0, 1]"
    )
    pose_dropout: float = setting(
        0.0,
        "probability that a picture has no measured pose of the object",
        within="[0, 0.95]",
    )
    pose_rate: float | None = setting(
        None,
        "pictures per second; null: one in every control period",
        "Hz",
        "[1, 1000]",
    )
    pose_jitter: float = setting(
        0.0, "largest additional delay of a picture, uniform from 0", "s", "[0, 1]"
    )
    noise_time: float = setting(
        0.0,
        "time over which the noise of the object's pose is correlated; 0: white",
        "s",
        "[0, 60]",
    )
    position_drift: float = setting(
        0.0, "drift of the object's x and y in one second, random walk", "m", "[0, 0.1]"
    )
    position_step: float = setting(
        0.0, "resolution of the object's x and y; 0: exact", "m", "[0, 0.1]"
    )
    outlier_rate: float = setting(
        0.0, "probability that a picture shows a wrong pose", within="[0, 0.95]"
    )
    outlier_size: float = setting(
        0.1, "distance of a wrong pose, whose yaw is any", "m", "[0, 1]"
    )
    freeze: float = setting(
        0.0,
        "duration of a freeze, in which pictures repeat the last pose",
        "s",
        "[0, 60]",
    )
    freeze_start: float | None = setting(
        None, "start of the freeze; null: drawn from 3 to 15 s", "s", "[0, 3600]"
    )
    tip_dropout: float = setting(
        0.0,
        "probability that a control period repeats the last position of a tip",
        within="[0, 0.95]",
    )
    force_dropout: float = setting(
        0.0,
        "probability that a control period repeats the last contact force",
        within="[0, 0.95]",
    )
    force_range: float | None = setting(
        None,
        "largest measured contact force, each axis; null: unbounded",
        "N",
        "(0, 10000]",
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def felt_force(self) -> float:
        """Mean normal force [N] above which a contact is detected."""
        noise = self.force_noise / math.sqrt(2.0 * self.felt_samples - 1.0)
        return max(margins.ARM.felt_force, margins.FELT_SIGMAS * noise)

    @property
    def least_press(self) -> float:
        """Smallest normal force [N] of a press whose loss is surely noticed, and which
        is not taken for lost: noise and bias of a sensor are about equal.
        """
        return max(margins.ARM.least_press, margins.PRESS_SIGMAS * self.force_noise)

    @property
    def felt_samples(self) -> int:
        """Number of measurements of a force that are averaged to detect a contact: as
        many as the noise needs, up to ``margins.FELT_SAMPLES``.
        """
        noise = margins.FELT_SIGMAS * self.force_noise / margins.ARM.felt_force
        return min(margins.FELT_SAMPLES, math.ceil(0.5 * (noise * noise + 1.0)))

    @property
    def felt_noise(self) -> float:
        """Standard deviation [N] of a force averaged over ``felt_samples``."""
        return self.force_noise / math.sqrt(2.0 * self.felt_samples - 1.0)

    @property
    def seen_motion(self) -> float:
        """Displacement [m] above which an object's motion is detected."""
        noise = self.position_noise / math.sqrt(self._seen_pictures)
        return max(margins.ARM.slid, margins.FELT_SIGMAS * noise)

    def seen_turn(self, radius: float) -> float:
        """Turn [rad] above which one of an object with a ``radius`` [m] is detected."""
        noise = self.yaw_noise / math.sqrt(self._seen_pictures)
        return max(margins.ARM.slid / radius, margins.FELT_SIGMAS * noise)

    @property
    def _seen_pictures(self) -> float:
        """Number of pictures whose mean tells whether an object has moved."""
        pictures = 1.0 if self.every_pose else margins.SEEN_TIME * self.picture_rate
        return max(pictures, 1.0)

    @property
    def delay_of_pose(self) -> float:
        """Delay [s] of the object's pose."""
        return self.delay if self.pose_delay is None else self.pose_delay

    @property
    def delay_of_tips(self) -> float:
        """Delay [s] of the tips' positions."""
        return self.delay if self.tip_delay is None else self.tip_delay

    @property
    def delay_of_force(self) -> float:
        """Delay [s] of the contact forces."""
        return self.delay if self.force_delay is None else self.force_delay

    @property
    def oldest_pose(self) -> float:
        """Largest age [s] of a pose that arrives in time, until the next one does."""
        between = 0.0 if self.pose_rate is None else 1.0 / self.pose_rate
        return self.delay_of_pose + self.pose_jitter + between

    @property
    def picture_rate(self) -> float:
        """Pictures per second; those of a usual control period without a stated rate."""
        return self.pose_rate or 250.0

    def lasting_error(self, time: float) -> float:
        """Standard deviation [m] of the object's position after a ``time`` [s], beside
        noise and bias, that more pictures do not lessen: resolution and drift.
        """
        step = self.position_step / math.sqrt(12.0)
        return math.hypot(step, self.position_drift * math.sqrt(time))

    @property
    def every_pose(self) -> bool:
        """Whether every control period has a present pose, wrong by white noise and a
        bias at most.
        """
        faults = (
            self.delay_of_pose,
            self.pose_jitter,
            self.pose_dropout,
            self.noise_time,
            self.position_drift,
            self.outlier_rate,
            self.freeze,
        )
        return self.pose_rate is None and not any(faults)

    @property
    def exact_pose(self) -> bool:
        """Whether every control period has the true pose."""
        errors = (
            self.position_noise,
            self.yaw_noise,
            *self.position_bias,
            self.yaw_bias,
            self.position_step,
        )
        return self.every_pose and not any(errors)

    @property
    def sure(self) -> bool:
        """Whether a single pose and a single force say where and what they are."""
        return self.every_pose and self.force_noise == 0.0 and not any(self.force_bias)

    @property
    def longest_blind(self) -> float:
        """Time [s] without a usable picture after which the arms wait."""
        between = 0.0 if self.pose_rate is None else 1.0 / self.pose_rate
        return self.oldest_pose + max(margins.BLIND_PICTURES * between, margins.BLIND)
