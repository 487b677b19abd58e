"""Corrections to the paper's text on support and one arm (docs/mechanics.md, sections 1
to 4).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from pushpressslide.core.path import advance
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.contacts import velocity_of_force
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_twist_direction,
)
from pushpressslide.mechanics.press_axle import PAPER_C, Press
from pushpressslide.mechanics.pressing import friction_use
from pushpressslide.mechanics.pressure import PressureSamples, rectangle_pressure
from pushpressslide.mechanics.rho import rho_pole, rho_straight
from pushpressslide.mechanics.virtual_axle import exact_axle_distance
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.rear_stanley import rear_stanley
from pushpressslide_studies.paper.correction import Compared, Correction

MU_SUPPORT = 0.3
MU_TIP = 0.9  # of the pairs object/support and tip/object; the paper gives neither
SEEN = 0.346  # [m] from the centre of pressure to the axle that the paper saw
BAR = Press(
    ObjectModel(Box((0.6, 0.2, 0.1)), 0.3, (0.0, 0.0)), MU_SUPPORT, (0.2, 0.0), 8.0
)
UNIFORM = rectangle_pressure(0.6, 0.2)
PRESSED = rectangle_pressure(0.6, 0.2, 1.0, BAR.cop)
CUBE = rectangle_pressure(0.15, 0.15)
CUBE_LEVER = 0.075
# of the force from the line of contact and CoP
ANGLES = tuple(math.radians(a) for a in range(1, 91, 4))


def distance_from_com() -> Correction:
    """Correction to case 2, experiment B: the figure of 0.82 m."""
    return Correction(
        "The virtual axle is 0.82 m from the CoM",
        "4.1",
        "The axle lies beyond the centre of pressure: the distance from CoM to centre "
        "of pressure is subtracted, not added.",
        (
            Compared(
                "axle from the CoM, away from the contact",
                BAR.paper_printed(),
                -BAR.paper_axle(),
                "m",
                rho="c r0",
            ),
        ),
    )


def pressure_constant() -> Correction:
    """Correction to section II-A and experiment B: the constant c."""
    r0 = BAR.half_diagonal
    seen = math.sqrt(SEEN * BAR.lever) / r0
    return Correction(
        "c is 0.6 for a uniform contact, and 0.43 once the arm's force has shrunk the "
        "patch",
        "1.1",
        "c follows from the pressure, with r0 half the diagonal. Pressed at its end, "
        "the bar partly lifts.",
        (
            *_constants("uniform", PAPER_C, UNIFORM),
            *_constants("pressed", seen, PRESSED),
        ),
    )


def _constants(
    what: str, paper: float, pressure: PressureSamples
) -> tuple[Compared, Compared]:
    """Constant c for a pressure on the bar: for a turn on the spot, and for straight
    motion along the bar.
    """
    pole = rho_pole(pressure) / BAR.half_diagonal
    straight = rho_straight(pressure) / BAR.half_diagonal
    along = f"{what}, straight along the length"
    return (
        Compared(f"{what}, turning on the spot", paper, pole, "", 3, "pole"),
        Compared(along, paper, straight, "", 3, "straight"),
    )


def _spread(distance: Callable[[float], float]) -> float:
    """Ratio of the farthest to the nearest axle, over the angles of the force."""
    distances = [distance(angle) for angle in ANGLES]
    return max(distances) / min(distances)


def _ellipsoid_axle(angle: float) -> float:
    """Distance [m] of the axle by the ellipsoid."""
    force = (math.cos(angle), math.sin(angle))
    surface = EllipsoidLimitSurface(1.0, PAPER_C * BAR.half_diagonal)
    twist = surface.twist_direction(Wrench(*force, BAR.lever * force[1]))
    return twist.vy / twist.w


def force_invariance() -> Correction:
    """Correction to case 2: one axle for all forces."""
    lever = (BAR.lever, 0.0)
    paper = _spread(_ellipsoid_axle)
    pressed = _spread(lambda a: exact_axle_distance(PRESSED, lever, a))
    even = _spread(lambda a: exact_axle_distance(UNIFORM, lever, a))
    what = "ratio of largest to smallest axle distance, force at 1° to 90°, "
    return Correction(
        "The virtual axle is strictly invariant to the force",
        "4",
        "It is invariant on the ellipsoid only. In addition, drag at the tip's height "
        "moves the load towards the force.",
        (
            Compared(what + "pressed end", paper, pressed, "", 3, rho="exact surface"),
            Compared(what + "even load", paper, even, "", 3, rho="exact surface"),
            Compared(
                "axle from the CoM, pulled, tip 0.1 m high",
                BAR.paper_axle(),
                BAR.axle(0.0),
                "m",
                3,
                rho="straight",
            ),
            Compared(
                "axle from the CoM, pushed, tip 0.1 m high",
                BAR.paper_axle(),
                BAR.axle(math.pi),
                "m",
                3,
                rho="straight",
            ),
        ),
    )


def mobility_of_shift() -> Correction:
    """Correction to section II-B: a shift of the centre of pressure."""
    centred = rho_straight(UNIFORM) ** 2

    def shifted(x: float) -> float:
        """rho^2 [m^2] of a load with its centre at ``x`` [m]."""
        return rho_straight(rectangle_pressure(0.6, 0.2, 1.0, (x, 0.0))) ** 2

    return Correction(
        "A shift of the centre of pressure does not change the mobilities",
        "1.2",
        "alpha/beta is the variance of the pressure along the motion; a load off the "
        "centre has less.",
        (
            Compared(
                "alpha/beta, load at a sixth of the length",
                centred,
                shifted(0.1),
                "m²",
                4,
                rho="straight",
            ),
            Compared(
                "alpha/beta, the paper's press",
                centred,
                shifted(BAR.cop[0]),
                "m²",
                4,
                rho="straight",
            ),
        ),
    )


def mobility_of_load() -> Correction:
    """Correction to section II-B, eq. 9: the factor 1/N^2."""
    twist = Twist(0.05, 0.0, 0.0)
    mobilities = []
    for load in (1.0, 3.0):
        wrench = EllipsoidLimitSurface(MU_SUPPORT * load, 0.1).wrench(twist)
        mobilities.append(twist.vx / wrench.fx)
    return Correction(
        "alpha and beta fall with the square of the load",
        "1",
        "lambda is not constant: the force fixes the direction only, and at a given "
        "speed alpha is |v|/(mu N).",
        (
            Compared(
                "alpha at three times the load",
                1.0 / 3.0**2,
                mobilities[1] / mobilities[0],
                "",
                3,
            ),
        ),
    )


def stanley_signs() -> Correction:
    """Correction to case 1, eq. 14: the signs of the Stanley law."""
    start = 0.010
    gain = 8.0
    left = _steered(1.0, start, sign=-1.0)[-1]
    overshoot = -min(_steered(gain, start)) / start
    return Correction(
        "The rear Stanley law is stable without oscillation for any k > 0",
        "3",
        "With errors as reference minus actual the law is stable; it does not "
        "overshoot up to k = v/(4 x_vfa).",
        (
            Compared(
                "offset after 1 m, from 10 mm, errors actual minus reference",
                0.0,
                1e3 * abs(left),
                "mm",
                0,
            ),
            Compared(
                "the same, errors reference minus actual",
                0.0,
                1e3 * abs(_steered(1.0, start)[-1]),
                "mm",
                0,
            ),
            Compared(
                f"overshoot at {gain:g} times that k", 0.0, 100.0 * overshoot, "%", 0
            ),
        ),
    )


def _steered(gain: float, offset: float, sign: float = 1.0) -> list[float]:
    """Offsets [m] of a car's axle over a path of 1 m.

    ``gain`` is relative to the largest gain without overshoot.
    """
    wheelbase = 0.045
    step = 5e-4
    law = rear_stanley(wheelbase, (-1.2, 1.2), gain)
    pose = Pose2(0.0, offset, 0.0)
    offsets = [offset]
    for _ in range(round(1.0 / step)):
        delta, _ = law(-sign * pose.y, -sign * pose.yaw, 0.0, 1.0)
        pose = advance(pose, -math.tan(delta) / wheelbase, step)
        offsets.append(pose.y)
    return offsets


def steering_of_pusher() -> Correction:
    """Correction to case 1, eq. 11: the steering of the pusher."""
    mu = 0.4
    contact = (-CUBE_LEVER, 0.0)
    vx, vy = velocity_of_force(contact, rho_pole(CUBE), (1.0, mu))
    exact = exact_twist_direction(CUBE, Wrench(1.0, mu, -CUBE_LEVER * mu)).moved_to(
        contact
    )
    paper = math.degrees(math.atan(mu))
    return Correction(
        "The steering angle is bounded by atan(mu)",
        "3",
        "atan(mu) bounds the angle of the force. The tangent of the angle of the "
        "pusher's motion is (1 + d²/rho²) times as large.",
        (
            Compared(
                "largest angle of the pusher's motion, ellipsoid",
                paper,
                math.degrees(math.atan2(vy, vx)),
                "°",
                1,
                rho="pole",
            ),
            Compared(
                "the same, exact",
                paper,
                math.degrees(math.atan2(exact.vy, exact.vx)),
                "°",
                1,
                rho="exact surface",
            ),
        ),
    )


def virtual_target() -> Correction:
    """Correction to experiment B: a virtual target beyond the goal must move ahead
    along the goal's line.
    """
    ahead = 0.2
    fixed = _aligned(LookAheadAlignment(ahead, 50.0, Pose2()))
    sliding = _aligned(LookAheadAlignment(ahead, 50.0))
    what = ", from 1 m before the goal and 0.1 m beside it"
    return Correction(
        "A virtual target beyond the pose leaves less than 5 mm and 1 degree",
        "4.2",
        "A target that is fixed there leaves an error. A target that stays 0.2 m "
        "ahead on the goal's line leaves none.",
        (
            Compared(
                "distance from the goal, target fixed 0.2 m beyond it" + what,
                5.0,
                1e3 * abs(fixed[0]),
                "mm",
                1,
            ),
            Compared(
                "yaw error, fixed target", 1.0, math.degrees(abs(fixed[1])), "°", 2
            ),
            Compared(
                "distance from the goal, target moving 0.2 m ahead",
                5.0,
                1e3 * abs(sliding[0]),
                "mm",
                1,
            ),
            Compared(
                "yaw error, moving target", 1.0, math.degrees(abs(sliding[1])), "°", 2
            ),
        ),
    )


def _aligned(law: LookAheadAlignment) -> Point:
    """Offset [m] and heading [rad] of the vehicle when it reaches the goal, which is
    the origin.

    It starts 1 m before the goal and 0.1 m to its side.
    """
    pose = Pose2(-1.0, 0.1, 0.0)
    step = 5e-4
    while pose.x < 0.0:
        turn, _ = law.curvature((pose.x, pose.y, pose.yaw), -pose.y, -pose.yaw, 0.0)
        pose = advance(pose, turn, step)
    return pose.y, pose.yaw


def one_friction() -> Correction:
    """Correction throughout the paper: a single friction coefficient mu."""
    what = "friction utilisation at the tip in straight sliding, 8 N on 0.3 kg"
    return Correction(
        "One mu stands for all friction",
        "4",
        "Tip and support have coefficients of their own: a press slides the object "
        "only if mu_a exceeds mu_s.",
        (
            Compared(
                what,
                100.0 * friction_use(BAR.load, BAR.weight, MU_SUPPORT, MU_SUPPORT),
                100.0 * friction_use(BAR.load, BAR.weight, MU_SUPPORT, MU_TIP),
                "%",
                0,
            ),
        ),
    )
