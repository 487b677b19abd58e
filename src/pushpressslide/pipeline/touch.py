"""Phase touch: line the tips up with their contacts, advance until they feel the object, settle the normal
force.
"""

from __future__ import annotations

import math
from dataclasses import replace

from pushpressslide.core.control import Measurement, TipCommand, TipState, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState
from pushpressslide.pipeline.control_state import (
    FREE_DAMPING,
    FREE_STIFFNESS,
    SERVO_CAP,
    ControllerState,
    ramp_time,
    smooth,
)

TOUCH_SPEED = 0.03  # [m/s] on the last centimetres
TOUCH_DEPTH = 0.05  # [m] beyond the expected contact at which the object counts as not there
FELT_TIME = 0.03  # [s] of normal force before a touch is believed
SETTLE_TIME = 0.2  # [s] that the touch force must hold


def touch(
    state: ControllerState,
    measurement: Measurement,
    X_WB: Pose2,
    contacts: tuple[Contact, ...],
    regulator: NormalForceRegulator,
    touch_force: float,
    threshold: float,
    gap: float,
    joint_progress: float,
) -> tuple[tuple[TipCommand, ...], ControllerState, bool]:
    """Return the commands, the next state, and whether the touch is complete.

    ``touch_force`` [N] is pressed before the motion begins, ``threshold`` [N] counts as contact, ``gap`` [m]
    is the free way before the face.
    """
    dt = measurement.time - state.last_time
    elapsed = measurement.time - state.since
    inside, tip, start, contact = (
        state.binding.tip_points[0],
        measurement.tips[0],
        state.tip_start[0],
        contacts[0],
    )
    n = X_WB.rotate(contact.normal)
    before = X_WB.apply((inside[0] - gap * contact.normal[0], inside[1] - gap * contact.normal[1]))
    align_time = ramp_time(math.dist((*before, contact.height), start)) + 0.1 if state.align else 0.0
    planned = (
        state.binding.plan.object_pose(state.progress).yaw if state.align else measurement.object_pose.yaw
    )
    turned = smooth(elapsed / align_time) if align_time > 0.0 else 1.0
    tool_yaw = planned + turned * wrap_angle(measurement.object_pose.yaw - planned)

    def command(
        position: Vector3, velocity: Vector3 = (0.0, 0.0, 0.0), force: float | None = None
    ) -> TipCommand:
        pushing = force is not None
        push = force if force is not None else 0.0
        return TipCommand(
            force=(push * n[0], push * n[1], 0.0),
            position=position,
            velocity=velocity,
            stiffness=(0.0, *FREE_STIFFNESS[1:]) if pushing else FREE_STIFFNESS,
            damping=FREE_DAMPING,
            normal_yaw=math.atan2(n[1], n[0]),
            tool_yaw=tool_yaw,
            tool_yaw_rate=0.0,
            servo_cap=SERVO_CAP,
            progress=joint_progress,
        )

    if elapsed < align_time:
        target = (before[0], before[1], contact.height)
        u = smooth(elapsed / align_time)
        position = (
            start[0] + u * (target[0] - start[0]),
            start[1] + u * (target[1] - start[1]),
            start[2] + u * (target[2] - start[2]),
        )
        return (command(position),), replace(state, last_time=measurement.time), False

    depth = TOUCH_SPEED * (elapsed - align_time)
    origin: Point = before
    if not state.align:
        # go on from where the tip was when contact was lost
        along = (start[0] - before[0]) * n[0] + (start[1] - before[1]) * n[1]
        origin = (start[0] - along * n[0], start[1] - along * n[1])
        depth += min(max(along, 0.0), gap)
    normal_force = _normal_force(tip, n)
    felt, base = state.felt, state.touch_depth
    if normal_force > threshold:
        felt, base = (felt, base) if felt is not None else (measurement.time, depth)
    elif felt is not None and measurement.time - felt < FELT_TIME:
        felt = None  # a knock, not the object
    next_state = replace(state, last_time=measurement.time, felt=felt, touch_depth=base)
    if felt is not None and measurement.time - felt >= FELT_TIME:
        position = (origin[0] + base * n[0], origin[1] + base * n[1], contact.height)
        push, memory = regulator.step(state.regulator, touch_force, normal_force, dt)
        done = measurement.time - felt > FELT_TIME + SETTLE_TIME + touch_force / regulator.ramp
        return (command(position, force=push),), replace(next_state, regulator=memory), done
    if depth > gap + TOUCH_DEPTH:
        text = f"no contact felt {TOUCH_DEPTH * 1e3:.0f} mm beyond the expected face"
        next_state = replace(next_state, failure=("contact_lost", text))
    position = (origin[0] + depth * n[0], origin[1] + depth * n[1], contact.height)
    velocity = (TOUCH_SPEED * n[0], TOUCH_SPEED * n[1], 0.0)
    return (command(position, velocity),), replace(next_state, regulator=NormalForceState()), False


def _normal_force(tip: TipState, n: Point) -> float:
    return tip.force[0] * n[0] + tip.force[1] * n[1]
