"""An object pushed from one side as a rear-steer car: fitted to the exact limit surface,
and its paths.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.scene import Scene
from pushpressslide.core.task import Motion, Task
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.faces import Face
from pushpressslide.mechanics.top import rooms_inside
from pushpressslide.mechanics.virtual_axle import turned
from pushpressslide.planning.dubins import shortest_path
from pushpressslide.planning.run_in import longest_way, with_run_in
from pushpressslide.planning.side_contacts import contact_height, drag_refusal
from pushpressslide.rom.drives import ORIGIN, RearSteerDrive
from pushpressslide.rom.rear_steer_car import STEERING_LIMIT, RearSteerCar

RESOLUTION = 6  # of the base
# of the force at which a push is looked at, up to the one that the object must stand,
# and on to the cone's edge
ANGLES = (5, 3)
SIDES = (1.0, -1.0)  # left and right of the heading axis
LEAST_EDGE = 1e-3  # [rad] of the cone to one side, for a heading axis outside it
TURNING_LIMIT = math.radians(360.0)  # of all arcs together: one loop, no spiral


class Comfort(NamedTuple):
    """How comfortable a path is."""

    run_in: float  # of the planned one
    harder: float  # times the planned share of the curvature that friction limits
    speed: float  # of the planned one


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
    """One path of the virtual front axle."""

    drive: RearSteerDrive  # of the car that is fitted to it
    path: ArcPath
    run_in: float  # [m]
    curvature_share: float
    speed: float  # [m/s]


def looked_at(scene: Scene, motion: Motion, face: Face) -> Array:
    """Return the force angles (2, 8) [rad] to the left and to the right of the heading
    axis at which a push on ``face`` is looked at, up to the cone's edges.
    """
    half = math.atan(scene.contact_friction)
    aside = math.atan2(face.offset, face.depth)  # of the normal from the heading axis
    edges = np.clip([half + aside, half - aside], LEAST_EDGE, STEERING_LIMIT)
    below, above = ANGLES
    planned = motion.curvature_margin
    shares = np.concatenate(
        [
            planned * np.arange(1, below + 1) / below,
            np.linspace(planned, 1.0, above + 1)[1:],
        ]
    )
    return np.outer(edges, shares)


def push_twists(scene: Scene, motion: Motion, pushed: Sequence[Face]) -> Array:
    """Return the twists (n, 2, 8, 3) of the CoM that pushes on n faces drive at the
    angles ``looked_at``, to the left and to the right; NaN from that angle on at which
    the object tips to either side.
    """
    count = sum(ANGLES)
    feet = np.repeat([face.foot for face in pushed], 2 * count, axis=0)
    axes = np.array(
        [
            turned(_towards_center(face), side * angle)
            for face in pushed
            for side, angles in zip(SIDES, looked_at(scene, motion, face), strict=True)
            for angle in angles
        ]
    )
    lift = contact_height(scene, motion) * scene.support.friction
    base = DraggedBase(scene.body, lift, RESOLUTION)
    slid = base.slide(np.zeros_like(feet), feet, axes)
    shifts = lift * slid.shares[:, None] * axes
    shifts /= 1.0 - margins.PUSH_TIPPING_MARGIN
    tips = np.isnan(slid.shares) | (rooms_inside(scene.body, shifts) < 0.0)
    twists = slid.twists.reshape(-1, 2, count, 3)
    tipped = np.logical_or.accumulate(tips.reshape(-1, 2, count).any(axis=1), axis=1)
    return np.where(tipped[:, None, :, None], math.nan, twists)


def _towards_center(face: Face) -> Point:
    """Return the unit vector from a face's foot to the CoM; of a foot that is there,
    the face's normal.
    """
    x, y = face.foot
    lever = math.hypot(x, y)
    return (-x / lever, -y / lever) if lever > 0.0 else face.normal


def contact_refusal(task: Task, face: Face, height: float) -> Refusal | None:
    """Return what stands against one push on a face at ``height`` [m]: the contact's
    place, tipping, the force; None if nothing.
    """
    if face.depth <= 0.0:
        text = "the centre of mass is not before the face but beside or behind it"
        return Refusal("offset_contact", text)
    allowed = task.scene.contact_friction * face.depth
    offset = abs(face.offset)
    if offset >= allowed:
        text = (
            "a straight push needs the contact within {allowed:mm.0f} of the line "
            "through the CoM, it is {figure:mm.0f} off"
        )
        return Refusal("offset_contact", text, offset, allowed, "m")
    return drag_refusal(task, (face,), 1, height)


def fitted_car(
    scene: Scene, motion: Motion, face: Face, twists: Array, share: float
) -> tuple[RearSteerCar, float]:
    """Return the reduced model of a push on ``face`` along a path whose hardest turn is
    ``share`` of the tightest, and how far ahead of the CoM its CoP is [m].

    On the exact limit surface, under the load that the push itself shifts, both the
    axle's place and the effective wheelbase change with the force angle. The car has
    those of the angles at which the path turns, between one side and the other: there
    its curvature is ``share`` of the tightest among ``twists`` (from ``push_twists``),
    and the car is steered to no tighter curves. A car with a longer wheelbase than the
    object's is stable, one with a shorter one is not. A thin bar that is pushed across
    its length turns nearly as tightly at 8 degrees as at the cone's edge, and a thinner
    one less tightly beyond.

    Raises RefusedError where the object tips at the planned share of the edge.
    """
    mu = scene.contact_friction
    height = contact_height(scene, motion)
    shift = height * scene.support.friction
    if scene.rho is not None:
        return RearSteerCar(face.foot, face.normal, ORIGIN, scene.rho, mu), shift
    if np.isnan(twists[:, : ANGLES[0]]).any():
        text = "a push at {figure:mm.0f} tips the object where it turns"
        raise RefusedError(Refusal("tipping", text, height, unit="m"))
    lever = math.hypot(*face.foot)
    ex = -face.foot[0] / lever
    ey = -face.foot[1] / lever
    standing = ~np.isnan(twists[0, :, 0])
    vx, vy, w = np.moveaxis(twists[:, standing], -1, 0)
    curvatures = w / (vx * ex + vy * ey)
    tangents = np.tan(looked_at(scene, motion, face)[:, standing])
    wheelbases = tangents.sum(axis=0) / (curvatures[1] - curvatures[0])
    across = ey * vx - ex * vy
    axles = (across[0] - across[1]) / (w[0] - w[1])
    # an ellipsoid about the shifted CoP has both equal; the longer one is stable
    wheelbases = np.maximum(wheelbases, axles - shift)
    turns = tangents.mean(axis=0) / wheelbases
    turning = share * float(turns.max())
    first = int(np.argmax(turns >= turning))
    rising = slice(max(first - 1, 0), first + 1)
    axle = float(np.interp(turning, turns[rising], axles[rising]))
    wheelbase = float(np.interp(turning, turns[rising], wheelbases[rising]))
    rho = math.sqrt(lever * wheelbase)
    leftward, rightward = (tangents / wheelbases).max(axis=1)  # forces, not turns
    bounds = (-float(leftward), float(rightward))
    car = RearSteerCar(face.foot, face.normal, ORIGIN, rho, mu, bounds)
    return car, axle - wheelbase


def shortest_length(task: Task, drive: RearSteerDrive) -> float:
    """Return the length [m] of the shortest path of a car."""
    low, high = drive.car.curvature_limits
    return shortest_path(*axle_ends(task, drive), high, -low).length


def route(task: Task, drives: Mapping[float, RearSteerDrive]) -> tuple[Route, bool]:
    """Return the most comfortable path without a loop, and False. Where each has a loop,
    return the one with the longest run-in, if it is not much longer than the shortest,
    and True. ``drives`` are those of the cars fitted to the paths, by how much harder
    than planned these turn.
    """
    routes = []
    for gentle, comfort in product((True, False), COMFORT):
        routes.append(_routed(task, drives, comfort, gentle))
        if not _looped(task, routes[-1].path):
            break
    best = routes[-1]
    if _looped(task, best.path):
        *_, hardest = COMFORT
        for run_in, *_ in COMFORT:
            routes.append(_routed(task, drives, hardest._replace(run_in=run_in), False))
        most = margins.LOOP_FOR_RUN_IN * min(one.path.length for one in routes)
        loops = [one for one in routes if one.path.length <= most]
        best = max(loops, key=lambda one: (one.run_in, -one.path.length))
    turns = [abs(k) for k, _ in best.path.pieces if k]
    if turns:
        best = best._replace(speed=min(best.speed, margins.ARM.turn_rate / max(turns)))
    return best, _looped(task, best.path)


def _routed(
    task: Task, drives: Mapping[float, RearSteerDrive], comfort: Comfort, gentle: bool
) -> Route:
    """Return the shortest path of one comfort; a ``gentle`` one has no turn so tight that
    it slows the whole way down.
    """
    motion = task.motion
    drive = drives[comfort.harder]
    low, high = drive.car.curvature_limits
    share = planned_share(motion, comfort.harder)
    speed = comfort.speed * motion.speed
    if gentle:
        share = min(share, margins.ARM.turn_rate / (speed * max(high, -low)))
    least = margins.CAR_RUN_IN_UNSURE if task.told.belief.center_error else 0.0
    run_in = max(least, comfort.run_in) * motion.run_in
    path = with_run_in(axle_ends(task, drive), high * share, -low * share, run_in)
    return Route(drive, path, run_in, share, speed)


def planned_share(motion: Motion, harder: float) -> float:
    """Return the share of the tightest curvature that a path ``harder`` than planned
    may use.
    """
    return min(1.0, harder * motion.curvature_margin)


def axle_ends(task: Task, drive: RearSteerDrive) -> tuple[Pose2, Pose2]:
    """Return the poses of a car's axle at the start and at the goal."""
    start, goal = (X_WB.compose(drive.X_BV) for X_WB in task.body_ends)
    return start, goal


def _looped(task: Task, path: ArcPath) -> bool:
    """Whether a path is longer than one without a loop."""
    end = path.pose(path.length)
    return path.length > longest_way(task, math.dist(path.start.position, end.position))


def route_onward(
    ends: tuple[Pose2, Pose2], drive: RearSteerDrive, longest: float, turning: float
) -> ArcPath | None:
    """Return the first path of the virtual front axle between its ``ends`` that is no
    longer than ``longest`` [m], from the planned one to the tightest, and turns by about
    ``turning`` [rad]; None if none is.
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
