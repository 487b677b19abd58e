"""Samples of one planned push from behind, simulated together on arrays: a sweep
without a run loop for each sample.

The plan is made once. Every sample follows the planned path by the mode's law, with the
tip and the servo of the planar engine, on an ellipsoid. Approach, touch and release are
omitted. So are replans, retries, and the online identification of drag, axle and centre
of mass. A sample whose tip leaves the face counts as missed, since there is no new
contact. Obstacles and tipping are not checked.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.batch.path_runs import END, OFF, TIME, PathRuns
from pushpressslide.control import adaptation, estimator, law
from pushpressslide.control.tip_motion import TIP_ACCELERATION
from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Plan
from pushpressslide.core.sensing import Sensing
from pushpressslide.core.task import Task
from pushpressslide.core.truth import EXACT
from pushpressslide.geometry.sides import FlatSide
from pushpressslide.jobs.engines import EngineName, engine_named
from pushpressslide.jobs.rows import Row
from pushpressslide.jobs.sampling import varied_task
from pushpressslide.kernels.path_run import (
    ARRIVED,
    ASTRAY,
    LEFT_FACE,
    UNDER_WAY,
    Lead,
    Touch,
)
from pushpressslide.kernels.tracking import stanley_law
from pushpressslide.mechanics.faces import side_of
from pushpressslide.planning.rear_car_fit import looked_at, push_twists
from pushpressslide.planning.side_contacts import pushable
from pushpressslide.rom.drives import RearSteerDrive
from pushpressslide.selection.solve import solve
from pushpressslide.tracking.rear_car import EASING, figures_of_car

MODE = "rear_push"
AT_ONCE = 2500  # samples, whose figures stay in the processor's cache
REASONS = {
    UNDER_WAY: "still under way at limits.time",
    ARRIVED: "ended outside the tolerance",
    LEFT_FACE: "the tip left the face",
    ASTRAY: "astray from the path",
}


class Truths(NamedTuple):
    """True parameters of n samples of a task."""

    support_friction: Array  # (n,)
    contact_friction: Array  # (n,)
    mass: Array  # (n,) [kg]
    centers: Array  # (n, 2) [m] centres of mass in G
    start_poses: Array  # (n, 3) X_WG: x, y [m] and yaw [rad]
    noise: Array  # (3,) [m], [m], [rad] standard deviations of a measured pose


class Outcomes(NamedTuple):
    """Results of n samples."""

    poses: Array  # (n, 3) final X_WG: x, y [m] and yaw [rad]
    position_errors: Array  # (n,) [m] from the goal
    yaw_errors: Array  # (n,) [rad]
    off_path: Array  # (n,) [m] largest distance of the virtual axle from the path
    slips: Array  # (n,) [m] of the tip along the face, to its left
    times: Array  # (n,) [s] of the motion
    ends: NDArray[np.intp]  # (n,) ARRIVED, LEFT_FACE, ASTRAY or UNDER_WAY
    reached: NDArray[np.bool_]  # (n,) arrived within the tolerance


def drawn_truths(task: Task, seed: int, count: int) -> Truths:
    """The first ``count`` truths drawn by ``jobs.sampling.varied_task``."""
    samples = [varied_task(task, index, seed) for index in range(count)]
    return truths_of(samples)


def truths_of(samples: list[Task]) -> Truths:
    """Truths of tasks that are otherwise equal. The sensor noise is taken from the
    first task.
    """
    starts = [sample.true_start for sample in samples]
    sensing = samples[0].sensing
    spread = sensing.position_noise
    return Truths(
        np.array([sample.support.friction for sample in samples]),
        np.array([sample.contact_friction for sample in samples]),
        np.array([sample.object.mass for sample in samples]),
        np.array([sample.object.center_of_mass for sample in samples]),
        np.array([(X.x, X.y, X.yaw) for X in starts]),
        np.array((spread, spread, sensing.yaw_noise)),
    )


def batched(plan: Plan, truths: Truths, seed: int = 0) -> Outcomes:
    """Outcomes of ``plan``, a push from behind on a flat face, for ``truths``.

    The sensor noise of a sample depends only on ``seed`` and the sample's number.
    Raises PushPressSlideError for other plans.
    """
    runs = path_runs(plan, truths.noise)
    bodies, starts, place = _bodies(plan, truths)
    parts = []
    for first in range(0, len(starts), AT_ONCE):
        chosen = slice(first, first + AT_ONCE)
        rng = np.random.default_rng([seed, first])
        states = runs.initial_states(starts[chosen], place, rng)
        parts.append(runs.finish(states, bodies[chosen], rng))
    return _outcomes(plan, np.concatenate(parts), place)


def path_runs(plan: Plan, noise: Array) -> PathRuns:
    """Laws of a plan, with the controller's parameters. ``noise`` (3,) [m, m, rad] is
    that of a measured pose.

    Raises PushPressSlideError for a plan that is not one push from behind on a flat
    face.
    """
    drive, path = _pushed_car(plan)
    profile = plan.segments[0].profile
    motion = plan.task.motion
    floor = margins.FLOOR_SPEED * motion.speed
    pace = (floor, 1.5 * profile.speed, profile.acceleration, law.CATCH_UP)
    course = (
        pace,
        path.length,
        profile.cruise,
        EASING,
        margins.ARM.stop,
        margins.ARM.astray,
        motion.control_period,
        plan.task.limits.time,
    )
    laws = (_lead(plan.task, drive, noise), _touch(plan), _base(plan), course)
    pieces, bends = path.rows
    return PathRuns(
        np.array(pieces), np.array(bends).reshape(-1, 3), laws, noise, AT_ONCE
    )


def _pushed_car(plan: Plan) -> tuple[RearSteerDrive, ArcPath]:
    """Drive and path of a plan of one push from behind, on a flat face of an object
    that stands on its support.
    """
    task = plan.task
    modes = ", ".join(segment.mode for segment in plan.segments)
    if modes != MODE:
        raise _refused(f"a plan of {modes}", f"plans of one {MODE}")
    if task.legs:
        raise _refused(f"a task of {len(task.legs)} legs", "tasks without legs")
    (segment,) = plan.segments
    (contact,) = segment.contacts
    body = task.scene.body
    side = side_of(body, contact)
    if not isinstance(side, FlatSide):
        raise _refused("a push on a round side", "pushes on flat faces")
    if not task.scene.carried(task.goal) or any(task.scene.weight_along):
        raise _refused(f"a {task.support.kind} as support", "level supports")
    sensing = task.sensing
    poses = Sensing(position_noise=sensing.position_noise, yaw_noise=sensing.yaw_noise)
    if sensing != poses:
        raise _refused("sensing other than noise of poses", "noise of poses")
    if task.truth != EXACT:
        raise _refused("truth", "arms that are as believed")
    drive = segment.drive
    path = segment.path
    assert isinstance(drive, RearSteerDrive)
    assert isinstance(path, ArcPath)
    return drive, path


def _refused(value: str, allowed: str) -> PushPressSlideError:
    return PushPressSlideError(f"--batched: {value} is not allowed; allowed: {allowed}")


def _lead(task: Task, drive: RearSteerDrive, noise: Array) -> Lead:
    car = drive.car
    low, high = car.steering_limits
    reserve = margins.STEERING_RESERVE * 0.5 * (high - low)
    sensing = Sensing(position_noise=float(noise[0]), yaw_noise=float(noise[2]))
    gain = task.motion.tracking_gain
    (law,) = stanley_law(
        car.effective_wheelbase, low + reserve, high - reserve, gain, 1.0
    )
    return (
        estimator.pose_gain(sensing),
        drive.X_BV.position,
        drive.X_BV.yaw,
        law,
        figures_of_car(car, drive.max_friction),
        adaptation.STEERING_SCALE,
    )


def _touch(plan: Plan) -> Touch:
    task = plan.task
    told = task.scene
    (contact,) = plan.contacts
    body = told.body
    side = side_of(body, contact)
    assert isinstance(side, FlatSide)
    radius = task.robots[contact.arm].tip_radius
    tip, _ = contact.tip_place(radius)
    felt = task.sensing.felt_force
    damping = task.motion.servo_damping
    believed = told.contact_friction
    face = (contact.normal, side.depth, *side.ends, radius, believed, damping)
    return (
        face,
        tip,
        believed,
        felt,
        margins.KEPT_SHARE * felt,
        TIP_ACCELERATION[contact.kind],
        margins.ARM.loss_time(contact.kind) + task.motion.control_period,
    )


def _base(plan: Plan) -> tuple[float, float, float, float]:
    """Coefficients of rho^2 [m^2] as a polynomial in the tangent k of a push's angle,
    and the largest k checked without tipping.

    The polynomial is fitted to the exact surface for pushes to both sides. With this
    rho, an ellipsoid about the centre of pressure gives the same path curvature as the
    exact surface at each angle.
    """
    (contact,) = plan.contacts
    scene = plan.query.scene
    motion = plan.query.motion
    face = min(
        pushable(scene, contact.height, motion.face),
        key=lambda f: math.dist(
            (*f.foot, *f.normal), (*contact.point, *contact.normal)
        ),
    )
    tangents = np.tan(looked_at(scene, motion, face))
    vx, vy, w = np.moveaxis(push_twists(scene, motion, [face])[0], -1, 0)
    lever = math.hypot(*face.foot)
    along = -(vx * face.foot[0] + vy * face.foot[1]) / lever
    wheelbases = tangents.sum(axis=0) / np.diff(w / along, axis=0)[0]
    stands = np.isfinite(wheelbases)
    k = tangents.mean(axis=0)[stands]
    shift = contact.height * scene.support.friction
    squares = wheelbases[stands] * lever + shift * shift
    bend, slope, square = np.polyfit(k, squares, 2)
    return float(square), float(slope), float(bend), float(k[-1])


def _bodies(plan: Plan, truths: Truths) -> tuple[Array, Array, float]:
    """Truths (n, 5) for ``kernels.path_run``, start poses (n, 3) X_WB, and the tip's
    position along the face [m].
    """
    task = plan.task
    (contact,) = plan.contacts
    nx, ny = contact.normal
    px, py = contact.point
    load = truths.mass * GRAVITY
    X_GB = task.X_GB
    x, y = (truths.centers - X_GB.position).T
    columns = (
        truths.support_friction * load,
        contact.height / load,
        truths.contact_friction,
        nx * x + ny * y,
        nx * y - ny * x,
    )
    return (
        np.column_stack(columns),
        _displaced(truths.start_poses, X_GB.position),
        nx * py - ny * px,
    )


def _displaced(poses: Array, offset: tuple[float, float]) -> Array:
    """Poses (n, 3) with their origins shifted by ``offset`` [m] in their own frames."""
    x, y, yaw = poses.T
    c = np.cos(yaw)
    s = np.sin(yaw)
    dx, dy = offset
    return np.column_stack([x + c * dx - s * dy, y + s * dx + c * dy, yaw])


def _outcomes(plan: Plan, states: Array, place: float) -> Outcomes:
    task = plan.task
    dx, dy = task.X_GB.position
    poses = _displaced(states[:, :3], (-dx, -dy))
    (contact,) = plan.contacts
    nx, ny = contact.normal
    x, y, yaw = states[:, :3].T
    c = np.cos(yaw)
    s = np.sin(yaw)
    # of the tip, along the face in the world
    along = (c * nx - s * ny) * (states[:, 10] - y) - (s * nx + c * ny) * (
        states[:, 9] - x
    )
    goal = task.goal
    off = np.hypot(poses[:, 0] - goal.x, poses[:, 1] - goal.y)
    turn = poses[:, 2] - goal.yaw
    turned = np.abs(turn - 2.0 * math.pi * np.round(turn / (2.0 * math.pi)))
    ends = states[:, END].astype(np.intp)
    within = (off <= task.tolerance.position) & (turned <= task.tolerance.yaw)
    return Outcomes(
        poses,
        off,
        turned,
        states[:, OFF],
        along - place,
        states[:, TIME],
        ends,
        within & (ends == ARRIVED),
    )


def planned(task: Task) -> Plan:
    """Plan of ``task``, without arms."""
    preparation = engine_named(EngineName.planar).placement_planner(False)
    return solve(preparation, task, 1).plan


class BatchedSamples(NamedTuple):
    """Samples of a sweep, with their computing times."""

    outcomes: Outcomes
    plan: Plan
    drawing_time: float  # [s] of wall time
    running_time: float  # [s]


def batched_samples(task: Task, seed: int, count: int) -> BatchedSamples:
    """Plan ``task``, and run it for ``count`` truths.

    Raises InfeasibleTaskError if the task is infeasible, and PushPressSlideError if its
    plan is not one push from behind.
    """
    plan = planned(task)
    _pushed_car(plan)
    began = perf_counter()
    truths = drawn_truths(task, seed, count)
    drawn = perf_counter()
    outcomes = batched(plan, truths, seed)
    return BatchedSamples(outcomes, plan, drawn - began, perf_counter() - drawn)


def batched_rows(task: Task, seed: int, outcomes: Outcomes) -> Iterator[Row]:
    """Yield the row of each sample.

    ``duration`` [s] is the time of the motion alone.
    """
    for index, reached in enumerate(outcomes.reached.tolist()):
        end = int(outcomes.ends[index])
        yield {
            "index": index,
            "task": f"{task.name}-varied-{seed}-{index:03d}",
            "status": "reached" if reached else "missed",
            "code": "goal_reached" if reached else "goal_missed",
            "reason": "goal_reached" if reached else REASONS[end],
            "modes": [MODE],
            "choice": "",
            "final_position_error": float(outcomes.position_errors[index]),
            "final_yaw_error": float(outcomes.yaw_errors[index]),
            "duration": float(outcomes.times[index]),
            "off_path": float(outcomes.off_path[index]),
            "slip": float(outcomes.slips[index]),
        }
