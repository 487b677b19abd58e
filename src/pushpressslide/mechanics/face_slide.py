"""Sliding of an object on a base with straight edges under a wrench: the exact limit
surface in closed form, inverted by Newton's method.

Source: docs/mechanics.md, sections 1 and 1.3. All numbers are plain floats.
``mechanics.limit_surface`` does the same for samples of a pressure.
"""

from __future__ import annotations

import math
from functools import cached_property

from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.kernels.edge_friction import far_center_friction, near
from pushpressslide.kernels.exact_surface import across
from pushpressslide.kernels.support_friction import Friction
from pushpressslide.mechanics.face_pressure import FacePressure

STEPS = 60  # of Newton's method, at most
FLAT = 1e-14  # gradient of the power at its least
SURE = 1e-8  # a whole step that long squares to less than rounding
# smallest decrease in a step, as a share of the decrease predicted by the slope
DOWN = 1e-4
SHORTEST = 1e-6  # share of a step below which only round-off is left
SLOWEST = 1e-3  # smallest component of a guessed twist along the wrench, as a share

Triple = tuple[float, float, float]


class FaceSurface:
    """Limit surface of a pressure, per unit of its load, about its centre of pressure."""

    def __init__(self, face: FacePressure) -> None:
        """Precompute the edges, with rho as the unit of length."""
        self.rho = face.rho  # [m] root mean square distance of the load
        self._face = face.scaled(self.rho)
        self._edges = tuple(map(tuple, self._face.edges().tolist()))
        self._plane = self._face.plane()

    @cached_property
    def _series(self) -> tuple[complex, ...]:
        return self._face.series()

    def _friction(self, twist: Triple) -> Friction:
        """``polygon_friction`` of a twist (vx, vy, rho w), not zero."""
        vx, vy, w = twist
        if abs(w) > self._plane[3] * math.hypot(vx, vy):
            return near(vx, vy, w, self._plane, self._edges)
        return far_center_friction(vx, vy, w, self._series)

    def slide(self, wrench: Wrench, guess: Twist | None = None) -> tuple[Twist, float]:
        """Direction of sliding under ``wrench``, and the factor by which the wrench
        exceeds the surface of mu N = 1.

        The direction is a twist of the wrench's reference point, the centre of
        pressure. It has the smallest friction power among all twists at which the
        wrench has unit power (maximum dissipation). A ``guess`` of the twist, at any
        body point, saves time. Raises ValueError for a wrench that is zero or not
        finite.
        """
        rho = self.rho
        size = math.hypot(wrench.fx, wrench.fy, wrench.tau / rho)
        if not (size > 0.0 and math.isfinite(size)):
            raise ValueError("a zero wrench has no direction of sliding")
        target = (wrench.fx / size, wrench.fy / size, wrench.tau / (rho * size))
        twist = target  # the ellipsoid's
        if guess is not None:
            vx, vy, w, _ = guess.moved_to(wrench.about)
            nu = (vx, vy, rho * w)
            unit = max(_dot(target, nu), SLOWEST * math.hypot(*nu))
            twist = (nu[0] / unit, nu[1] / unit, nu[2] / unit)
        (vx, vy, w), power = self._least_power_twist(twist, target)
        norm = math.hypot(vx, vy, w)
        found = Twist(vx / norm, vy / norm, w / (norm * rho), wrench.about)
        return found, size / power

    def _least_power_twist(self, twist: Triple, target: Triple) -> tuple[Triple, float]:
        """Twist with the smallest friction power among all twists at which the unit
        wrench ``target`` has unit power, and the friction power.

        It is found by Newton steps, which are halved until the power, or in the end its
        gradient, decreases.
        """
        a, b = across(target)
        off = 1.0 - _dot(target, twist)
        twist = _stepped(twist, off, target)
        at = _Power(self._friction(twist), twist, a, b)
        for _ in range(STEPS):
            if at.steepest < FLAT:
                break
            p, q = at.step()
            slope = at.ga * p + at.gb * q
            share = 1.0
            while True:
                ahead = _stepped(_stepped(twist, share * p, a), share * q, b)
                trial = _Power(self._friction(ahead), ahead, a, b)
                falls = trial.value <= at.value + DOWN * share * slope
                if falls or trial.steepest < 0.5 * at.steepest:
                    break
                share *= 0.5
                if share < SHORTEST:
                    return twist, at.value
            twist = ahead
            at = trial
            if share == 1.0 and max(abs(p), abs(q)) < SURE:
                break
        return twist, at.value


class _Power:
    """Friction power at a twist, with its gradient and second derivatives along two
    unit vectors.
    """

    __slots__ = ("aa", "ab", "bb", "ga", "gb", "value")

    def __init__(self, friction: Friction, twist: Triple, a: Triple, b: Triple) -> None:
        fx, fy, tau, xx, xy, xw, yy, yw, ww = friction
        wrench = (fx, fy, tau)
        self.value = _dot(wrench, twist)
        self.ga = _dot(wrench, a)
        self.gb = _dot(wrench, b)
        row_a = (
            xx * a[0] + xy * a[1] + xw * a[2],
            xy * a[0] + yy * a[1] + yw * a[2],
            xw * a[0] + yw * a[1] + ww * a[2],
        )
        row_b = (
            xx * b[0] + xy * b[1] + xw * b[2],
            xy * b[0] + yy * b[1] + yw * b[2],
            xw * b[0] + yw * b[1] + ww * b[2],
        )
        self.aa = _dot(row_a, a)
        self.ab = _dot(row_a, b)
        self.bb = _dot(row_b, b)

    @property
    def steepest(self) -> float:
        """The larger component of the gradient."""
        return max(abs(self.ga), abs(self.gb))

    def step(self) -> tuple[float, float]:
        """Newton step along the two vectors, slightly damped."""
        damping = FLAT * (1.0 + self.aa + self.bb)
        aa = self.aa + damping
        bb = self.bb + damping
        determinant = aa * bb - self.ab * self.ab
        if not determinant > 0.0:
            return -self.ga, -self.gb
        p = (self.ab * self.gb - bb * self.ga) / determinant
        q = (self.ab * self.ga - aa * self.gb) / determinant
        return p, q


def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _stepped(place: Triple, step: float, direction: Triple) -> Triple:
    return (
        place[0] + step * direction[0],
        place[1] + step * direction[1],
        place[2] + step * direction[2],
    )
