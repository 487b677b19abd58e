"""Filter of the object's pose: predicted by the motion of a tip, corrected by pictures at
their own time.

The state is the place of a body-fixed point C at the first contact, the yaw, the turn
arm (a, b) and the share of the tip's motion that C does not follow. C moves with the tip
while the contact sticks, however the object turns. Sliding on an ellipsoid of friction,
with C at r from the centre of friction, an object turns by (r x d) / (rho^2 + r^2) while
C moves by d (docs/mechanics.md, section 2): by a d_y - b d_x in the body's axes. So the
pictures of a motion tell the direction from the centre of friction to the contact,
without any force. Pictures that do not fit are ignored, unless three in a row agree with
each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.sensing import Sensing

# standard deviations of a pose without stated noise
LEAST_NOISE = 2e-4  # [m]
LEAST_YAW_NOISE = math.radians(0.08)
# growth of the uncertainty with the square root of time
DISTURBED = (1e-3, math.radians(0.5))  # [m], [rad] in 1 s, while tips touch or let go
STILL = (1e-4, math.radians(0.03))  # the same of an object that is held, or left alone
# growth with the square root of the tip's path
SLIPPED = (4.5e-3, math.radians(2.2))  # [m], [rad] in 1 m
ARM = 0.2
"""Standard deviation of the turn arm, times the radius of the object."""
ARM_LENGTH = 4.0  # [m] of path after which it may be another
CHANGED = 0.3
"""Standard deviation of a planned change of the turn arm, as a share of it."""
SLIP = 0.15
"""Standard deviation of the share of its motion by which a tip slips."""
SLIP_LENGTH = 0.05  # [m] of path after which it may be another
GATE = 25.0
"""Squared Mahalanobis distance of a picture above which it does not fit (3 degrees of
freedom; exceeded by one in 65,000).
"""
STRANGERS = 3
"""Number of pictures in a row that do not fit but agree, and then replace the estimate."""


class Advance(NamedTuple):
    """Predicted motion of the object in a tick."""

    time: float  # [s] at its end
    dt: float  # [s]
    tip: Point = (0.0, 0.0)  # [m] displacement of the tip, world
    turn: float = 0.0  # [rad] of the object, as several tips turn it
    disturbed: bool = False  # whether tips may move it besides
    tips: tuple[Point, ...] = ()  # [m] at its end, of the contacts that drive it


class Mean(NamedTuple):
    """Estimated place of C, yaw, and errors of the prediction."""

    x: float  # [m]
    y: float  # [m]
    yaw: float  # [rad]
    a: float = 0.0  # [rad/m] turn arm along the body's x and y
    b: float = 0.0
    slip: float = 0.0

    def after(self, advance: Advance) -> Mean:
        """The mean after a predicted motion."""
        wx, wy = advance.tip
        c = math.cos(self.yaw)
        s = math.sin(self.yaw)
        turn = advance.turn + self.a * (c * wy - s * wx) - self.b * (c * wx + s * wy)
        kept = 1.0 - self.slip
        return Mean(
            self.x + kept * wx,
            self.y + kept * wy,
            self.yaw + kept * turn,
            self.a,
            self.b,
            self.slip,
        )


class FilterState(NamedTuple):
    """State of the filter between ticks."""

    pose: StampedPose  # the last picture, used or not
    used: float  # [s] stamp of the last one that was used
    mean: Mean  # at that time
    covariance: Array  # (6, 6) the same
    present: Mean  # now
    advances: tuple[Advance, ...] = ()  # since then
    strangers: tuple[Pose2, ...] = ()  # the last pictures, if they do not fit


@dataclass(frozen=True)
class PoseFilter:
    """Filter of the pose of one object through one camera."""

    point: Point  # [m] p_GC
    radius: float  # [m] of the object
    noise: Array  # (3,) standard deviations of a picture's x, y [m] and yaw [rad]
    arm: Point = (0.0, 0.0)  # [rad/m] turn arm as believed
    doubt: float = 0.0  # [rad/m] standard deviation of the turn arm from the belief

    @classmethod
    def for_sensing(
        cls,
        sensing: Sensing,
        point: Point,
        radius: float,
        arm: Point = (0.0, 0.0),
        doubt: float = 0.0,
    ) -> PoseFilter:
        """Filter for the camera of ``sensing``."""
        pictures = sensing.noise_time * (sensing.pose_rate or 100.0)
        correlated = math.sqrt(1.0 + 2.0 * pictures)
        place = correlated * max(sensing.position_noise, LEAST_NOISE)
        yaw = correlated * max(sensing.yaw_noise, LEAST_YAW_NOISE)
        return cls(point, radius, np.array((place, place, yaw)), arm, doubt)

    def start(self, pose: StampedPose) -> FilterState:
        """State with the object at ``pose``, the middle of its pictures."""
        mean = self._mean_at(pose.X_WG)
        prior = self._prior(pose.X_WG, pose.pictures)
        return FilterState(pose, pose.time, mean, prior, mean)

    def pose(self, mean: Mean) -> Pose2:
        """X_WG of a ``mean``."""
        x, y = Pose2(0.0, 0.0, mean.yaw).rotate(self.point)
        return Pose2(mean.x - x, mean.y - y, mean.yaw)

    def spread(self, state: FilterState) -> tuple[float, float]:
        """Standard deviations [m], [rad] of the place of G and of the yaw."""
        lx, ly = Pose2(0.0, 0.0, state.mean.yaw).rotate(self.point)
        H = _jacobian(lx, ly)
        P = H @ state.covariance @ H.T
        return math.sqrt(0.5 * float(P[0, 0] + P[1, 1])), math.sqrt(float(P[2, 2]))

    def line(self, state: FilterState) -> tuple[float, float]:
        """Direction [rad] in G from the centre of friction to C, and its standard
        deviation.
        """
        a, b = state.mean.a, state.mean.b
        size = math.hypot(a, b)
        if size == 0.0:
            return 0.0, math.inf
        across = np.array((-b, a)) / size
        variance = float(across @ state.covariance[3:5, 3:5] @ across)
        return math.atan2(b, a), math.sqrt(variance) / size

    def reach(self, state: FilterState) -> tuple[float, float]:
        """Distance [m] from C to the point that moves along the line from C to the
        centre of friction, however the object turns, and its standard deviation.
        """
        a, b = state.mean.a, state.mean.b
        size = math.hypot(a, b)
        if size == 0.0:
            return math.inf, math.inf
        along = np.array((a, b)) / size
        variance = float(along @ state.covariance[3:5, 3:5] @ along)
        return 1.0 / size, math.sqrt(variance) / (size * size)

    def rescaled(self, state: FilterState, angle: float, scale: float) -> FilterState:
        """The ``state`` of an object that is moved in another direction from now on: its
        turn arm is turned by an ``angle`` [rad] and multiplied by ``scale``.

        The arm is less certain by as much as it changes.
        """
        c = scale * math.cos(angle)
        s = scale * math.sin(angle)
        a, b = state.mean.a, state.mean.b
        turned = (c * a - s * b, s * a + c * b)
        P = state.covariance.copy()
        P[3, 3] += (CHANGED * (turned[0] - a)) ** 2
        P[4, 4] += (CHANGED * (turned[1] - b)) ** 2
        return state._replace(
            mean=state.mean._replace(a=turned[0], b=turned[1]),
            present=state.present._replace(a=turned[0], b=turned[1]),
            covariance=P,
        )

    def step(
        self, state: FilterState, advance: Advance, picture: StampedPose | None
    ) -> FilterState:
        """State after a tick, and after a ``picture`` if one has arrived.

        A picture that is not newer than the last one used, or equal to the last one, is
        no news.
        """
        advances = (*state.advances, advance)
        present = state.present.after(advance)
        state = state._replace(advances=advances, present=present)
        if picture is None or picture.time <= state.used:
            return state
        frozen = picture.X_WG == state.pose.X_WG
        state = state._replace(pose=picture)
        return state if frozen else self._corrected(state, picture)

    def _corrected(self, state: FilterState, picture: StampedPose) -> FilterState:
        """State after a picture that is used, or remembered as one that does not fit."""
        before = [one for one in state.advances if one.time <= picture.time + 1e-9]
        after = state.advances[len(before) :]
        mean, P = self._predicted(state.mean, state.covariance, before)
        X = picture.X_WG
        lx, ly = Pose2(0.0, 0.0, mean.yaw).rotate(self.point)
        H = _jacobian(lx, ly)
        expected = self.pose(mean)
        error = np.array(
            (X.x - expected.x, X.y - expected.y, wrap_angle(X.yaw - expected.yaw))
        )
        S = H @ P @ H.T + np.diag(self.noise**2)
        if float(error @ np.linalg.solve(S, error)) > GATE:
            return self._doubted(state, picture, after)
        gain = np.linalg.solve(S, H @ P).T
        corrected = Mean(*(np.array(mean) + gain @ error).tolist())
        P = P - gain @ S @ gain.T
        return state._replace(
            used=picture.time,
            mean=corrected,
            covariance=0.5 * (P + P.T),
            present=_led(corrected, after),
            advances=after,
            strangers=(),
        )

    def _doubted(
        self, state: FilterState, picture: StampedPose, after: tuple[Advance, ...]
    ) -> FilterState:
        """State after a picture that does not fit."""
        X = picture.X_WG
        wide = 6.0 * self.noise + np.array((0.01, 0.01, math.radians(5.0)))
        strangers = (*state.strangers, X)
        for other in state.strangers:
            off = (X.x - other.x, X.y - other.y, wrap_angle(X.yaw - other.yaw))
            if (np.abs(off) > wide).any():
                strangers = (X,)
        if len(strangers) < STRANGERS:
            return state._replace(strangers=strangers)
        mean = self._mean_at(X)._replace(a=state.mean.a, b=state.mean.b)
        return FilterState(
            picture,
            picture.time,
            mean,
            self._prior(X, 1),
            _led(mean, after),
            after,
        )

    def _predicted(
        self, mean: Mean, P: Array, advances: list[Advance]
    ) -> tuple[Mean, Array]:
        """Mean and covariance after ``advances``."""
        x = 0.0
        y = 0.0
        path = 0.0
        now = mean
        for one in advances:
            dx, dy = Pose2(0.0, 0.0, now.yaw).unrotate(one.tip)
            x += dx
            y += dy
            path += math.hypot(dx, dy)
            now = now.after(one)
        kept = 1.0 - mean.slip
        F = np.eye(6)
        F[:3, 5] = (mean.x - now.x, mean.y - now.y, mean.yaw - now.yaw)
        F[:3, 5] /= kept
        F[2, 2] -= kept * (mean.a * x + mean.b * y)
        F[2, 3:5] = (kept * y, -kept * x)
        grown = np.diag(self._growth(advances, path))
        out: Array = F @ P @ F.T + grown
        return now, out

    def _growth(self, advances: list[Advance], path: float) -> Array:
        """Growth (6,) of the variances over ``advances``, along a ``path`` [m]."""
        growth = np.zeros(6)
        for one in advances:
            place, yaw = DISTURBED if one.disturbed else STILL
            growth[:2] += place * place * one.dt
            growth[2] += yaw * yaw * one.dt
        place, yaw = SLIPPED
        growth[:2] += place * place * path
        growth[2] += yaw * yaw * path
        growth[3:5] = (ARM / self.radius) ** 2 * path / ARM_LENGTH
        growth[5] = SLIP * SLIP * path / SLIP_LENGTH
        return growth

    def _mean_at(self, X_WG: Pose2) -> Mean:
        x, y = X_WG.apply(self.point)
        return Mean(x, y, X_WG.yaw, *self.arm)

    def _prior(self, X_WG: Pose2, pictures: int) -> Array:
        """Covariance (6, 6) after a number of ``pictures`` of an object at rest."""
        lx, ly = X_WG.rotate(self.point)
        to_C = np.array(((1.0, 0.0, -ly), (0.0, 1.0, lx), (0.0, 0.0, 1.0)))
        P = np.zeros((6, 6))
        P[:3, :3] = to_C @ np.diag(self.noise**2 / pictures) @ to_C.T
        P[3, 3] = P[4, 4] = (ARM / self.radius) ** 2 + self.doubt * self.doubt
        P[5, 5] = SLIP * SLIP
        return P


def _jacobian(lx: float, ly: float) -> Array:
    """Derivative (3, 6) of G's pose with respect to the state.

    C is at ``lx``, ``ly`` [m] from G, in world axes.
    """
    H = np.zeros((3, 6))
    H[0, 0] = H[1, 1] = H[2, 2] = 1.0
    H[0, 2] = ly
    H[1, 2] = -lx
    return H


def _led(mean: Mean, advances: list[Advance] | tuple[Advance, ...]) -> Mean:
    for advance in advances:
        mean = mean.after(advance)
    return mean
