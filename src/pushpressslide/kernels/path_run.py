"""One planned push from behind, tick by tick: pose filter, rear Stanley law, velocity
servo, and a compliant tip that pushes a body on the ellipsoid.

It does the same as the run loop in the phase ``move`` of a rear push on the planar
engine, except that an ellipsoid about the true centre of pressure replaces the exact
limit surface. Approach, touch, release, replans, online identification and retouches
are omitted. The origin of frame B is the believed centre of mass. The axis n is the
face's inward normal, and t is to its left.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.arc_path import nearest, trapezoid, wrapped
from pushpressslide.kernels.compliant_tip import side_touch
from pushpressslide.kernels.kernel import kernel, kernel_apart
from pushpressslide.kernels.leading import (
    Pace,
    SteeringScale,
    approached,
    corrected,
    eased_steering_scale,
    paced,
)
from pushpressslide.kernels.plane import Pose, carried, from_axis, heading, in_axis
from pushpressslide.kernels.sliding import Triple
from pushpressslide.kernels.supports import on_ellipsoid
from pushpressslide.kernels.tip_step import Face, one_tip_step
from pushpressslide.kernels.tracking import Car, Stanley, stanley_steering, steered_push

UNDER_WAY = 0.0
ARRIVED = 1.0
LEFT_FACE = 2.0
ASTRAY = 3.0
"""Status of a run: off the path. The other values are above."""
THINNEST = 1e-12  # [m^2] of an ellipsoid's rho^2

Clock = tuple[float, float, float, float, float, float]
"""Progress of a run.

The members are the progress along the path [m]; the fraction of the steering that may
be used; the time [s] for which no contact force has been felt; the largest distance [m]
of the axle from the path so far; the time [s] since the motion began; and the status of
the run.
"""
State = tuple[Pose, Pose, Triple, Vector, Vector, Triple, Vector, Clock]
"""State of a run.

The members are the true and the believed X_WB; the expected twist of B's origin, in B;
the position [m] and the reference velocity [m/s] of the tip, in the world; the true
twist of B's origin; the tip's force [N] on the body along n and t; and the clock.
"""
Truth = tuple[float, float, float, Vector]
"""True parameters of a body.

The members are mu_s N [N]; the height of the contact divided by the load [m/N]; the
friction of the pair tip/body; and the offset [m] of the true centre of mass from the
believed one, along n and t.
"""
Lead = tuple[float, Vector, float, Stanley, Car, SteeringScale]
"""Parameters that lead the object.

The members are the share of the prediction's error that a measured pose corrects; the
virtual front axle [m] in B; the direction [rad] of the car's heading axis in B; the
steering law; the car's parameters; and those of the steering scale.
"""
Touch = tuple[Face, Vector, float, float, float, float, float]
"""Parameters of the contact.

The members are the face with its tip; the planned centre [m] of the tip; the believed
friction; the force [N] above which contact is felt, and the force [N] below which it is
lost; the largest acceleration [m/s^2] of the tip's reference; and the longest allowed
loss of contact [s].
"""
Base = tuple[float, float, float, float]
"""Coefficients of rho^2 [m^2] for the ellipsoid about the centre of pressure.

The ellipsoid matches the exact surface for a force whose angle to the line through the
centre of mass has the tangent k. The square of the distance between the two centres is
subtracted. The members are the value at k = 0, the coefficients of |k| and of k^2, and
the |k| above which the value is constant.
"""
Course = tuple[Pace, float, float, float, float, float, float, float]
"""Parameters of the path and the run.

The members are the bounds of the speed; the length [m] of the path; the cruising speed
[m/s] of its profile; the time [s] over which bends are averaged; the remaining path [m]
at which the motion ends; the distance off the path [m] at which it is abandoned; the
tick [s]; and the time limit [s] of the run.
"""
Laws = tuple[Lead, Touch, Base, Course]
Rows = Sequence[Sequence[float]]
Guide = tuple[float, float, Vector, Triple]
"""Guidance of a tick: progress [m], offset to the left [m], and force [N] and twist of
B's origin, in B.
"""


@kernel
def path_run(
    state: State,
    truth: Truth,
    number: float,
    laws: Laws,
    sections: Rows,
    bends: Rows,
    noise: Rows,
) -> State:
    """State after some ticks, or at the end of the run.

    Row ``number`` of ``noise`` contains the errors [m, m, rad] of each tick's measured
    pose.
    """
    course = laws[3]
    dt = course[6]
    errors = noise[int(number)]
    for tick in range(len(errors) // 3):
        clock = state[7]
        if clock[5] != UNDER_WAY or clock[4] > course[7] - 0.5 * dt:
            break
        error = (errors[3 * tick], errors[3 * tick + 1], errors[3 * tick + 2])
        state = ticked(state, truth, error, laws, sections, bends)
    return state


@kernel_apart
def ticked(
    state: State, truth: Truth, error: Pose, laws: Laws, sections: Rows, bends: Rows
) -> State:
    """State after one tick."""
    pose, believed, expected, tip, velocity, twist, force, clock = state
    lead, touch, base, course = laws
    dt = course[6]
    measured = (pose[0] + error[0], pose[1] + error[1], pose[2] + error[2])
    seen = corrected(carried(believed, expected, dt), measured, lead[0])
    axis = heading(seen[2])
    guide = guided(seen, axis, clock, lead, course, sections, bends)
    progress, left, wanted, expected = guide
    vx, vy, w = expected
    px, py = touch[1]
    at_tip = from_axis(axis, (vx - w * py, vy + w * px))
    velocity = approached(velocity, at_tip, touch[5] * dt)
    used = abs(force[1]) / (touch[2] * max(force[0], touch[3]))
    steering_scale = eased_steering_scale(clock[1], used, dt, lead[5])
    led = (tip, velocity, from_axis(axis, wanted))
    pose, tip, twist, force = pushed_body(
        (pose, twist, force), led, truth, touch, base, dt
    )
    apart = clock[2] + dt if force[0] < touch[4] else 0.0
    end = ending(progress, left, apart > touch[6], course)
    after = (
        progress,
        steering_scale,
        apart,
        max(abs(left), clock[3]),
        clock[4] + dt,
        end,
    )
    return pose, seen, expected, tip, velocity, twist, force, after


@kernel
def ending(progress: float, left: float, parted: bool, path_data: Course) -> float:
    """Status of a run, from its progress and its contact."""
    if abs(left) > path_data[5]:
        return ASTRAY
    if parted:
        return LEFT_FACE
    return ARRIVED if path_data[1] - progress <= path_data[4] else UNDER_WAY


@kernel
def guided(
    measured: Pose,
    axis: Vector,
    clock: Clock,
    lead: Lead,
    path_data: Course,
    sections: Rows,
    bends: Rows,
) -> Guide:
    """Guidance by the rear Stanley law at the present speed."""
    pace, length, cruise, easing, _, _, dt, _ = path_data
    _, axle, bearing, law, car, _ = lead
    progress, steering_scale, _, _, time, _ = clock
    planned = trapezoid(time + dt, length, cruise, pace[2])
    speed = paced(planned, progress, length - progress, pace[0], pace)
    dx, dy = from_axis(axis, axle)
    progress, left, yaw, curvature = nearest(
        measured[0] + dx, measured[1] + dy, progress, easing * speed, sections, bends
    )
    turn = wrapped(yaw - (measured[2] + bearing))
    delta, _ = stanley_steering(left, turn, curvature, steering_scale, law)
    wrench, (vx, vy, w) = steered_push(delta, speed, car)
    twist = (vx + w * axle[1], vy - w * axle[0], w)
    return progress, left, (wrench[0], wrench[1]), twist


@kernel
def pushed_body(
    body: tuple[Pose, Triple, Vector],
    led: tuple[Vector, Vector, Vector],
    truth: Truth,
    touch: Touch,
    base: Base,
    dt: float,
) -> tuple[Pose, Vector, Triple, Vector]:
    """Pose, tip, twist and force after a tick under the given tip command."""
    pose, (vx, vy, w), force = body
    limit, lift, friction, center = truth
    normal, depth, right, left, radius, _, damping = touch[0]
    axis = heading(pose[2])
    _, place = in_axis(
        normal, in_axis(axis, (led[0][0] - pose[0], led[0][1] - pose[1]))
    )
    lever = (center[0] - depth, center[1] - place)
    rho = sqrt(max(square_of_base(lever, lift, force, base), THINNEST))
    cop = (center[0] + lift * force[0], center[1] + lift * force[1])
    x, y = from_axis(normal, cop)
    face = (normal, depth, right, left, radius, friction, damping)
    pose, twist, (tip, felt, _) = one_tip_step(
        pose,
        (vx - w * y, vy + w * x, w),
        led,
        face,
        ((x, y), limit, rho, dt),
        rho,
        (on_ellipsoid, side_touch),
    )
    vx, vy, w = twist
    force = in_axis(normal, in_axis(axis, felt))
    return pose, tip, (vx + w * y, vy - w * x, w), force


@kernel
def square_of_base(lever: Vector, lift: float, force: Vector, base: Base) -> float:
    """Square of rho [m^2] about the centre of pressure, under the force of the last
    tick.

    ``lever`` [m] is from the contact to the centre of mass.
    """
    square, slope, bend, steepest = base
    fn, ft = force
    along = lever[0] * fn + lever[1] * ft
    k = 0.0
    if along > 0.0:
        k = min(abs(lever[0] * ft - lever[1] * fn) / along, steepest)
    return square + (slope + bend * k) * k - lift * lift * (fn * fn + ft * ft)
