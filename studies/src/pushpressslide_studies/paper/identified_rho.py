"""Rho identified during a run, compared with the exact model for the same motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.identification.online import (
    AxleEstimate,
    AxleIdentifier,
    AxleState,
)
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.modes import MODES
from pushpressslide.modes.press_slide import PressSlide
from pushpressslide.report import series

ANGLE = math.radians(60.0)
WITHIN = math.radians(10.0)  # of the force from the heading axis
LEAST_TURN_RATE = 0.05  # [rad/s]
LEAST_TIME = 3.0  # [s]
WINDOW = 0.2  # [s] over which force and turn rate are averaged


@dataclass(frozen=True, slots=True)
class IdentifiedRho:
    """Rho identified in a run, over the longest part with a large force angle and fast
    turning.
    """

    time: float  # [s] that it lasted
    force_angle: float  # [rad] mean
    predicted: float  # [m] rho that the motion was planned with
    identified: float  # [m] rho at its end
    exact: float  # [m] rho of the exact surface for this force angle, load and height
    axle: float  # [m] identified virtual axle, from the CoM on the line to the contact
    exact_axle: float  # [m]


def identified_rho(plan: Plan, record: Record) -> IdentifiedRho | None:
    """Rho identified over the longest part of a pressed object's run with enough
    excitation.

    In this part, which lasts 3 s or more, the force angle is within 10 degrees of 60
    degrees and the turn rate is above 0.05 rad/s. None if there is no such part, or if
    nothing contradicted the plan.

    As in ``Controller``, the identifier uses only measured poses and the contact force.
    It starts at the beginning of the part. The exact model has the true mass and
    friction, the mean load and the mean force angle.
    """
    segment = plan.segments[0]
    mode = MODES[segment.mode]
    (contact,) = plan.contacts
    assert isinstance(mode, PressSlide)
    time = record.arrays["time"]
    normals, tangents = series.contact_forces(plan, record)
    forces = tangents[:, 0]
    angle, turn_rate = _steering(contact, record, forces)
    exciting = series.in_phase(record, "move") & (np.abs(angle - ANGLE) < WITHIN)
    first, stop = _longest(exciting & (np.abs(turn_rate) > LEAST_TURN_RATE))
    if stop == first or time[stop - 1] - time[first] < LEAST_TIME:
        return None
    task = plan.task
    identifier = mode.identifier(plan.query, segment)
    identified = _identified(identifier, task, record, forces, range(first, stop))
    if identified is None:
        return None
    load = float(np.mean(normals[first:stop, 0]))
    mean = float(np.mean(angle[first:stop]))
    press = Press(task.object, task.support.friction, contact.point, load)
    ahead, reach = press.steered(mean, backward=False)
    return IdentifiedRho(
        time=float(time[stop - 1] - time[first]),
        force_angle=mean,
        predicted=segment.drive.rho or math.nan,
        identified=math.sqrt(identified.effective_wheelbase * press.lever),
        exact=math.sqrt(reach * press.lever),
        axle=identified.axle,
        exact_axle=math.hypot(*press.cop) + ahead,
    )


def _identified(
    identifier: AxleIdentifier, task: Task, record: Record, forces: Array, ticks: range
) -> AxleEstimate | None:
    """Estimates after a number of ticks. ``forces`` (N, 2) [N] are as in ``_steering``."""
    state = AxleState()
    for k in ticks:
        X_WG = Pose2(*map(float, record.arrays["object_pose"][k]))
        X_WB = X_WG.compose(task.object.X_GB)
        time = float(record.arrays["time"][k])
        fx, fy = map(float, forces[k])
        state = identifier.step(state, time, X_WB, (fx, fy))
    return identifier.identified(state)


def _steering(contact: Contact, record: Record, forces: Array) -> tuple[Array, Array]:
    """Averaged force angle [rad], >= 0, and turn rate [rad/s] at every tick.

    ``forces`` (N, 2) [N] are in the plane, in B.
    """
    time = record.arrays["time"]
    size = math.hypot(*contact.point)
    ex = contact.point[0] / size
    ey = contact.point[1] / size
    fx, fy = forces.T
    turn_rate = record.arrays["object_twist"][:, 2]
    width = max(1, round(WINDOW / float(time[1] - time[0])))
    along, across, turn_rate = (
        np.convolve(values, np.full(width, 1.0 / width), mode="same")
        for values in (ex * fx + ey * fy, ex * fy - ey * fx, turn_rate)
    )
    return np.abs(np.arctan2(across, along)), turn_rate


def _longest(mask: NDArray[np.bool_]) -> tuple[int, int]:
    """First index of the longest run of True, and the index after its last element.

    (0, 0) if there is no True.
    """
    edges = np.flatnonzero(
        np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8))
    )
    runs = list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
    return max(runs, key=lambda run: run[1] - run[0], default=(0, 0))
