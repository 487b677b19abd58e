"""Controller of a mode as a policy, from an observation to an action."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal
from pushpressslide.learning.push_task import PERIOD, PushTask, choice
from pushpressslide.modes.base import Tracker
from pushpressslide.modes.rear_push import MODE


class RearPushPolicy:
    """Policy of mode rear_push, with the task's belief.

    The policy plans a path from the first observation of an episode, and then follows
    it by the mode's law.
    """

    def __init__(self, push: PushTask) -> None:
        """Prepare the policy for a task."""
        self._push = push
        # refusal of a path that is followed nevertheless
        self.refusal: Refusal | None = None
        self._segment: Segment | None = None
        self._tracker: Tracker | None = None
        self._progress = 0.0

    @property
    def duration(self) -> float:
        """Duration [s] of the episode's path. 0 before it is planned."""
        return 0.0 if self._segment is None else self._segment.profile.duration

    def reset(self) -> None:
        """Discard the path, so that the next observation is the first of an episode."""
        self._segment = None

    def __call__(self, observation: Array) -> Array:
        """Velocity (2,) [m/s] of the tip in the world.

        ``observation`` (8,) is laid out as ``pushing.OBSERVATION``.
        """
        x, y, yaw, *goal, tip_x, tip_y = np.asarray(observation).tolist()
        X_WG = Pose2(x, y, yaw)
        if self._segment is None:
            query = replace(self._push.task.query, start=X_WG, goal=Pose2(*goal))
            chosen = choice(query, self._push.face)
            (self._segment,) = chosen.segments
            self.refusal = chosen.refusal
            self._tracker = MODE.tracker(query, self._segment)
            self._progress = 0.0
        assert self._tracker is not None
        path = self._segment.path
        left = max(path.length - self._progress, 0.0)
        speed = min(self._segment.profile.speed, left / PERIOD)
        X_WB = X_WG.compose(self._push.task.X_GB)
        guidance = self._tracker.step(path, X_WB, self._progress, speed, 1.0)
        self._progress = guidance.progress
        at_tip = guidance.twist.moved_to(X_WB.unapply((tip_x, tip_y)))
        return np.array(X_WB.rotate((at_tip.vx, at_tip.vy)))
