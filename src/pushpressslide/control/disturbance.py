"""When the knocks of a task begin, and the forces of those that are forces."""

from __future__ import annotations

from pushpressslide.core.control import Vector3
from pushpressslide.core.knock import Knock
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.planning.free_space import displacement

ROUNDING = 1e-9  # [s]


def is_due(knock: Knock, task: Task, pose: Pose2, time: float) -> bool:
    """Whether a knock of ``task`` begins by ``time`` [s], with the object at ``pose``,
    X_WG.
    """
    if knock.time is not None:
        return time >= knock.time - ROUNDING
    assert knock.share is not None
    shape = task.object.shape
    whole = displacement(shape, task.true_start, task.goal)
    return displacement(shape, task.true_start, pose) >= knock.share * whole


def ball_of(task: Task) -> Knock | None:
    """The knock of ``task`` by a ball, or None."""
    return next((one for one in task.disturbances if one.ball is not None), None)


class Pushes:
    """The knocks of a task by forces, during one run."""

    def __init__(self, task: Task) -> None:
        """Wait for the first push of ``task``."""
        self._task = task
        self._knocks = [one for one in task.disturbances if one.push is not None]
        # [s] at which each began; None: not yet
        self.times: list[float | None] = [None for _ in self._knocks]

    def __bool__(self) -> bool:
        return bool(self._knocks)

    def wrench(self, pose: Pose2, time: float) -> Vector3:
        """Force [N] along x and y and moment [N m] at the object's centre of mass for
        the next control period, in world axes.

        The object is at ``pose``, X_WG, at ``time`` [s].
        """
        fx = fy = moment = 0.0
        for i, knock in enumerate(self._knocks):
            push = knock.push
            assert push is not None
            began = self.times[i]
            if began is None:
                if not is_due(knock, self._task, pose, time):
                    continue
                self.times[i] = began = time
            if time - began < push.duration - ROUNDING:
                fx += push.force[0]
                fy += push.force[1]
                moment += push.moment
        return fx, fy, moment
