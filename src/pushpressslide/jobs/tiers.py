"""Tiers: worlds that differ from the belief by stated amounts, drawn by a seed.

The task's own fields stay the truth. Beliefs, biases and the time of a freeze are
drawn; noise, rates and delays are those of the tier.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import Belief
from pushpressslide.core.sensing import Sensing
from pushpressslide.core.task import Task
from pushpressslide.core.truth import EXACT, Truth
from pushpressslide.jobs.engines import DEFAULT

Factors = tuple[float, float]
"""Smallest and largest ratio of the true value to the believed one."""

FRICTION = (0.01, 1.9)
"""Range of a believed friction."""
INSIDE = 0.25
"""Smallest depth of a believed centre of mass inside the base, as a share of the depth
of the true one.
"""


@dataclass(frozen=True, slots=True)
class Tier:
    """Amounts by which a world differs from the belief."""

    support: Factors
    tip: Factors
    mass: Factors
    center: float  # distance of the believed centre of mass from the true one
    relative: bool  # whether ``center`` is a share of the object's size, or in [m]
    sensing: Sensing
    position_bias: float = 0.0  # [m] length of the bias of the object's position
    force_bias: float = 0.0  # [N] length of the bias of the forces
    arm: Truth = EXACT  # sizes of the arms' errors, whose signs are drawn


TIERS = MappingProxyType(
    {
        "tier1": Tier(
            (0.8, 1.2),
            (0.8, 1.2),
            (0.8, 1.2),
            0.01,
            False,
            Sensing(
                position_noise=5e-4,
                yaw_noise=math.radians(0.2),
                pose_rate=60.0,
                pose_delay=0.02,
                force_noise=0.2,
            ),
        ),
        "tier2": Tier(
            (0.7, 1.3),
            (0.7, 1.3),
            (0.7, 1.3),
            0.1,
            True,
            Sensing(
                position_noise=1e-3,
                yaw_noise=math.radians(0.5),
                pose_rate=30.0,
                pose_delay=0.05,
                pose_dropout=0.05,
                force_noise=0.3,
            ),
            position_bias=1e-3,
            force_bias=0.3,
            arm=Truth(
                arm_base=(3e-3, 0.0),
                tip_offset=(2e-3, 0.0, 0.0),
                link_mass=1.1,
                coulomb_friction=0.02,
                viscous_friction=0.02,
                torque_scale=0.05,
            ),
        ),
        "tier3": Tier(
            (0.5, 2.0),
            (0.7, 1.4),
            (0.5, 2.0),
            0.2,
            True,
            Sensing(
                position_noise=3.5e-3,
                yaw_noise=math.radians(2.1),
                pose_rate=10.0,
                pose_delay=0.1,
                pose_dropout=0.1,
                freeze=1.0,
                force_noise=1.0,
            ),
            position_bias=2e-3,
            force_bias=1.0,
            arm=Truth(
                arm_base=(5e-3, 0.0),
                arm_base_yaw=math.radians(0.5),
                tip_offset=(3e-3, 0.0, 0.0),
                link_mass=1.2,
                coulomb_friction=0.02,
                viscous_friction=0.02,
                torque_scale=0.1,
            ),
        ),
    }
)


OF_TIERS = (
    "arm_base",
    "arm_base_yaw",
    "tip_offset",
    "link_mass",
    "coulomb_friction",
    "viscous_friction",
    "torque_scale",
)
"""Fields of the truth that a tier sets. The others stay those of the task."""


def drawn_world(task: Task, seed: int = 0, engine: str = DEFAULT) -> Task:
    """The ``task`` in the world of its tier, if it names one: belief, sensors and arms.

    Errors that the ``engine`` or the arms do not have are left out.
    """
    tier = task.truth.tier
    if tier is None:
        return task
    amounts = TIERS[tier]
    rng = np.random.default_rng([seed, *tier.encode()])
    belief = _belief(task, amounts, rng)
    x, y = _direction(rng)
    bias = (amounts.position_bias * x, amounts.position_bias * y)
    force = rng.normal(size=3)
    fx, fy, fz = (amounts.force_bias * force / np.linalg.norm(force)).tolist()
    sensing = replace(amounts.sensing, position_bias=bias, force_bias=(fx, fy, fz))
    truth = _truth(amounts.arm, rng)
    if engine == "planar":
        truth = truth.for_tips()
    elif any(robot.interface != "torque" for robot in task.robots):
        truth = truth.for_servos()
    arms = {name: getattr(truth, name) for name in OF_TIERS}
    truth = replace(task.truth, tier=None, **arms)
    return replace(task, belief=belief, sensing=sensing, truth=truth)


def _truth(sizes: Truth, rng: np.random.Generator) -> Truth:
    """Errors of the arms of the given ``sizes``, in directions drawn at random."""
    x, y = _direction(rng)
    base = math.hypot(*sizes.arm_base)
    direction = rng.normal(size=3)
    offset = math.hypot(*sizes.tip_offset) * direction / np.linalg.norm(direction)
    tip_x, tip_y, tip_z = offset.tolist()
    yaw, lighter = rng.choice((-1.0, 1.0), size=2).tolist()
    return replace(
        sizes,
        arm_base=(base * x, base * y),
        arm_base_yaw=yaw * sizes.arm_base_yaw,
        tip_offset=(tip_x, tip_y, tip_z),
        link_mass=1.0 + lighter * (sizes.link_mass - 1.0),
    )


def _belief(task: Task, tier: Tier, rng: np.random.Generator) -> Belief:
    """Wrong belief about the true values of ``task``, with its uncertainty."""
    support, tip, mass = (
        _factor(rng, range_) for range_ in (tier.support, tier.tip, tier.mass)
    )
    least, most = FRICTION
    size = math.sqrt(task.object.shape.placed(Pose2()).area) if tier.relative else 1.0
    return Belief(
        min(max(task.support.friction / support, least), most),
        min(max(task.contact_friction / tip, least), most),
        task.object.mass / mass,
        _center(task, tier.center * size, rng),
        task.belief.rho,
        min(0.5, tier.support[1] - 1.0),
        tier.center * size,
        min(0.5, tier.mass[1] - 1.0),
    )


def _factor(rng: np.random.Generator, factors: Factors) -> float:
    """Ratio of a true value to the believed one, uniform in its logarithm."""
    low, high = factors
    return math.exp(float(rng.uniform(math.log(low), math.log(high))))


def _center(task: Task, error: float, rng: np.random.Generator) -> Point:
    """Believed centre of mass [m] in G, uniform over the disc of radius ``error`` [m]
    about the true one, as far as it is well inside the base, or inside the hull of one
    that the true centre is outside of.
    """
    shape = task.object.shape
    true = task.object.center_of_mass
    if shape.depth(true) <= 0.0:
        shape = shape.hull
    x, y = _direction(rng)
    off = error * math.sqrt(float(rng.random()))
    least = INSIDE * shape.depth(true)
    while True:
        believed = (true[0] + off * x, true[1] + off * y)
        if shape.depth(believed) >= least:
            return believed
        off *= 0.8


def _direction(rng: np.random.Generator) -> Point:
    angle = float(rng.uniform(-math.pi, math.pi))
    return (math.cos(angle), math.sin(angle))
