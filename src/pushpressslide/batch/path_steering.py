"""The rear Stanley law and its push as columns, for ``path_runs``; ``kernels.tracking``
for one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pushpressslide.batch.angles import arctan2, cos, sin
from pushpressslide.core.formulas import Column, Columns, where


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
