"""A camera with the faults of the task field ``sensing``: it takes pictures of the
object's pose, which arrive late, wrong, or not at all.
"""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

import numpy as np

from pushpressslide.control.tracker import ObjectTracker, StampedPose
from pushpressslide.core.pose import Pose2
from pushpressslide.core.sensing import Sensing

FREEZES = (3.0, 15.0)
"""Range [s] from which the start of a freeze is drawn."""


class _Picture(NamedTuple):
    """A measured pose, and the tick at which it arrives."""

    arrival: int
    pose: StampedPose


class Camera:
    """A tracker with sensor faults."""

    def __init__(
        self,
        tracker: ObjectTracker,
        sensing: Sensing,
        random: np.random.Generator,
        dt: float,
    ) -> None:
        """Watch with ``tracker``. ``dt`` [s] is the control period."""
        self.truth = Pose2()  # X_WG as last read
        self._tracker = tracker
        self._sensing = sensing
        self._random = random
        self._faults, self._drifts = random.spawn(2)  # of what is not white noise
        self._dt = dt
        self._delay = round(sensing.delay_of_pose / dt)  # [ticks]
        self._freeze = _freeze(sensing, self._faults)
        self._tick = -1
        self._frame = -1
        self._first: StampedPose | None = None
        self._pose = Pose2()  # X_WG in the last picture
        self._pictures: deque[_Picture] = deque()
        self._noise = np.zeros(3)  # standardised noise of the last picture
        self._drift = np.zeros(2)  # [m]
        self._last = math.nan  # [s] stamp of what was read last
        self._out: StampedPose | None = None  # what that came to
        self._shown = -math.inf  # [s] stamp of the newest pose that has arrived

    def read(self) -> StampedPose | None:
        """The pose that has just arrived. Two readings at one time give the same pose."""
        pose = self._tracker.read()
        if pose is None:
            return None
        if pose.time != self._last:
            self.truth = pose.X_WG
            self._last = pose.time
            self._tick += 1
            self._take(pose)
            self._out = self._arrived()
        return self._out

    def _take(self, pose: StampedPose) -> None:
        """Take a picture of a true ``pose`` if one is due, and put it on its way."""
        rate = self._sensing.pose_rate
        frame = self._tick
        if rate is not None:
            frame = math.floor(self._tick * self._dt * rate + 1e-9)
        if frame == self._frame:
            return
        self._frame = frame
        picture = self._measured(pose)
        if picture is None:
            return
        self._first = self._first or picture
        late = self._sensing.pose_jitter
        if late > 0.0:
            late *= float(self._faults.random())
        arrival = self._tick + self._delay + round(late / self._dt)
        self._pictures.append(_Picture(arrival, picture))

    def _measured(self, pose: StampedPose) -> StampedPose | None:
        """The ``pose`` in a picture. None if the object is not found in it."""
        s = self._sensing
        white = self._random.normal(size=3)
        found = float(self._random.random()) >= s.pose_dropout
        self._noise = self._coloured(white)
        self._walk()
        if not found and self._first is not None:
            return None
        if self._frozen():
            return StampedPose(pose.time, self._pose)
        self._pose = self._wrong(pose.X_WG)
        return StampedPose(pose.time, self._pose)

    def _wrong(self, X_WG: Pose2) -> Pose2:
        """The pose X_WG with bias, drift, noise and resolution, or an outlier."""
        s = self._sensing
        x, y, yaw = self._noise.tolist()
        drift_x, drift_y = self._drift.tolist()
        bias_x, bias_y = s.position_bias
        seen = Pose2(
            self._rounded(X_WG.x + bias_x + drift_x + s.position_noise * x),
            self._rounded(X_WG.y + bias_y + drift_y + s.position_noise * y),
            X_WG.yaw + s.yaw_bias + s.yaw_noise * yaw,
        )
        if s.outlier_rate == 0.0 or self._faults.random() >= s.outlier_rate:
            return seen
        direction, turn = self._faults.uniform(-math.pi, math.pi, size=2).tolist()
        return Pose2(
            seen.x + s.outlier_size * math.cos(direction),
            seen.y + s.outlier_size * math.sin(direction),
            seen.yaw + turn,
        )

    def _rounded(self, place: float) -> float:
        """A ``place`` [m] as the camera resolves it."""
        step = self._sensing.position_step
        return place if step == 0.0 else step * round(place / step)

    def _coloured(self, white: np.ndarray) -> np.ndarray:
        """Noise of unit variance, correlated over ``noise_time``."""
        time = self._sensing.noise_time
        if time == 0.0 or self._first is None:
            return white
        kept = math.exp(-self._between / time)
        out: np.ndarray = kept * self._noise + math.sqrt(1.0 - kept * kept) * white
        return out

    def _walk(self) -> None:
        """Let the drift go on until this picture."""
        drift = self._sensing.position_drift
        if drift > 0.0:
            step = self._drifts.normal(size=2)
            self._drift = self._drift + drift * math.sqrt(self._between) * step

    @property
    def _between(self) -> float:
        """Time [s] between two pictures."""
        rate = self._sensing.pose_rate
        return self._dt if rate is None else 1.0 / rate

    def _frozen(self) -> bool:
        """Whether pictures repeat the last pose now."""
        begin, end = self._freeze
        return self._first is not None and begin <= self._tick * self._dt < end

    def _arrived(self) -> StampedPose | None:
        """The newest pose that has just arrived. The first one is there at once."""
        if self._tick < self._delay:
            self._shown = -math.inf if self._first is None else self._first.time
            return self._first
        arrived = [one.pose for one in self._pictures if one.arrival <= self._tick]
        if not arrived:
            return None
        coming = [one for one in self._pictures if one.arrival > self._tick]
        self._pictures = deque(coming)
        newest = max(arrived, key=lambda pose: pose.time)
        if self._tick > self._delay and newest.time <= self._shown:
            return None  # a newer one has arrived before it
        self._shown = newest.time
        return newest


def _freeze(sensing: Sensing, random: np.random.Generator) -> tuple[float, float]:
    """Start and end [s] of the freeze."""
    begin = sensing.freeze_start
    if begin is None:
        begin = float(random.uniform(*FREEZES))
    return begin, begin + sensing.freeze
