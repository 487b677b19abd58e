"""An object pushed from one side as a rear-steer car: fitted to the exact limit surface,
and its paths.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.path import ArcPath
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.task import Task
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.run_in import with_run_in
from pushpressslide.rom.drives import ORIGIN, RearSteerDrive
from pushpressslide.rom.rear_steer_car import RearSteerCar

# a path longer than this times the straight distance has turned a loop
LOOP_RATIO = 1.5
# [rad/s] of the object at most: beyond it the tip slips where the steering jumps
TURN_RATE = 0.8
TURNING_LIMIT = math.radians(360.0)  # of all arcs together: one loop, no spiral
# From comfortable to hard: factors on the run-in, on the share of the friction-limited
# curvature that the path uses, and on the speed. Near the cone's edge the contact's
# sideways jumps must be smaller: they grow with the speed.
COMFORT = (
    (1.0, 1.0, 1.0),
    (0.6, 1.0, 1.0),
    (0.6, 1.2, 0.8),
    (0.35, 1.2, 0.7),
    (0.25, 1.35, 0.6),
    (0.1, 1.35, 0.5),
    (0.0, 1.35, 0.5),
)


class Route(NamedTuple):
    """One path of the virtual front axle."""

    path: ArcPath
    run_in: float  # [m]
    curvature_share: float
    speed: float  # [m/s]


def planned_angles(task: Task) -> tuple[float, float]:
    """Force angles [rad]: at which the path turns, and at the cone's edge."""
    edge = math.atan(task.believed.contact_friction)
    return task.motion.curvature_margin * edge, edge


def fitted_car(
    task: Task, face: Face, height: float, twists: Array
) -> tuple[RearSteerCar, float]:
    """Return the reduced model of a push on ``face`` at ``height`` [m], and how far
    ahead of the CoM its CoP is [m].

    On the exact limit surface, under the load that the push itself shifts, both the
    axle's place and the effective wheelbase change with the force angle. The car has
    those of the angle at which the path turns, the first of ``twists``; its friction is
    lowered by the wheelbase's growth up to the cone's edge, so that its tightest curve
    is the object's. Raises RefusedError where the object tips.
    """
    belief = task.believed
    mu = belief.contact_friction
    shift = height * belief.support_friction
    if belief.rho is not None:
        return RearSteerCar(face.foot, face.normal, ORIGIN, belief.rho, mu), shift
    if np.isnan(twists).any():
        text = "a push at {figure:mm.0f} tips the object"
        raise RefusedError(Refusal("tipping", text, height, unit="m"))
    lever = math.hypot(*face.foot)
    ex = -face.foot[0] / lever
    ey = -face.foot[1] / lever

    def car_like(twist: Array, angle: float) -> tuple[float, float]:
        """Distance of the axle from the CoM, and the effective wheelbase [m]."""
        vx, vy, w = (float(part) for part in twist)
        axle = (ey * vx - ex * vy) / w
        wheelbase = -math.tan(angle) * (vx * ex + vy * ey) / w
        # an ellipsoid about the shifted CoP has both equal; the longer one is stable
        return axle, max(wheelbase, axle - shift)

    planned_angle, edge = planned_angles(task)
    axle, wheelbase = car_like(twists[0], planned_angle)
    _, tightest = car_like(twists[1], edge)
    friction = mu * min(1.0, wheelbase / tightest)
    rho = math.sqrt(lever * wheelbase)
    car = RearSteerCar(face.foot, face.normal, ORIGIN, rho, friction)
    return car, axle - wheelbase


def route(task: Task, drive: RearSteerDrive) -> tuple[Route, bool]:
    """Return the most comfortable path without a loop, and False; the shortest one and
    True where each has a loop.
    """
    motion = task.motion
    X_GB = task.object.X_GB
    start = task.start.compose(X_GB).compose(drive.X_BV)
    goal = task.goal.compose(X_GB).compose(drive.X_BV)
    low, high = drive.car.curvature_limits
    straight = math.hypot(goal.x - start.x, goal.y - start.y)
    longest = LOOP_RATIO * straight + 0.02
    routes = []
    for run_share, harder, slower in COMFORT:
        run_in = run_share * motion.run_in
        share = min(1.0, harder * motion.curvature_margin)
        path = with_run_in(start, goal, high * share, -low * share, run_in)
        routes.append(Route(path, run_in, share, slower * motion.speed))
        if path.length <= longest:
            break
    best = routes[-1]
    looped = best.path.length > longest
    if looped:
        best = min(routes, key=lambda one: one.path.length)
    turns = [abs(k) for k, _ in best.path.pieces if k]
    if turns:
        best = best._replace(speed=min(best.speed, TURN_RATE / max(turns)))
    return best, best.path.length > longest


def cone_margin(car: RearSteerCar, path: ArcPath) -> float:
    """Return how far inside the friction cone the path's forces stay [rad]."""
    low, high = car.steering_limits
    steering = [car.steering(curvature) for curvature, _ in path.pieces] or [0.0]
    return min(min(high - angle, angle - low) for angle in steering)


def turning_refusal(path: ArcPath) -> Refusal | None:
    """What stands against following the path's arcs."""
    turning = sum(abs(curvature) * length for curvature, length in path.pieces)
    if turning <= TURNING_LIMIT:
        return None
    text = "the path turns by {figure:deg.0f}, allowed {allowed:deg.0f}"
    return Refusal("turning", text, turning, TURNING_LIMIT, "rad")
