"""What the tips do in the move and on release: from contact forces and the object's
twist to tip commands.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from pushpressslide.control.entry import braking
from pushpressslide.control.state import (
    SERVO_CAP,
    ControllerState,
    TipMemory,
    approached,
    contact_yaw,
    pressed,
)
from pushpressslide.control.touch import held_at
from pushpressslide.core.control import TipCommand, TipState, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.wrench import Twist
from pushpressslide.execution.normal_force import NormalForceRegulator

# of all pushes: one that is asked for less may part from its face for a while
LEAST_SHARE = 0.2
LOSS_SHARE = 0.6  # of its planned load below which a press counts as lost
# [N/m], [N s/m] of a pushing tip: soft, so that it does not lean on the face
HEIGHT_STIFFNESS = 2000.0
HEIGHT_DAMPING = 300.0
# [N s/m] of a pressing tip along its normal, which is force controlled
PRESS_DAMPING = 150.0
# [m/s^2] of the tips' reference: a jump of the steering must not jerk the contact
TIP_ACCELERATION = {"side": 5.0, "top": 1.0}
DRAG = (0.5, 2.5)  # bounds of the feed-forward's ratio to the plan's


class Felt(NamedTuple):
    """What a tip feels of its contact."""

    lost: bool
    use: float  # share of the friction cone that its shear takes


@dataclass(frozen=True, slots=True)
class TipMover:
    """A contact force as feed-forward, and a velocity servo along the contact's motion;
    a press is regulated.
    """

    damping: float  # [N s/m] of the servo
    friction: float  # of the pair end effector/object, as believed
    threshold: float  # [N] that counts as contact
    regulator: NormalForceRegulator

    def step(
        self,
        memory: TipMemory,
        tip: TipState,
        contact: Contact,
        X_WB: Pose2,
        twist: Twist,
        inside: Point,
        f_B: Point,
        load: float,
        dt: float,
        progress: float,
        entry_speed: float | None = None,
    ) -> tuple[TipCommand, TipMemory, Felt]:
        """Return the tip's command, what to remember, and what it feels.

        ``twist`` is the object's, in B; ``inside`` [m] in B is the tip's centre;
        ``f_B`` [N] the force along the support, ``load`` [N] what a press is to have;
        ``progress`` [m] is for the joint reference; ``entry_speed`` [m/s] is that of a
        press whose object goes into an opening.
        """
        n = contact.direction(X_WB)
        normal_force = pressed(tip.force, n)
        shear = math.hypot(
            tip.force[0] - normal_force * n[0], tip.force[1] - normal_force * n[1]
        )
        felt = Felt(
            normal_force < max(0.5 * self.threshold, LOSS_SHARE * contact.load),
            shear / (self.friction * max(normal_force, self.threshold)),
        )
        f = X_WB.rotate(f_B)
        at_tip = twist.moved_to(inside)
        before = memory.velocity or (0.0, 0.0)
        wanted = X_WB.rotate((at_tip.vx, at_tip.vy))
        v = approached(before, wanted, TIP_ACCELERATION[contact.kind] * dt)
        a = (
            ((v[0] - before[0]) / dt, (v[1] - before[1]) / dt, 0.0)
            if dt > 0.0
            else (0.0, 0.0, 0.0)
        )
        height = tip.position[2]
        regulator = memory.regulator
        stiffness = 0.0
        damping = PRESS_DAMPING
        push = 0.0
        if entry_speed is not None:  # nothing but the damper holds it back
            push = load
            damping = load / entry_speed
            felt = Felt(False, 0.0)
            a = (a[0], a[1], braking(-tip.velocity[2], entry_speed))
            most = self.friction * max(normal_force, 0.0)
            size = math.hypot(*f)
            # what it holds by friction
            f = (f[0] * most / size, f[1] * most / size) if size > most else f
        elif contact.kind == "top":
            push, regulator = self.regulator.step(regulator, load, normal_force, dt)
        else:
            height = contact.height
            stiffness = HEIGHT_STIFFNESS
            damping = HEIGHT_DAMPING
        command = TipCommand(
            force=(f[0], f[1], -push),
            position=(tip.position[0], tip.position[1], height),
            velocity=(v[0], v[1], 0.0),
            stiffness=(0.0, 0.0, stiffness),
            damping=(self.damping, self.damping, damping),
            normal_yaw=contact_yaw(contact, X_WB),
            tool_yaw=X_WB.yaw,
            tool_yaw_rate=twist.w,
            servo_cap=SERVO_CAP,
            progress=progress,
            acceleration=a,
        )
        return command, replace(memory, velocity=v, regulator=regulator), felt


def missing(
    felt: Sequence[Felt], contacts: Sequence[Contact], normals: Sequence[float]
) -> bool:
    """Return whether a contact is lost that is to press, or to push with a good share
    of all ``normals`` [N].
    """
    least = LEAST_SHARE * math.fsum(normals)
    asked = (
        c.kind == "top" or n >= least for c, n in zip(contacts, normals, strict=True)
    )
    return any(f.lost and wanted for f, wanted in zip(felt, asked, strict=True))


def drawn_back(
    start: Vector3,
    contact: Contact,
    X_WB: Pose2,
    back: float,
    tool_yaw: float,
    progress: float,
) -> TipCommand:
    """Return the command of a tip that is drawn ``back`` [m] off its contact from
    ``start`` [m].
    """
    n = contact.direction(X_WB)
    place = (start[0] - back * n[0], start[1] - back * n[1], start[2] - back * n[2])
    return held_at(contact, X_WB, place, (0.0, 0.0, 0.0), None, tool_yaw, progress)


def drag_ratio(state: ControllerState) -> float:
    """Return what the object's drag was seen to be over what it was planned to be:
    friction, mass, or a load that it pushes.
    """
    seen = state.axle.drag
    if seen is None:
        return 1.0
    return min(
        max(seen / state.stretch.choice.parameters["push_force"], DRAG[0]), DRAG[1]
    )
