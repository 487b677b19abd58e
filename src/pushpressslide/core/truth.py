"""The real arms and the real world, where they differ from what the controller
believes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Literal

from pushpressslide.core.arm_truth import ArmTruth
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.control import Vector3
from pushpressslide.core.errors import TaskError
from pushpressslide.core.field_spec import documented, setting
from pushpressslide.core.pose import Point

TierName = Literal["tier1", "tier2", "tier3"]
"""A world that differs from the belief by stated amounts: jobs/tiers.py."""


@documented
@dataclass(frozen=True, slots=True)
class Truth(ArmTruth):
    """Errors of the arms, the same for each arm, and of the world. Random ones are drawn
    with the run's seed, those of arms for each joint. Of a slide, a radian is a metre.
    """

    static_friction: float = setting(
        1.0,
        "friction of a support at rest over that in motion; falls with the speed to "
        "37 % of the excess at 1 mm/s",
        within="[1, 2]",
    )
    friction_speed: float = setting(
        0.0,
        "share of the support's friction that is lost at high speed, 63 % of it at "
        "50 mm/s; < 0: friction that grows",
        within="[-0.5, 0.5]",
    )
    friction_direction: float = setting(
        0.0,
        "difference of the support's friction across and along its grain, as a share of "
        "their mean",
        within="[0, 1]",
    )
    grain_yaw: float = setting(
        0.0, "direction of the grain in the support's plane", "deg", "[-180, 180]"
    )
    friction_patches: float = setting(
        0.0,
        "standard deviation of the support's friction from patch to patch, as a share",
        within="[0, 0.5]",
    )
    patch_size: float = setting(0.05, "edge of each patch", "m", "[0.005, 0.5]")
    friction_drift: float = setting(
        0.0,
        "share by which the support's friction grows in each minute",
        within="[-0.5, 1]",
    )
    size: Point = setting(
        (0.0, 0.0),
        "true extent of the object minus the believed one, along x and y of G",
        "m",
        "[-0.02, 0.02]",
    )
    tip_radius: float = setting(
        0.0, "true radius of each tip minus the believed one", "m", "[-0.01, 0.01]"
    )
    obstacle_offset: float = setting(
        0.0,
        "standard deviation of each obstacle's true place about the believed one, along "
        "x and along y",
        "m",
        "[0, 0.05]",
    )
    tilt: float = setting(
        0.0, "angle between the level and the support, with its arms", "deg", "[0, 10]"
    )
    tilt_yaw: float = setting(
        0.0,
        "direction in the world in which this tilt falls",
        "deg",
        "[-180, 180]",
    )
    bow: float = setting(
        0.0,
        "change of the pressure at the rim of the object's base, as a share, if the "
        "base is bowed; in the middle it changes by the opposite",
        within="[-0.9, 0.9]",
    )
    feet: float = setting(
        0.0,
        "place of four feet that bear the object in place of its whole base: share of "
        "the way from the base's middle to its rim, towards the corners of its bounding "
        "box",
        within="[0, 0.95]",
    )
    ridge: float = setting(
        0.0,
        "height of a straight ridge on the support, 20 mm wide, across the line from "
        "start to goal",
        "m",
        "[0, 0.002]",
    )
    ridge_place: float = setting(
        0.5,
        "where the ridge crosses the line from start to goal, as a share of its length",
        within="[0, 1]",
    )
    ridge_angle: float = setting(
        0.0,
        "angle from the normal of the line from start to goal to the ridge, positive "
        "from x to y",
        "deg",
        "[-80, 80]",
    )
    tier: TierName | None = setting(
        None,
        "a world drawn by the run's seed, in place of `belief` (except `rho`), `sensing` "
        "and the errors of bases, tips, link masses, joint friction and torques; `truth: "
        "tier2` for short",
    )

    @property
    def gravity(self) -> Vector3:
        """Acceleration [m/s^2] of a falling body, in the world."""
        along = GRAVITY * math.sin(self.tilt)
        x = along * math.cos(self.tilt_yaw)
        y = along * math.sin(self.tilt_yaw)
        return (x, y, -GRAVITY * math.cos(self.tilt))

    def for_servos(self) -> Truth:
        """The truth without what only arms have that take torques."""
        return replace(self, **{name: getattr(EXACT, name) for name in DRIVES})

    def for_tips(self) -> Truth:
        """The truth without what only joints have."""
        return replace(self.for_servos(), encoder_bias=0.0)


DRIVES = (
    "link_mass",
    "coulomb_friction",
    "viscous_friction",
    "torque_scale",
    "torque_ripple",
    "backlash",
)
"""Fields of arms that take torques."""

EXACT = Truth()
"""Arms and a world that are as the controller believes."""


def refuse_truth(truth: Truth, possible: Truth, source: str, where: str) -> None:
    """Raise TaskError if a truth differs from what is ``possible``, which the message
    says ``where``.
    """
    for one in fields(truth):
        value = getattr(truth, one.name)
        allowed = getattr(possible, one.name)
        if value == allowed:
            continue
        key = f"truth.{one.name}"
        if one.metadata["entry"].unit == "deg":
            key += "_deg"
            value = round(math.degrees(value), 9)
        raise TaskError(source, key, value, f"allowed {where}: {allowed}")
