"""Virtual axle of a pressed object over the time of a run."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Point
from pushpressslide.core.record import Record
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.report import series

LEAST_TURN_RATE = 0.02  # [rad/s] below which a measured axle is noise
LEAST_FORCE = 0.5  # [N] drag and press below which there is no prediction
WINDOW = 0.2  # [s] of the moving average
# largest relative change of the turn rate over two windows: at the start of a turn,
# inertia matters
STEADY = 0.25
SAMPLES = 60  # of the predicted curves


@dataclass(frozen=True, slots=True)
class AxleSeries:
    """Virtual axles [m] on the line from the CoM to the contact, positive towards the
    contact.

    Values are NaN without an axle. The object's axle is measured at every tick, but
    predicted only at some ticks.
    """

    measured: Array  # (N,) where the object turns fast enough, at a steady rate
    time: Array  # (M,) [s] of the predictions
    predicted: Array  # (M,) for the measured force and load, with the true friction
    without_height: Array  # (M,) the same, for drag in the plane of the support
    paper: Array  # (M,) by the paper's formula


@dataclass(frozen=True, slots=True)
class PressedMotion:
    """Motion and contact force of an object under one top press, averaged over
    ``WINDOW``. All arrays are (N,).
    """

    turn_rate: Array  # [rad/s]
    across: Array  # [m/s] of the CoM, to the left of the line to the contact
    load: Array  # [N]
    fx: Array  # [N] of the tip on the object, in B
    fy: Array


def axle_series(plan: Plan, record: Record) -> AxleSeries:
    """Virtual axles of a run with one top press."""
    contact = _contact(plan)
    ex, ey = _axis(contact)
    time = record.arrays["time"]
    width = max(1, round(WINDOW / float(time[1] - time[0])))
    motion = _pressed_motion(plan, record, width)
    move = series.in_phase(record, "move")
    steady = move & _turns_steadily(motion.turn_rate, width)
    measured = np.full(len(time), np.nan)
    measured[steady] = -motion.across[steady] / motion.turn_rate[steady]
    ticks = np.flatnonzero(move)[:: max(1, int(move.sum()) // SAMPLES)]
    axles = np.full((3, len(ticks)), np.nan)
    for i, k in enumerate(ticks):
        load = float(motion.load[k])
        fx = motion.fx[k]
        fy = motion.fy[k]
        if load < LEAST_FORCE or math.hypot(fx, fy) < LEAST_FORCE:
            continue
        press = Press(plan.task.object, plan.task.support.friction, contact.point, load)
        angle = math.atan2(ex * fy - ey * fx, ex * fx + ey * fy)
        with suppress(ValueError):  # the prediction tips
            axles[:, i] = press.axle(angle), press.axle(angle, 0.0), press.paper_axle()
    return AxleSeries(measured, time[ticks], *axles)


def _contact(plan: Plan) -> Contact:
    """The only contact, with its point relative to the true CoM."""
    (contact,) = plan.contacts
    return contact.shifted(plan.task.center_error)


def _axis(contact: Contact) -> Point:
    """Unit vector in B from the true CoM to the contact."""
    size = math.hypot(*contact.point)
    return (contact.point[0] / size, contact.point[1] / size)


def _pressed_motion(plan: Plan, record: Record, width: int) -> PressedMotion:
    """Velocity of the CoM and force of the tip in B, averaged over ``width`` ticks."""
    ex, ey = _axis(_contact(plan))
    yaw = record.arrays["object_pose"][:, 2]
    twist = record.arrays["object_twist"]
    c = np.cos(yaw)
    s = np.sin(yaw)
    w = twist[:, 2]
    x, y = plan.task.object.center_of_mass
    vx = c * twist[:, 0] + s * twist[:, 1] - w * y
    vy = -s * twist[:, 0] + c * twist[:, 1] + w * x
    normals, tangents = series.contact_forces(plan, record)
    values = (w, ex * vy - ey * vx, normals[:, 0], *tangents[:, 0].T)
    return PressedMotion(*(_smooth(v, width) for v in values))


def _turns_steadily(turn_rate: Array, width: int) -> series.Mask:
    """Mask (N,) of the ticks in which the turn rate is high enough and changes little
    over two windows.
    """
    padded = np.pad(turn_rate, width, mode="edge")
    nearby = sliding_window_view(padded, 2 * width + 1)
    change = nearby.max(1) - nearby.min(1)
    rate = np.abs(turn_rate)
    steady: series.Mask = (rate > LEAST_TURN_RATE) & (change < STEADY * rate)
    return steady


def _smooth(values: Array, width: int) -> Array:
    """Moving average over ``width`` ticks, with the first and last values repeated
    beyond the ends.
    """
    padded = np.pad(values, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
