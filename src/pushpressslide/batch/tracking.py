"""Tracking laws on arrays: one closed-form step each, from errors to the demanded
motion of the object.

Source: docs/mechanics.md, sections 3, 4.2 and 9; ``tracking.rear_stanley``,
``tracking.rear_car``, ``tracking.lookahead_alignment`` and ``tracking.holonomic`` do
the same for one object. The nearest point of a path has no closed form and is left to
the caller. Errors are REFERENCE MINUS ACTUAL.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.checks import check_last, check_positive
from pushpressslide.batch.rows import (
    answers,
    columns_of,
    figures,
    figures_of,
    grouped,
    halves,
    prepared,
    spread,
    stacked_arguments,
)
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.tracking import (
    look_ahead_curvature,
    pulled_twist,
    stanley_law,
    stanley_steering,
    steered_push,
)

Flags = NDArray[np.bool_]


def rear_stanley(
    left: ArrayLike,
    heading: ArrayLike,
    curvature: ArrayLike,
    *,
    wheelbase: ArrayLike,
    steering_bounds: ArrayLike,
    gain: ArrayLike = 1.0,
    feed_forward: bool = True,
    steering_scale: ArrayLike = 1.0,
) -> tuple[Array, Flags]:
    """Steering angles (...) [rad], and a mask of the clipped ones.

    All parameters may have any shape: the errors ``left`` [m] and ``heading`` [rad],
    the path's ``curvature`` [1/m] at its nearest point, the effective ``wheelbase``
    [m], ``steering_bounds`` (..., 2) [rad], ``gain`` and ``steering_scale``. The law is
    ``tracking.rear_stanley``. An error of NaN gives NaN.
    """
    bounds, ahead, length = figures(steering_bounds, float(feed_forward), wheelbase)
    check_last(bounds, (2,), "steering_bounds")
    check_positive(length, "wheelbase", "m")
    side, turned, bend, rate, share = figures(
        left, heading, curvature, gain, steering_scale
    )
    law = prepared(stanley_law, length, *halves(bounds), rate, ahead)
    row = columns_of(side, turned, bend)
    law = stacked_arguments(figures_of(share), law)
    out = answers(stanley_steering, row, law, columns=2)
    delta = out[..., 0]
    none = np.isnan(side) | np.isnan(turned) | np.isnan(bend)
    return np.where(none, math.nan, delta), out[..., 1] > 0.0


def lookahead_curvature(
    left: ArrayLike,
    heading: ArrayLike,
    curvature: ArrayLike,
    *,
    look_ahead: ArrayLike,
    limit: ArrayLike,
    steering_scale: ArrayLike = 1.0,
) -> tuple[Array, Flags]:
    """Curvatures (...) [1/m] to drive, and a mask of the clipped ones.

    All parameters may have any shape: the errors ``left`` [m] and ``heading`` [rad],
    the path's ``curvature`` [1/m] at its nearest point, ``look_ahead`` [m], ``limit``
    [1/m] and ``steering_scale``. The law is ``tracking.lookahead_alignment`` with a
    target that slides along the path.
    """
    length, most, share = figures(look_ahead, limit, steering_scale)
    check_positive(length, "look_ahead", "m")
    side, turned, bend = figures(left, heading, curvature)
    turned = _angles(turned)
    row = columns_of(side, turned, bend)
    law = figures_of(length, share * most)
    out = answers(look_ahead_curvature, row, law, columns=2)
    return out[..., 0], out[..., 1] > 0.0


def rear_push(
    steering: ArrayLike,
    speed: ArrayLike,
    *,
    axis: ArrayLike,
    lever: ArrayLike,
    rho: ArrayLike,
    max_force: ArrayLike,
) -> tuple[Array, Array]:
    """Wrenches (..., 3) [N, N m] and twists (..., 3) of a push that steers with
    ``steering`` [rad].

    Wrenches are about the centre of pressure, twists those of the virtual axle, both in
    B. ``axis`` (..., 2) is the unit vector from contact to centre of pressure,
    ``lever`` [m] their distance, and ``speed`` [m/s] that of the axle. These, ``rho``
    [m] and ``max_force`` [N] may have any shape. The law is
    ``tracking.rear_car.RearPushTracker``.
    """
    e, d, length, force, v = figures(axis, lever, rho, max_force, speed)
    check_last(e, (2,), "axis")
    check_positive(d, "lever", "m")
    check_positive(length, "rho", "m")
    check_positive(force, "max_force", "N")
    (delta,) = figures(steering)
    delta = _angles(delta)
    ex, ey = halves(e)
    ratio = d / length
    car = (ex, ey, force, 1.0 + ratio * ratio, -d, -d / (length * length))
    row = columns_of(delta)
    out = answers(steered_push, row, figures_of(v, car), columns=6)
    return out[..., :3], out[..., 3:]


def holonomic(
    errors: ArrayLike,
    rates: ArrayLike,
    *,
    speed: ArrayLike,
    decay: ArrayLike,
    radius: ArrayLike,
    share: ArrayLike = 0.5,
    steering_scale: ArrayLike = 1.0,
) -> tuple[Array, Flags]:
    """Twists (..., 3) of V's origin, in V, that lead bodies along their paths, and a
    mask of the bodies whose pull towards the path is limited.

    ``errors`` (..., 3) are x, y [m] of the target pose in V and its yaw [rad].
    ``rates`` (..., 3) are the path's twist at the target pose per metre of the path's
    metric, in that pose's axes. ``speed`` [m/s], ``decay`` [m], ``radius`` [m] of the
    metric, ``share`` and ``steering_scale`` of the pull have any shape. The law is
    ``tracking.holonomic``.
    """
    rows, path, v, route, length, part, hold = figures(
        errors, rates, speed, decay, radius, share, steering_scale
    )
    check_last(rows, (3,), "errors")
    check_last(path, (3,), "rates")
    check_positive(route, "decay", "m")
    yaw = rows[..., 2]
    if _angles(yaw) is not yaw:
        rows = np.stack([rows[..., 0], rows[..., 1], _angles(yaw)], axis=-1)
    law = figures_of((v, route, length, hold * part * route))
    row = (spread(rows), grouped(path))
    out = answers(pulled_twist, row, law, columns=6)
    return out[..., :3], out[..., 5] > 0.0


def _angles(angles: Array) -> Array:
    """Angles [rad], with NaN in place of infinite ones, which have no sine."""
    finite = np.isfinite(angles)
    return angles if finite.all() else np.where(finite, angles, math.nan)
