"""Phase touch: line the tips up with their contacts, advance until they feel the
object, settle the normal forces. From the side or from above alike.
"""

from __future__ import annotations

import math
from dataclasses import replace

from pushpressslide.control.state import (
    FREE_DAMPING,
    FREE_STIFFNESS,
    SERVO_CAP,
    TipMemory,
    contact_yaw,
    pressed,
    ramp_time,
    smooth,
    tip_position,
)
from pushpressslide.core.control import TipCommand, TipState, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState
from pushpressslide.planning.overhead import TOUCH_SPEED

# [m] beyond the expected contact at which the object counts as not there
TOUCH_DEPTH = 0.05
FELT_TIME = 0.03  # [s] of normal force before a touch is believed
SETTLE_TIME = 0.2  # [s] that the touch force must hold


def align_time(
    memory: TipMemory, contact: Contact, X_WB: Pose2, radius: float, gap: float
) -> float:
    """Return how long a tip takes to line up ``gap`` [m] before its contact [s]."""
    return (
        ramp_time(math.dist(tip_position(contact, X_WB, radius, gap), memory.start))
        + 0.1
    )


def touch(
    memory: TipMemory,
    tip: TipState,
    contact: Contact,
    X_WB: Pose2,
    radius: float,
    time: float,
    elapsed: float,
    aligned: float,
    dt: float,
    regulator: NormalForceRegulator,
    force: float,
    threshold: float,
    gap: float,
    tool_yaw: float,
    joint_progress: float,
) -> tuple[TipCommand, TipMemory, bool, str | None]:
    """Return one tip's command, what to remember, whether its touch is complete, and
    what went wrong.

    ``elapsed`` [s] since the phase began; ``aligned`` [s] at which the advance begins,
    0 to go on from where the tip is; ``force`` [N] is what it presses with in the end,
    ``threshold`` [N] counts as contact, ``gap`` [m] is the free way before the object.
    """
    if memory.held is not None:
        return memory.held, memory, True, None
    n = contact.direction(X_WB)
    before = tip_position(contact, X_WB, radius, gap)

    def command(
        position: Vector3,
        velocity: Vector3 = (0.0, 0.0, 0.0),
        push: float | None = None,
    ) -> TipCommand:
        return held_at(
            contact, X_WB, position, velocity, push, tool_yaw, joint_progress
        )

    start = memory.start
    if elapsed < aligned:
        u = smooth(elapsed / aligned)
        return command(_along(start, before, u)), memory, False, None
    depth = TOUCH_SPEED * (elapsed - aligned)
    origin = before
    if aligned == 0.0:
        # go on from where the tip was when contact was lost
        ahead = sum((s - b) * d for s, b, d in zip(start, before, n, strict=True))
        origin = _ahead(start, n, -ahead)
        depth += min(max(ahead, 0.0), gap)
    normal_force = pressed(tip.force, n)
    felt = memory.felt
    base = memory.touch_depth
    if normal_force > threshold:
        felt, base = (felt, base) if felt is not None else (time, depth)
    elif felt is not None and time - felt < FELT_TIME:
        felt = None  # a knock, not the object
    memory = replace(memory, felt=felt, touch_depth=base)
    if felt is not None and time - felt >= FELT_TIME:
        push, state = regulator.step(memory.regulator, force, normal_force, dt)
        done = time - felt > FELT_TIME + SETTLE_TIME + force / regulator.ramp
        return (
            command(_ahead(origin, n, base), push=push),
            replace(memory, regulator=state),
            done,
            None,
        )
    problem = None
    if depth > gap + TOUCH_DEPTH:
        problem = f"no contact felt {TOUCH_DEPTH * 1e3:.0f} mm beyond where the object should be"
    velocity = (TOUCH_SPEED * n[0], TOUCH_SPEED * n[1], TOUCH_SPEED * n[2])
    memory = replace(memory, regulator=NormalForceState())
    return command(_ahead(origin, n, depth), velocity), memory, False, problem


def held_at(
    contact: Contact,
    X_WB: Pose2,
    position: Vector3,
    velocity: Vector3,
    push: float | None,
    tool_yaw: float,
    joint_progress: float,
) -> TipCommand:
    """Return the command of a tip that is held at ``position`` [m], moving at
    ``velocity`` [m/s]; or, along its normal, that pushes with ``push`` [N].
    """
    n = contact.direction(X_WB)
    free = FREE_STIFFNESS
    f = push or 0.0
    stiffness = free
    if push is not None:
        stiffness = (
            (free[0], free[1], 0.0)
            if contact.kind == "top"
            else (0.0, free[1], free[2])
        )
    return TipCommand(
        force=(f * n[0], f * n[1], f * n[2]),
        position=position,
        velocity=velocity,
        stiffness=stiffness,
        damping=FREE_DAMPING,
        normal_yaw=contact_yaw(contact, X_WB),
        tool_yaw=tool_yaw,
        tool_yaw_rate=0.0,
        servo_cap=SERVO_CAP,
        progress=joint_progress,
    )


def _along(a: Vector3, b: Vector3, u: float) -> Vector3:
    return (
        a[0] + u * (b[0] - a[0]),
        a[1] + u * (b[1] - a[1]),
        a[2] + u * (b[2] - a[2]),
    )


def _ahead(origin: Vector3, direction: Vector3, way: float) -> Vector3:
    return (
        origin[0] + way * direction[0],
        origin[1] + way * direction[1],
        origin[2] + way * direction[2],
    )
