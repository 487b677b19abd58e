"""Rho as identified during a run, beside the exact model's for the same motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.record import Record
from pushpressslide.identification.online import AxleState
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.modes import MODES
from pushpressslide.modes.press_slide import PressSlide
from pushpressslide.report import series

Array = NDArray[np.float64]

ANGLE = math.radians(60.0)
WITHIN = math.radians(10.0)  # of the force from the heading axis
LEAST_TURN_RATE = 0.05  # [rad/s]
LEAST_TIME = 3.0  # [s]
WINDOW = 0.2  # [s] over which force and turn rate are averaged


@dataclass(frozen=True, slots=True)
class IdentifiedRho:
    """The longest stretch of a run with steep steering and fast turning, and rho there."""

    time: float  # [s] that it lasted
    force_angle: float  # [rad] mean
    predicted: float  # [m] rho that the motion was planned with
    identified: float  # [m] rho at its end
    exact: float  # [m] rho of the exact surface for this force angle, load and height
    axle: float  # [m] identified virtual axle, from the CoM on the line to the contact
    exact_axle: float  # [m]


def identified_rho(plan: Plan, record: Record) -> IdentifiedRho | None:
    """Run the identifier over the longest exciting stretch of a pressed object's run.

    The stretch has force angles within 10 degrees of 60 and turn rates above 0.05 rad/s
    for 3 s; None where there is none, or nothing contradicted the plan. As in
    ``Controller``, the identifier sees measured poses and contact forces alone, from
    the beginning of the stretch. The exact model has the true mass and friction, the
    mean load and the mean force angle.
    """
    mode = MODES[plan.choice.mode]
    (contact,) = plan.choice.contacts
    assert isinstance(mode, PressSlide)
    time = record.arrays["time"]
    normals, tangents = series.contact_forces(plan, record)
    angle, turn_rate = _excitation(contact.point, tangents[:, 0], record)
    exciting = series.in_phase(record, "move") & (np.abs(angle - ANGLE) < WITHIN)
    first, stop = _longest(exciting & (np.abs(turn_rate) > LEAST_TURN_RATE))
    if stop == first or time[stop - 1] - time[first] < LEAST_TIME:
        return None
    identifier = mode.identifier(plan)
    state = AxleState()
    for k in range(first, stop):
        pose = Pose2(*map(float, record.arrays["object_pose"][k]))
        X_WB = pose.compose(plan.task.object.X_GB)
        fx, fy = map(float, tangents[k, 0])
        state = identifier.step(state, float(time[k]), X_WB, (fx, fy))
    identified = identifier.identified(state)
    if identified is None:
        return None
    task = plan.task
    load = float(np.mean(normals[first:stop, 0]))
    mean = float(np.mean(angle[first:stop]))
    press = Press(task.object, task.support.friction, contact.point, load)
    ahead, reach = press.steered(mean, backward=False)
    return IdentifiedRho(
        time=float(time[stop - 1] - time[first]),
        force_angle=mean,
        predicted=plan.choice.parameters["rho"],
        identified=math.sqrt(identified.reach * press.lever),
        exact=math.sqrt(reach * press.lever),
        axle=identified.axle,
        exact_axle=math.hypot(*press.cop) + ahead,
    )


def _excitation(contact: Point, force: Array, record: Record) -> tuple[Array, Array]:
    """Return the force angle (N,) [rad] and turn rate (N,) [rad/s], averaged.

    The angle of ``force`` (N, 2) [N] is from the line to ``contact`` [m], in B, and
    has no sign.
    """
    time = record.arrays["time"]
    size = math.hypot(*contact)
    ex = contact[0] / size
    ey = contact[1] / size
    fx, fy = force.T
    width = max(1, round(WINDOW / float(time[1] - time[0])))
    window = np.full(width, 1.0 / width)
    along, across, turn_rate = (
        np.convolve(values, window, mode="same")
        for values in (
            ex * fx + ey * fy,
            ex * fy - ey * fx,
            record.arrays["object_twist"][:, 2],
        )
    )
    return np.abs(np.arctan2(across, along)), turn_rate


def _longest(mask: NDArray[np.bool_]) -> tuple[int, int]:
    """Return first index and end of the longest run of True; (0, 0) for none."""
    edges = np.flatnonzero(
        np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8))
    )
    runs = list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
    return max(runs, key=lambda run: run[1] - run[0], default=(0, 0))
