"""The real arms, where they differ from the controller's model of them."""

from __future__ import annotations

from dataclasses import dataclass

from pushpressslide.core.checks import check_fields
from pushpressslide.core.control import Vector3
from pushpressslide.core.field_spec import documented, setting
from pushpressslide.core.pose import Point


@documented
@dataclass(frozen=True, slots=True)
class ArmTruth:
    """Errors of the controller's model of the arms, the same for each arm. Random ones
    are drawn for each joint with the run's seed. Of a slide, a radian is a metre.
    """

    arm_base: Point = setting(
        (0.0, 0.0),
        "true position of each base minus the believed one, along the world's x and y",
        "m",
        "[-0.05, 0.05]",
    )
    arm_base_yaw: float = setting(
        0.0, "true yaw of each base minus the believed one", "deg", "[-5, 5]"
    )
    tip_offset: Vector3 = setting(
        (0.0, 0.0, 0.0),
        "true position of each tip minus the believed one, in the tool's frame",
        "m",
        "[-0.02, 0.02]",
    )
    encoder_bias: float = setting(
        0.0, "standard deviation of each encoder's constant error", "deg", "[0, 2]"
    )
    link_mass: float = setting(
        1.0, "true mass of each link, as a multiple of the believed one", "", "[0.5, 2]"
    )
    coulomb_friction: float = setting(
        0.0,
        "dry friction of each joint, as a share of its effort limit",
        within="[0, 0.2]",
    )
    viscous_friction: float = setting(
        0.0,
        "viscous friction of each joint at its velocity limit, as a share of its effort "
        "limit",
        within="[0, 0.5]",
    )
    torque_scale: float = setting(
        0.0,
        "standard deviation of the constant relative error of each joint's torque",
        within="[0, 0.3]",
    )
    torque_ripple: float = setting(
        0.0,
        "amplitude of an error of each joint's torque that is periodic in the joint's "
        "angle, as a share of the torque",
        within="[0, 0.2]",
    )
    backlash: float = setting(
        0.0,
        "play of each joint's gear between the motor, which has the encoder, and the "
        "link; the motor crosses it at 0.1 rad/s, without torque on the link",
        "deg",
        "[0, 0.5]",
    )
    command_delay: float = setting(
        0.0,
        "time until a command reaches the arm, beyond its `delay`, rounded to control "
        "periods",
        "s",
        "[0, 0.2]",
    )
    missed_ticks: float = setting(
        0.0,
        "probability that the command of a control period does not reach the arm, which "
        "goes on with the last one",
        within="[0, 0.5]",
    )

    def __post_init__(self) -> None:
        check_fields(self)
