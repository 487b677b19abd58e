"""A force-driven ball that disturbs the object during contact.

It touches nothing but the object, and waits out of sight. When its knock is due, the
ball flies to the object's side, pushes it aside at low height, and leaves. The object
moves by its contact force alone.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from pushpressslide.control.disturbance import ball_of, is_due
from pushpressslide.core.arrays import Array
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.record import Record

RADIUS = 0.02  # [m]
MASS = 0.5  # [kg]
ALOFT = 0.4  # [m] height at which the ball waits, before and after
OFF = 0.2  # [m] before the object, where it does
STANDOFF = 0.03  # [m] before the object, from where it pushes
LOW = 0.04  # [m] height of the push at most, so that nothing tips
FLIGHT = 1.0  # [m/s]
SPEED = 0.1  # [m/s] of the push
STIFFNESS = 2000.0  # [N/m] stiffness of the ball about its commanded position
DAMPING = 63.0  # [N s/m], critical
STRENGTH = 3.0  # largest force, over the friction that holds the object
LONGEST = 3.0  # [s] of a push
GYRATION = 0.3  # squared radius of gyration over the squared radius, approximately
EDGE = 0.01  # [m] of a side that is left free at its ends
NEAR = 0.01  # [m] distance of the ball from its target that counts as reached
BESIDE = 0.7  # largest distance from a side's middle, as a share of its half length
FRICTION = 0.3
NAME = "knocker"


@dataclass(frozen=True)
class Knocked:
    """Result of a disturbance: time of the touch, displacement and rotation of the
    object.
    """

    time: float  # [s] when the ball touched
    moved: float  # [m] of the object along the push, besides its own motion
    turned: float  # [rad] the same


class Knocker:
    """The motion of the ball."""

    def __init__(self, plan: Plan) -> None:
        """Let the ball wait beside the object of ``plan``, whose task has a ball."""
        knock = ball_of(plan.task)
        assert knock is not None
        assert knock.ball is not None
        self.knock = knock
        self.ball = knock.ball
        self.plan = plan
        self.knocked: Knocked | None = None
        self._strongest = STRENGTH * _hold(plan)  # [N]
        self._phase = "waiting"
        self._since = 0.0  # [s] when the phase began
        self._spot, self._inward = self._aim()
        self._depth = -STANDOFF  # [m] beyond the spot
        self._before: Pose2 | None = None  # of the object at the touch, X_WG
        self._last: tuple[float, Pose2] | None = None  # a tick ago: time [s], X_WG
        self._moves: tuple[Point, float] = ((0.0, 0.0), 0.0)  # [m/s], [rad/s] there
        self._led = self._errand(plan.task.true_start)  # [m] where the force leads it

    @property
    def start(self) -> Array:
        """Position (3,) [m] at which the ball waits."""
        return self._led

    def force(self, place: Array, velocity: Array, pose: Pose2, t: float) -> Array:
        """Force (3,) [N] on the ball for the next control period, its weight included,
        at ``place`` [m] with ``velocity`` [m/s]. ``pose`` is the object's X_WG.
        """
        dt = self.plan.task.motion.control_period
        self._decide(place, pose, t)
        self._last = (t, pose)
        if self._phase == "pushing":
            self._depth += SPEED * dt
        ahead = self._errand(self._before or pose) - self._led
        far = float(np.linalg.norm(ahead))
        self._led = self._led + ahead * min(1.0, FLIGHT * dt / max(far, 1e-9))
        force = STIFFNESS * (self._led - place) - DAMPING * velocity
        force *= min(1.0, self._strongest / max(float(np.linalg.norm(force)), 1e-9))
        out: Array = force + np.array([0.0, 0.0, MASS * GRAVITY])
        return out

    def _decide(self, place: Array, pose: Pose2, t: float) -> None:
        """Enter the next phase when it is due."""
        task = self.plan.task
        if self._phase == "waiting" and is_due(self.knock, task, pose, t):
            self._enter_phase("coming", t)
        elif self._phase == "coming":
            if float(np.linalg.norm(self._errand(pose) - place)) < NEAR:
                self._enter_phase("pushing", t)
        elif self._phase == "pushing":
            self._push(place, pose, t)

    def _push(self, place: Array, pose: Pose2, t: float) -> None:
        """Record the touch, and leave once the object has moved far enough."""
        if self._before is None:
            shape = self.plan.task.object.shape
            gap = shape.placed(pose).distance(shapely.Point(place[:2])) - RADIUS
            if gap > 0.0:
                return
            self._before = pose
            self._since = t
            self._moves = self._motion(pose, t)
        before = self._before
        (vx, vy), w = self._moves
        dt = t - self._since
        x, y = before.rotate(self._inward)
        along = (pose.x - before.x - vx * dt) * x + (pose.y - before.y - vy * dt) * y
        turned = abs(wrap_angle(pose.yaw - before.yaw - w * dt))
        ball = self.ball
        enough = along >= ball.moved or (
            turned >= ball.turned and along >= 0.5 * ball.moved
        )
        if enough or t - self._since > LONGEST:
            self.knocked = Knocked(self._since, along, turned)
            self._enter_phase("leaving", t)

    def _motion(self, pose: Pose2, t: float) -> tuple[Point, float]:
        """Velocity [m/s] and yaw rate [rad/s] of the object over the last tick.

        Used before the ball touches the object.
        """
        if self._last is None:
            return (0.0, 0.0), 0.0
        before, last = self._last
        dt = t - before
        velocity = ((pose.x - last.x) / dt, (pose.y - last.y) / dt)
        return velocity, wrap_angle(pose.yaw - last.yaw) / dt

    def _enter_phase(self, phase: str, t: float) -> None:
        self._phase = phase
        self._since = t

    def _aim(self) -> tuple[Point, Point]:
        """A spot in G [m] next to the centre of mass on the long side that is farthest
        from all contacts, and the side's inward normal.
        """
        task = self.plan.task
        X_BG = task.X_GB.inverse()
        contacts = [c.point for c in self.plan.contacts if c.kind == "side"]
        outline = task.object.shape.placed(Pose2()).convex_hull
        corners = shapely.get_coordinates(shapely.orient_polygons(outline))
        sides = list(pairwise(corners))
        longest = max(float(np.linalg.norm(b - a)) for a, b in sides)
        a, b = max(
            (side for side in sides if np.linalg.norm(side[1] - side[0]) > longest / 2),
            key=lambda side: _distance_to_contacts(
                0.5 * (side[0] + side[1]), contacts, X_BG
            ),
        )
        length = float(np.linalg.norm(b - a))
        along = (b - a) / length
        inward = np.array([-along[1], along[0]])
        ball = self.ball
        lever = ball.turned / ball.moved * GYRATION * task.object.radius**2
        # the farther along the side, counter-clockwise, the more it turns to the right
        toward = -1.0 if ball.side == "left" else 1.0
        beside = toward * min(lever, BESIDE * 0.5 * length)
        foot = float((np.array(task.object.center_of_mass) - a) @ along)
        spot = a + min(max(foot + beside, EDGE), length - EDGE) * along
        return (float(spot[0]), float(spot[1])), (float(inward[0]), float(inward[1]))

    def _errand(self, pose: Pose2) -> Array:
        """Target position of the ball [m] for the object at X_WG."""
        height = min(LOW, 0.5 * self.plan.task.object.shape.height)
        height = max(height, RADIUS + 0.002)
        ahead = self._depth
        if self._phase in ("waiting", "leaving"):
            height = ALOFT
            ahead = -OFF
        px, py = pose.apply(self._spot)
        x, y = pose.rotate(self._inward)
        return np.array([px + (ahead - RADIUS) * x, py + (ahead - RADIUS) * y, height])


def with_knock(record: Record, knocker: Knocker) -> Record:
    """A record whose meta has the displacement by a ball that touched."""
    if knocker.knocked is None:
        return record
    return replace(record, meta={**record.meta, "knocked": asdict(knocker.knocked)})


def _hold(plan: Plan) -> float:
    """Planned friction [N] of the support and of the tips on top."""
    press = max(sum(c.load for c in segment.contacts) for segment in plan.segments)
    scene = plan.task.scene
    return scene.max_friction(press) + scene.contact_friction * press


def _distance_to_contacts(middle: Array, contacts: list[Point], X_BG: Pose2) -> float:
    """Distance of a side's middle [m] in G from the nearest contact in B."""
    here = X_BG.apply((float(middle[0]), float(middle[1])))
    return min((math.dist(here, contact) for contact in contacts), default=0.0)
