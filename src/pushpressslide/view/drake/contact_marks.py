"""Marks of the contacts and their positions: forces, friction cones and discs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import PHASES, Phase
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.view.drake.playback import Playback
from pushpressslide.view.drake.subject import CLEARANCE, body_pose, contacts_at
from pushpressslide.view.film import LegendEntry

TOUCHING: tuple[Phase, ...] = ("touch", "move", "release")
FORCE_SCALE = 0.02  # [m/N] largest
STILL_FORCE_SCALE = 0.06  # [m/N] largest in pictures without a scale
LONGEST_ARROW = 0.15  # [m] of a force in the plane
LONGEST_PRESS = 0.10  # [m]
WIDEST_DISC = 0.09  # [m] radius of a friction disc
LEAST_FORCE = 0.3  # [N] smaller forces have no arrow
CONE_LENGTH = 0.12  # [m] of a friction cone
CONE_SINK = 0.005  # [m] of a friction cone under its arrow


@dataclass(frozen=True, eq=False)
class Arrow:
    """A force with its start point, along x, y and height of the support."""

    tail: Array  # (3,) [m]
    force: Array  # (3,) [N]
    scale: float  # [m/N]

    @property
    def size(self) -> float:
        """Size of the force [N]."""
        return float(np.linalg.norm(self.force))

    @property
    def head(self) -> Array:
        """End point (3,) [m] of the arrow."""
        return self.tail + self.scale * self.force


@dataclass(frozen=True, slots=True)
class Disc:
    """A friction disc: its centre [m] along x, y and height, and its radius [m]."""

    x: float
    y: float
    height: float
    radius: float


class ContactMarks:
    """Marks of all contacts of a run, in the support's frame."""

    def __init__(
        self, playback: Playback, nearer: Array, largest: float = FORCE_SCALE
    ) -> None:
        """Choose the scales, up to ``largest`` [m/N]. ``nearer`` (3,) points to the
        camera, in the world.
        """
        self.playback = playback
        self.friction = playback.task.contact_friction
        self.height = playback.task.object.shape.height
        forces = np.nan_to_num(playback.record.arrays["measured_force"])
        loads = np.maximum(-forces[:, :, 2], 0.0)
        every = [c for part in playback.placements for c in part.contacts]
        self.arms = sorted({c.arm for c in every})
        self.pressing = sorted({c.arm for c in every if c.kind == "top"})
        self.pushes = any(c.kind == "side" for c in every)
        flat_forces = np.linalg.norm(forces[:, :, :2], axis=2)
        self.scale = _scale(flat_forces, LONGEST_ARROW, largest)
        if self.pressing:
            discs = _scale(self.friction * loads, WIDEST_DISC, largest)
            self.scale = min(self.scale, discs)
        self.press_scale = _scale(loads, LONGEST_PRESS, largest)
        frame = playback.task.support.frame
        flat: Any = np.array(frame.components(tuple(nearer.tolist())))
        flat[2] = 0.0
        self._nearer = flat / max(float(np.linalg.norm(flat)), 1e-9)

    def contact(self, arm: int, tick: int) -> Contact | None:
        """Contact of an arm at a tick."""
        touched = contacts_at(self.playback, tick)
        return next((c for c in touched if c.arm == arm), None)

    def push(self, arm: int, tick: int) -> Arrow:
        """Force in the plane, drawn above the object.

        The force of a push starts at its contact, the shear force of a press at the
        edge of the tip.
        """
        flat = np.array([*self._force(arm, tick)[:2], 0.0])
        ahead = flat / max(float(np.linalg.norm(flat)), 1e-9)
        contact = self.contact(arm, tick)
        if contact is not None and contact.kind == "side":
            ahead = np.array(contact.direction(body_pose(self.playback, tick)))
        tail = self._above(arm, tick) + self._radius(arm) * ahead
        return Arrow(tail, flat, self.scale)

    def cone(self, arm: int, tick: int) -> tuple[Pose2, float] | None:
        """Apex and axis of a push's friction cone, and its height [m]. None without a
        push.
        """
        contact = self.contact(arm, tick)
        arrow = self.push(arm, tick)
        if contact is None or contact.kind != "side" or arrow.size <= LEAST_FORCE:
            return None
        x, y, _ = contact.direction(body_pose(self.playback, tick))
        apex = Pose2(float(arrow.tail[0]), float(arrow.tail[1]), math.atan2(y, x))
        return apex, float(arrow.tail[2]) - CONE_SINK

    def press(self, arm: int, tick: int) -> Arrow:
        """Force of a press, drawn so that it ends on the object next to the tip. 0 N
        without a press.
        """
        down = np.zeros(3)
        contact = self.contact(arm, tick)
        if contact is not None and contact.kind == "top":
            down[2] = min(self._force(arm, tick)[2], 0.0)
        aside = (self._radius(arm) + CLEARANCE) * self._nearer
        head = self._above(arm, tick) + aside
        head[2] = self.height
        return Arrow(head - self.press_scale * down, down, self.press_scale)

    def disc(self, arm: int, tick: int) -> Disc | None:
        """Friction disc of a press, which contains the end of the press's shear force.
        None without a press.
        """
        load = self.press(arm, tick).size
        if load <= LEAST_FORCE:
            return None
        x, y, z = self._above(arm, tick)
        radius = self.scale * self.friction * load + self._radius(arm)
        return Disc(float(x), float(y), float(z) - CONE_SINK, radius)

    def entries(self) -> list[LegendEntry]:
        """Legend of the colours of a replay."""
        goal = "goal" if len(self.playback.goals) == 1 else "goals"
        force = f"contact force in the plane, {1e3 * self.scale:.0f} mm a newton"
        out = [
            LegendEntry("#d98c40", "object"),
            LegendEntry("#009e73", goal),
            LegendEntry("#222222", "planned path of the tracking point"),
            LegendEntry("#0072b2", "its trace; the pin is the virtual axle"),
            LegendEntry("#a8387d", force),
        ]
        cones = ["friction cone"] * self.pushes + ["friction disc"] * bool(
            self.pressing
        )
        if cones:
            out.append(LegendEntry("#e69f00", " and ".join(cones)))
        if self.pressing:
            press = f"press, beside its tip, {1e3 * self.press_scale:.0f} mm a newton"
            out.append(LegendEntry("#d55e00", press))
        return out

    def _force(self, arm: int, tick: int) -> Any:
        """Measured force (3,) [N] of an arm.

        It is 0 N before and after the contact, when the sensor only feels the arm's own
        motion.
        """
        phase = PHASES[int(self.playback.record.arrays["phase"][tick])]
        if phase not in TOUCHING:
            return np.zeros(3)
        return np.nan_to_num(self.playback.record.arrays["measured_force"][tick, arm])

    def _above(self, arm: int, tick: int) -> Any:
        """Position (3,) [m] above both a tip and the object."""
        x, y, _ = self.playback.record.arrays["tip_position"][tick, arm]
        return np.array([x, y, self.height + CLEARANCE])

    def _radius(self, arm: int) -> float:
        return self.playback.task.robots[arm].tip_radius


def _scale(forces: Array, longest: float, largest: float) -> float:
    """Length of an arrow per force [m/N].

    It is at most ``largest``, and no arrow is longer than ``longest`` [m].
    """
    return min(largest, longest / max(float(forces.max(initial=0.0)), 1e-9))
