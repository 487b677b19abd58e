"""Friction of a support that differs with place, speed and time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.truth import Truth

STREAM = 3
"""Second entry of the seed of patches."""
STATIC_SPEED = 1e-3
"""Speed [m/s] at which a share 1/e of the excess of static friction is left."""
KINETIC_SPEED = 0.05
"""Speed [m/s] at which all but a share 1/e of the change with speed has happened."""
PATCHES = 64
"""Patches along each axis, after which they repeat."""
MINUTE = 60.0
"""[s]"""


@dataclass(frozen=True, eq=False)
class Ground:
    """Factors of a support's friction coefficient, by ``truth``."""

    truth: Truth
    patches: Array  # (n, n) factors, which repeat

    @classmethod
    def of_truth(cls, truth: Truth, seed: int) -> Ground:
        """Ground with patches drawn by ``seed``, log-normal with a mean of 1."""
        spread = truth.friction_patches
        if spread == 0.0:
            return cls(truth, np.ones((1, 1)))
        rng = np.random.default_rng((seed, STREAM))
        draws = rng.normal(size=(PATCHES, PATCHES))
        deviation = math.sqrt(math.log1p(spread * spread))
        return cls(truth, np.exp(deviation * draws - 0.5 * deviation**2))

    def under(self, points: Array, pose: Pose2, twist: Vector3, time: float) -> Array:
        """Factors (n,) under ``points`` (n, 2) [m] of a frame at a ``pose`` that moves
        with ``twist`` [m/s, m/s, rad/s] along the support's axes, after ``time`` [s].
        """
        vx, vy, w = twist
        c = math.cos(pose.yaw)
        s = math.sin(pose.yaw)
        arms = points @ np.array(((c, s), (-s, c)))
        speeds = np.hypot(vx - w * arms[:, 1], vy + w * arms[:, 0])
        return self.factors(arms + pose.position, speeds, time)

    def factors(self, points: Array, speeds: Array, time: float) -> Array:
        """Factors (n,) at ``points`` (n, 2) [m] in the support's plane that slide with
        ``speeds`` (n,) [m/s], after ``time`` [s].
        """
        drift = (1.0 + self.truth.friction_drift) ** (time / MINUTE)
        patches = self._places(points)
        factors: Array = drift * patches * speed_factors(self.truth, speeds)
        return factors

    def _places(self, points: Array) -> Array:
        """Factors (n,) of the patches at points (n, 2) [m]."""
        cells = np.floor(points / self.truth.patch_size).astype(np.int_)
        i, j = cells.T % len(self.patches)
        places: Array = self.patches[i, j]
        return places


def speed_factors(truth: Truth, speeds: Array) -> Array:
    """Factors (n,) of a friction coefficient at ``speeds`` (n,) [m/s]: Stribeck's law
    for static friction, and a slow change towards high speeds.
    """
    static = (truth.static_friction - 1.0) * np.exp(-speeds / STATIC_SPEED)
    lost = truth.friction_speed * -np.expm1(-speeds / KINETIC_SPEED)
    factors: Array = 1.0 + static - lost
    return factors


def is_uneven(truth: Truth) -> bool:
    """Whether the friction of a support differs with place, speed or time."""
    return (
        truth.static_friction != 1.0
        or truth.friction_speed != 0.0
        or truth.friction_patches != 0.0
        or truth.friction_drift != 0.0
    )
