"""Motion of the pusher towards the position to which it is sent.

It reproduces the step function of the package gym-pusht: a PD law with gains 100 and
20, integrated at 100 Hz (semi-implicit Euler), with ten steps per action. The pusher is
kinematic: nothing that it touches changes its path.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pushpressslide.core.pose import Point

GAIN = 100.0  # [1/s^2]
DAMPING = 20.0  # [1/s]
PERIOD = 0.01  # [s]
PERIODS = 10  # of one action


@dataclass(frozen=True, slots=True)
class Pusher:
    """Position and velocity of the pusher, in W."""

    position: Point  # [px]
    velocity: Point  # [px/s]

    def periods(self, action: Point) -> Iterator[Pusher]:
        """Yield the pusher after each period of an action."""
        x, y = self.position
        vx, vy = self.velocity
        for _ in range(PERIODS):
            vx += (GAIN * (action[0] - x) - DAMPING * vx) * PERIOD
            vy += (GAIN * (action[1] - y) - DAMPING * vy) * PERIOD
            x += vx * PERIOD
            y += vy * PERIOD
            yield Pusher((x, y), (vx, vy))

    def after(self, action: Point) -> Pusher:
        """Pusher at the end of an action."""
        *_, last = self.periods(action)
        return last

    def action_to(self, target: Point) -> Point:
        """Action after which the pusher is at ``target`` [px]. The final position is
        linear in position, velocity and action.
        """
        ax = _action(self.position[0], self.velocity[0], target[0])
        ay = _action(self.position[1], self.velocity[1], target[1])
        return (ax, ay)


def _response(x: float, v: float, action: float) -> float:
    """Coordinate at the end of an action."""
    return Pusher((x, 0.0), (v, 0.0)).after((action, 0.0)).position[0]


FROM_VELOCITY = _response(0.0, 1.0, 0.0)  # [s]
FROM_ACTION = _response(0.0, 0.0, 1.0)


def _action(x: float, v: float, target: float) -> float:
    return x + (target - x - FROM_VELOCITY * v) / FROM_ACTION
