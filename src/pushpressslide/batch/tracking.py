"""Tracking laws on arrays: one closed-form step each, from errors to what is asked of
the object.

Source: docs/mechanics.md, sections 3, 4.2 and 9; ``tracking.rear_stanley``,
``tracking.rear_car``, ``tracking.lookahead_alignment`` and ``tracking.holonomic`` for
one. The nearest point of a path is no closed form and is left to the caller. Errors are
REFERENCE MINUS ACTUAL.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.angles import arctan2, cos, sin
from pushpressslide.batch.checks import check_last, check_positive
from pushpressslide.batch.elementwise import (
    columns_of,
    figures,
    leading_shape,
    table,
    values,
)
from pushpressslide.batch.wrench_twist import TwistColumns
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, Columns, Formula, where

Flags = NDArray[np.bool_]


class PathErrors(NamedTuple):
    """Where a vehicle is beside its path."""

    left: Column  # [m] of the path from the vehicle
    heading: Column  # [rad] of the path from the vehicle's
    curvature: Column  # [1/m] of the path there


class Stanley(NamedTuple):
    """The rear Stanley law of one car."""

    wheelbase: Column  # [m] effective: rho^2 / d
    low: Column  # [rad] bounds of the steering angle
    high: Column
    gain: Column  # of the lateral error; 1: the largest without overshoot
    feed_forward: Column  # share of the path's curvature that is steered ahead
    grip: Column  # share of the bounds


def rear_stanley(
    left: ArrayLike,
    heading: ArrayLike,
    curvature: ArrayLike,
    *,
    wheelbase: ArrayLike,
    steering_bounds: ArrayLike,
    gain: ArrayLike = 1.0,
    feed_forward: bool = True,
    grip: ArrayLike = 1.0,
) -> tuple[Array, Flags]:
    """Return steering angles (...) [rad], and where they had to be clipped.

    Errors ``left`` [m] and ``heading`` [rad], ``curvature`` [1/m] of the path there,
    effective ``wheelbase`` [m], ``steering_bounds`` (..., 2) [rad], ``gain`` and
    ``grip``, all of any shape. As ``tracking.rear_stanley``; an error that is no number
    gives none.
    """
    bounds, ahead, length = figures(steering_bounds, float(feed_forward), wheelbase)
    check_last(bounds, (2,), "steering_bounds")
    check_positive(length, "wheelbase", "m")
    errors = PathErrors(*figures(left, heading, curvature))
    rate, share = figures(gain, grip)
    law = Stanley(length, bounds[..., 0], bounds[..., 1], rate, ahead, share)
    delta, clipped = _stepped(steered, errors, law)
    return delta, clipped > 0.0


def steered(error: PathErrors, law: Stanley) -> Columns:
    """Return the steering angle, and 1 where it was clipped."""
    slope = law.gain / (4.0 * law.wheelbase)
    ahead = arctan2(law.feed_forward * law.wheelbase * error.curvature, 1.0)
    delta = -error.heading - arctan2(slope * error.left, 1.0) - ahead
    low = law.grip * law.low
    high = law.grip * law.high
    kept = (low <= delta) & (delta <= high)
    beyond = where(delta < 0.0, low, high)
    return where(kept | np.isnan(delta), delta, beyond), where(kept, 0, 1)


class LookAhead(NamedTuple):
    """Look-ahead alignment of one vehicle."""

    look_ahead: Column  # [m]
    limit: Column  # [1/m] largest curvature asked for
    grip: Column  # share of the limit


def lookahead_curvature(
    left: ArrayLike,
    heading: ArrayLike,
    curvature: ArrayLike,
    *,
    look_ahead: ArrayLike,
    limit: ArrayLike,
    grip: ArrayLike = 1.0,
) -> tuple[Array, Flags]:
    """Return the curvatures (...) [1/m] to drive, and where they had to be clipped.

    Errors ``left`` [m] and ``heading`` [rad], ``curvature`` [1/m] of the path there,
    ``look_ahead`` [m], ``limit`` [1/m] and ``grip``, all of any shape. As
    ``tracking.lookahead_alignment`` with a target that slides along the path.
    """
    length, most, share = figures(look_ahead, limit, grip)
    check_positive(length, "look_ahead", "m")
    errors = PathErrors(*figures(left, heading, curvature))
    turn, clipped = _stepped(aligned, errors, LookAhead(length, most, share))
    return turn, clipped > 0.0


def aligned(error: PathErrors, law: LookAhead) -> Columns:
    """Return the curvature to drive, and 1 where it was clipped."""
    ell = law.look_ahead
    lateral = error.left * cos(error.heading) + ell * sin(error.heading)
    turn = error.curvature + 4.0 * lateral / (ell * ell)
    limit = law.grip * law.limit
    clipped = where(turn > limit, limit, where(turn < -limit, -limit, turn))
    return clipped, where(np.abs(turn) > limit, 1, 0)


class Car(NamedTuple):
    """A rear-steer car and how it is driven; in B."""

    ex: Column  # heading axis, from the contact to the centre of pressure
    ey: Column
    lever: Column  # [m] from the contact to the centre of pressure
    rho: Column  # [m]
    max_force: Column  # [N] mu_s N
    speed: Column  # [m/s] of the axle


class Steering(NamedTuple):
    """A steering angle [rad]."""

    delta: Column


def rear_push(
    steering: ArrayLike,
    speed: ArrayLike,
    *,
    axis: ArrayLike,
    lever: ArrayLike,
    rho: ArrayLike,
    max_force: ArrayLike,
) -> tuple[Array, Array]:
    """Return the wrenches (..., 3) [N, N m] about the centre of pressure and the twists
    (..., 3) of the virtual axle, in B, of a push that steers with ``steering`` [rad].

    ``axis`` (..., 2) is the unit vector from contact to centre of pressure, ``lever``
    [m] their distance, ``rho`` [m], ``max_force`` [N], ``speed`` [m/s] of the axle; all
    of any shape. As ``tracking.rear_car.RearPushTracker``.
    """
    e, d, length, force, v = figures(axis, lever, rho, max_force, speed)
    check_last(e, (2,), "axis")
    check_positive(d, "lever", "m")
    check_positive(length, "rho", "m")
    check_positive(force, "max_force", "N")
    car = Car(e[..., 0], e[..., 1], d, length, force, v)
    (delta,) = figures(steering)
    shape = np.broadcast_shapes(delta.shape, leading_shape(car))
    arguments = (
        table(Steering, delta[..., None], shape),
        columns_of(car, shape),
    )
    wrench, twist = values(car_push, arguments, shape, (3, 3))
    return wrench, twist


def car_push(steering: Steering, car: Car) -> Columns:
    """Return wrench and twist of a steering angle."""
    k = sin(steering.delta) / cos(steering.delta)
    ratio = car.lever / car.rho
    # |f| = mu_s N / sqrt(1 + (D sin(delta) / rho)^2); along e, and to its left
    along = car.max_force / np.sqrt(1.0 + (1.0 + ratio * ratio) * k * k)
    side = along * k
    w = -car.lever / (car.rho * car.rho) * car.speed * k
    return (
        along * car.ex - side * car.ey,
        along * car.ey + side * car.ex,
        -car.lever * side,
        car.speed * car.ex,
        car.speed * car.ey,
        w,
    )


class PoseErrors(NamedTuple):
    """Where a body is beside the pose that it should have, in its own frame V."""

    x: Column  # [m]
    y: Column
    yaw: Column  # [rad] wrapped


class Pull(NamedTuple):
    """The holonomic law of one body."""

    speed: Column  # [m/s] in the path's metric
    decay: Column  # [m] over which an error falls to 1/e
    radius: Column  # [m] of the path's metric
    most: Column  # [m] of error that is pulled at in proportion


def holonomic(
    errors: ArrayLike,
    rates: ArrayLike,
    *,
    speed: ArrayLike,
    decay: ArrayLike,
    radius: ArrayLike,
    share: ArrayLike = 0.5,
    grip: ArrayLike = 1.0,
) -> tuple[Array, Flags]:
    """Return the twists (..., 3) of V's origin, in V, that lead bodies along their
    paths, and where the pull was limited.

    ``errors`` (..., 3): x, y [m] of the wanted pose in V and yaw [rad]; ``rates``
    (..., 3): the path's twist there per metre of its metric, in the wanted pose's axes;
    ``speed`` [m/s], ``decay`` [m], ``radius`` [m] of the metric, ``share`` and ``grip``
    of the pull, all of any shape. As ``tracking.holonomic``.
    """
    rows, path, v, way, length, part, hold = figures(
        errors, rates, speed, decay, radius, share, grip
    )
    check_last(rows, (3,), "errors")
    check_last(path, (3,), "rates")
    check_positive(way, "decay", "m")
    law = Pull(v, way, length, hold * part * way)
    shape = np.broadcast_shapes(rows.shape[:-1], path.shape[:-1], leading_shape(law))
    arguments = (
        table(PoseErrors, rows, shape),
        table(TwistColumns, path, shape),
        columns_of(law, shape),
    )
    twist, limited = values(pulled, arguments, shape, (3, 0))
    return twist, limited > 0.0


def pulled(error: PoseErrors, rate: TwistColumns, law: Pull) -> Columns:
    """Return the twist, and 1 where the pull was limited."""
    c = cos(error.yaw)
    s = sin(error.yaw)
    turned = law.radius * error.yaw
    off = np.sqrt(error.x * error.x + error.y * error.y + turned * turned)
    limited = off > law.most
    pull = law.speed / law.decay
    pull = where(limited, pull * (law.most / off), pull)
    return (
        law.speed * (c * rate.vx - s * rate.vy) + pull * error.x,
        law.speed * (s * rate.vx + c * rate.vy) + pull * error.y,
        law.speed * rate.w + pull * error.yaw,
        where(limited, 1, 0),
    )


def _stepped(
    formula: Formula, errors: PathErrors, law: Stanley | LookAhead
) -> list[Array]:
    """Return what a law of path errors gives, and its flag."""
    shape = np.broadcast_shapes(leading_shape(errors), leading_shape(law))
    arguments = (columns_of(errors, shape), columns_of(law, shape))
    return values(formula, arguments, shape, (0, 0))
