"""Paths of an object pushed from one side as a rear-steer car."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product
from typing import NamedTuple

from pushpressslide.core import margins
from pushpressslide.core.motion import Motion
from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import Ends, MotionQuery
from pushpressslide.core.refusal import Refusal
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.dubins import shortest_path
from pushpressslide.planning.run_in import longest_way, with_run_in
from pushpressslide.planning.side_contacts import drag_refusal
from pushpressslide.planning.workspace import poses_of, workspace_refusal
from pushpressslide.rom.drives import RearSteerDrive
from pushpressslide.rom.rear_steer_car import RearSteerCar

TURNING_LIMIT = math.radians(360.0)  # sum of all arcs: one loop, no spiral


class Comfort(NamedTuple):
    """One step on the scale from gentle to hard paths."""

    run_in: float  # share of the planned value
    harder: float  # factor on the planned share of the friction-limited curvature
    speed: float  # share of the planned value


# From comfortable to hard. Near the cone's edge the contact's sideways jumps must be
# smaller: they grow with the speed.
COMFORT = (
    Comfort(1.0, 1.0, 1.0),
    Comfort(0.6, 1.0, 1.0),
    Comfort(0.6, 1.2, 0.8),
    Comfort(0.35, 1.2, 0.7),
    Comfort(0.25, 1.35, 0.6),
    Comfort(0.1, 1.35, 0.5),
    Comfort(0.0, 1.35, 0.5),
)
HARDER = sorted({comfort.harder for comfort in COMFORT})


class Route(NamedTuple):
    """A path of the virtual front axle, with its run-in and hardness."""

    drive: RearSteerDrive  # of the car that is fitted to it
    path: ArcPath
    run_in: float  # [m]
    curvature_share: float
    speed: float  # [m/s]

    @property
    def time(self) -> float:
        """Time [s] at full speed."""
        return self.path.length / self.speed


def contact_refusal(query: MotionQuery, face: Face, height: float) -> Refusal | None:
    """Refusal of one push on a face at ``height`` [m] because of its place, tipping or
    its force, or None.
    """
    if face.depth <= 0.0:
        text = (
            "the centre of mass is not in front of the face but next to it or behind it"
        )
        return Refusal("offset_contact", text)
    allowed = query.scene.contact_friction * face.depth
    offset = abs(face.offset)
    if offset >= allowed:
        text = (
            "a straight push needs the contact within {allowed:mm.0f} of the line "
            "through the CoM, it is {figure:mm.0f} off"
        )
        return Refusal("offset_contact", text, offset, allowed, "m")
    return drag_refusal(query, (face,), 1, height)


def shortest_length(ends: Ends, drive: RearSteerDrive) -> float:
    """Length [m] of a car's shortest path."""
    low, high = drive.car.curvature_limits
    return shortest_path(*axle_ends(ends, drive), high, -low).length


def route(
    query: MotionQuery, drives: Mapping[float, RearSteerDrive]
) -> tuple[Route, bool]:
    """Gentlest path without a loop, and False; or if every path has a loop, one of
    these, and True.

    Of the allowed paths with a loop, the quickest of those with the longest run-in is
    taken; much longer ones than the shortest do not count. ``drives`` holds the drives
    of the cars fitted to the paths. Each key is the factor by which the paths turn
    harder than planned.
    """
    routes = []
    radius = query.body.radius
    for gentle, comfort in product((True, False), COMFORT):
        routes.append(_routed(query, drives, comfort, gentle))
        if not _looped(radius, routes[-1].path):
            break
    best = routes[-1]
    if _looped(radius, best.path):
        *_, hardest = COMFORT
        for run_in, *_ in COMFORT:
            routes.append(
                _routed(query, drives, hardest._replace(run_in=run_in), False)
            )
        routes = [one for one in routes if _allowed(query, one)] or routes
        upper = margins.LOOP_FOR_RUN_IN * min(one.path.length for one in routes)
        loops = [one for one in routes if one.path.length <= upper]
        best = max(loops, key=lambda one: (one.run_in, -one.time))
    return best, _looped(radius, best.path)


def _routed(
    query: MotionQuery,
    drives: Mapping[float, RearSteerDrive],
    comfort: Comfort,
    gentle: bool,
) -> Route:
    """Shortest path of one step of ``COMFORT``. A ``gentle`` path has no turn so tight
    that it slows down the whole path.
    """
    motion = query.motion
    drive = drives[comfort.harder]
    low, high = drive.car.curvature_limits
    share = planned_share(motion, comfort.harder)
    speed = comfort.speed * motion.speed
    if gentle:
        share = min(share, margins.ARM.turn_rate / (speed * max(high, -low)))
    lower = margins.CAR_RUN_IN_UNSURE if query.scene.planned_center_error else 0.0
    run_in = max(lower, comfort.run_in) * motion.run_in
    path = with_run_in(
        axle_ends(query.body_ends, drive), high * share, -low * share, run_in
    )
    turns = [abs(k) for k, _ in path.sections if k]
    if turns:
        speed = min(speed, margins.ARM.turn_rate / max(turns))
    return Route(drive, path, run_in, share, speed)


def _allowed(query: MotionQuery, one: Route) -> bool:
    """Whether an object that is pushed along a route stays in the workspace, and does
    not turn too much.
    """
    if turning_refusal(one.path) is not None:
        return False
    poses = poses_of(one.path, one.drive.X_BV)
    return workspace_refusal(query.body, query.limits, poses) is None


def planned_share(motion: Motion, harder: float) -> float:
    """Fraction of the tightest curvature that a path may use: ``harder`` times the
    planned fraction, at most 1.
    """
    return min(1.0, harder * motion.curvature_margin)


def axle_ends(ends: Ends, drive: RearSteerDrive) -> Ends:
    """Poses of a car's axle at the ``ends`` X_WB of a path."""
    start, goal = (X_WB.compose(drive.X_BV) for X_WB in ends)
    return start, goal


def _looped(radius: float, path: ArcPath) -> bool:
    """Whether a path is longer than the limit for a path without a loop."""
    end = path.pose(path.length)
    direct = math.dist(path.start.position, end.position)
    return path.length > longest_way(radius, direct)


def resume_route(
    ends: tuple[Pose2, Pose2], drive: RearSteerDrive, longest: float, turning: float
) -> ArcPath | None:
    """First path of the virtual front axle between its ``ends`` that is at most
    ``longest`` [m] and turns by about ``turning`` [rad], or None.

    Paths are tried from the planned curvature to the tightest.
    """
    low, high = drive.car.curvature_limits
    planned = drive.curvature_share
    for share in (planned, 0.5 * (1.0 + planned)):
        for kept in margins.RUN_INS_ONWARD:
            run_in = kept * drive.run_in
            path = with_run_in(ends, share * high, -share * low, run_in, turning)
            if path.length <= longest and abs(path.turning - turning) <= math.pi:
                return path
    return None


def cone_margin(car: RearSteerCar, path: ArcPath) -> float:
    """Smallest margin [rad] of the forces along the path inside the friction cone."""
    low, high = car.steering_limits
    steering = [car.steering(curvature) for curvature, _ in path.sections] or [0.0]
    return min(min(high - angle, angle - low) for angle in steering)


def turning_refusal(path: ArcPath) -> Refusal | None:
    """Refusal of the path's arcs, or None."""
    turning = sum(abs(curvature) * length for curvature, length in path.sections)
    if turning <= TURNING_LIMIT:
        return None
    text = "the path turns by {figure:deg.0f}, allowed {allowed:deg.0f}"
    return Refusal("turning", text, turning, TURNING_LIMIT, "rad")
