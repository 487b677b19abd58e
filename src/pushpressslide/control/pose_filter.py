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
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pushpressslide.control.hand_eye import HandEye
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
UNLED = (0.01, math.radians(4.0))  # the same while one of several tips feels nothing
# growth with the square root of the tip's path
SLIPPED = (4.5e-3, math.radians(2.2))  # [m], [rad] in 1 m
HAND_EYE = 4e-3
"""Largest standard deviation [m] of where a tip touches from where it was to touch."""
ARM = 0.2
"""Standard deviation of the turn arm, times the radius of the object."""
ARM_LENGTH = 4.0  # [m] of path after which it may be another
CHANGED = 0.3
"""Standard deviation of a planned change of the turn arm, as a share of it."""
SLIP = 0.15
"""Standard deviation of the share of its motion by which a tip slips."""
SLIP_ALONG = 0.03  # the same of a push along its face: it sticks, or slides
SLIP_LENGTH = 0.05  # [m] of path after which it may be another
PUSHED_LENGTH = (
    0.02  # [m] of path after which a touching tip may push the object, or not
)
GATE = 25.0
"""Squared Mahalanobis distance of a picture above which it does not fit (3 degrees of
freedom; exceeded by one in 65,000).
"""
RECENT = 0.9
"""Weight of a picture's error in ``FilterState.errors``, relative to the next one."""
CONTRADICTED = 4.0
"""Standard deviations of the weighted sum of errors from which pictures contradict the
predicted motion.
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
    lets_go: bool = False  # whether they do so since they let go of it
    touching: bool = False  # whether the tip may or may not move it
    unled: bool = False  # whether one of several tips feels no contact
    tips: tuple[Point, ...] = ()  # [m] at its end, of the contacts that drive it

    @property
    def growth(self) -> tuple[float, float]:
        """Growth [m], [rad] of the uncertainty with the square root of time."""
        if self.unled:
            return UNLED
        return DISTURBED if self.disturbed else STILL


class Mean(NamedTuple):
    """Estimated place of C, yaw, and errors of the prediction."""

    x: float  # [m]
    y: float  # [m]
    yaw: float  # [rad]
    a: float = 0.0  # [rad/m] turn arm along the body's x and y
    b: float = 0.0
    slip: float = 0.0
    pushed: float = 0.0  # share of its motion by which a touching tip moves C
    ox: float = 0.0  # [m] of C in G, beside where the tip was to touch
    oy: float = 0.0

    def after(self, advance: Advance, along: Point | None = None) -> Mean:
        """The mean after a predicted motion. A tip slips ``along`` a unit vector in G
        only. None: in any direction, and about C.
        """
        dx, dy = self.displacement(advance)
        turn = advance.turn
        if advance.touching:
            dx *= self.pushed
            dy *= self.pushed
        else:
            sx, sy = slippery((dx, dy), along)
            dx -= self.slip * sx
            dy -= self.slip * sy
            if along is None:
                turn *= 1.0 - self.slip
        wx, wy = Pose2(0.0, 0.0, self.yaw).rotate((dx, dy))
        return self._replace(
            x=self.x + wx,
            y=self.y + wy,
            yaw=self.yaw + turn + self.a * dy - self.b * dx,
        )

    def displacement(self, advance: Advance) -> Point:
        """Displacement (dx, dy) [m] of the tip, in G."""
        return Pose2(0.0, 0.0, self.yaw).unrotate(advance.tip)


def slippery(step: Point, along: Point | None) -> Point:
    """Part of a displacement [m] by which a tip can slip: ``along`` a unit vector, or
    all of it.
    """
    if along is None:
        return step
    share = step[0] * along[0] + step[1] * along[1]
    return share * along[0], share * along[1]


class FilterState(NamedTuple):
    """State of the filter between ticks."""

    pose: StampedPose  # the last picture, used or not
    used: float  # [s] stamp of the last one that was used
    mean: Mean  # at that time
    covariance: Array  # (9, 9) the same
    present: Mean  # now
    advances: tuple[Advance, ...] = ()  # since then
    strangers: tuple[Pose2, ...] = ()  # the last pictures, if they do not fit
    disturbed: bool = False  # whether tips were about to touch, or to let go
    # weighted sums of the last pictures' errors in x, y and yaw, each over its deviation
    errors: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class PoseFilter:
    """Filter of the pose of one object through one camera."""

    point: Point  # [m] p_GC
    radius: float  # [m] of the object
    noise: Array  # (3,) standard deviations of a picture's x, y [m] and yaw [rad]
    arm: Point = (0.0, 0.0)  # [rad/m] turn arm as believed
    # (2, 2) [rad^2/m^2] covariance of the believed turn arm. None: ARM in every direction
    doubt: Array | None = None
    # unit vector in G of the pushed face, along which the tip may slip; None: a press
    along: Point | None = None
    repeats: bool = False  # whether pictures of an object at rest are equal
    # of the tip, once it is corrected by the known offset; None: not known
    hand_eye: HandEye | None = None

    @classmethod
    def for_sensing(
        cls,
        sensing: Sensing,
        point: Point,
        radius: float,
        arm: Point = (0.0, 0.0),
        doubt: Array | None = None,
        along: Point | None = None,
        hand_eye: HandEye | None = None,
    ) -> PoseFilter:
        """Filter for the camera of ``sensing``."""
        pictures = sensing.noise_time * (sensing.pose_rate or 100.0)
        correlated = math.sqrt(1.0 + 2.0 * pictures)
        place = correlated * max(sensing.position_noise, LEAST_NOISE)
        yaw = correlated * max(sensing.yaw_noise, LEAST_YAW_NOISE)
        noise = np.array((place, place, yaw))
        noisy = sensing.position_noise > 0.0 or sensing.yaw_noise > 0.0
        repeats = not noisy or sensing.position_step > 0.0
        return cls(point, radius, noise, arm, doubt, along, repeats, hand_eye)

    def start(self, pose: StampedPose) -> FilterState:
        """State with the object at ``pose``, the middle of its pictures."""
        mean = self._mean_at(pose.X_WG)
        prior = self._prior(pose.X_WG, np.diag(self.noise**2 / pose.pictures))
        return FilterState(pose, pose.time, mean, prior, mean)

    def pose(self, mean: Mean) -> Pose2:
        """X_WG of a ``mean``."""
        x, y = self._arm_of(mean)
        return Pose2(mean.x - x, mean.y - y, mean.yaw)

    def place(self, mean: Mean) -> Point:
        """C [m] in G."""
        return self.point[0] + mean.ox, self.point[1] + mean.oy

    def _arm_of(self, mean: Mean) -> Point:
        """Vector [m] from G to C, in world axes."""
        return Pose2(0.0, 0.0, mean.yaw).rotate(self.place(mean))

    def spread(self, state: FilterState) -> tuple[float, float]:
        """Standard deviations [m], [rad] of the place of G and of the yaw."""
        P = self._pose_covariance(state)
        return math.sqrt(0.5 * float(P[0, 0] + P[1, 1])), math.sqrt(float(P[2, 2]))

    def _pose_covariance(self, state: FilterState) -> Array:
        """Covariance (3, 3) of G's pose."""
        H = _jacobian(self._arm_of(state.mean), state.mean.yaw)
        P: Array = H @ state.covariance @ H.T
        return P

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

    def touch_offset(self, state: FilterState, across: Point) -> tuple[float, float]:
        """Distance [m] along a unit vector in G by which the tip touches beside where
        it was to touch, and its standard deviation.
        """
        u = np.array(across)
        variance = float(u @ self.tip_covariance(state) @ u)
        off = across[0] * state.mean.ox + across[1] * state.mean.oy
        return off, math.sqrt(variance)

    def tip_covariance(self, state: FilterState) -> Array:
        """Covariance (2, 2) [m^2] in G of where the tip touches."""
        return state.covariance[7:, 7:]

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
        R = np.eye(9)
        R[3:5, 3:5] = (
            (math.cos(angle), -math.sin(angle)),
            (math.sin(angle), math.cos(angle)),
        )
        P = R @ state.covariance @ R.T
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

        A picture that is not newer than the last one used is no news, nor is one equal
        to the last one, unless the object has stood still before a camera without noise.
        """
        if advance.disturbed and not state.disturbed:
            state = self._untouched(state, advance.lets_go)
        advances = (*state.advances, advance)
        present = state.present.after(advance, self.along)
        state = state._replace(
            advances=advances, present=present, disturbed=advance.disturbed
        )
        if picture is None or picture.time <= state.used:
            return state
        frozen = picture.X_WG == state.pose.X_WG and (
            not self.repeats or self._has_moved(state)
        )
        state = state._replace(pose=picture)
        return state if frozen else self._corrected(state, picture)

    def _has_moved(self, state: FilterState) -> bool:
        """Whether tips have moved the object by more than a picture's noise since the
        last one that was used.
        """
        x = math.fsum(one.tip[0] for one in state.advances)
        y = math.fsum(one.tip[1] for one in state.advances)
        return math.hypot(x, y) > float(self.noise[0])

    def _corrected(self, state: FilterState, picture: StampedPose) -> FilterState:
        """State after a picture that is used, or remembered as one that does not fit."""
        before = [one for one in state.advances if one.time <= picture.time + 1e-9]
        after = state.advances[len(before) :]
        mean, P = self._predicted(state.mean, state.covariance, before)
        X = picture.X_WG
        H = _jacobian(self._arm_of(mean), mean.yaw)
        expected = self.pose(mean)
        error = np.array(
            (X.x - expected.x, X.y - expected.y, wrap_angle(X.yaw - expected.yaw))
        )
        S = H @ P @ H.T + np.diag(self.noise**2)
        if float(error @ np.linalg.solve(S, error)) > GATE:
            return self._doubted(state, picture, after)
        errors, doubt = _weighed(state.errors, error, S)
        if doubt.any():
            P[:3, :3] += np.diag(doubt)
            S = H @ P @ H.T + np.diag(self.noise**2)
        gain = np.linalg.solve(S, H @ P).T
        corrected = Mean(*(np.array(mean) + gain @ error).tolist())
        P = P - gain @ S @ gain.T
        return state._replace(
            used=picture.time,
            mean=corrected,
            covariance=0.5 * (P + P.T),
            present=self._led(corrected, after),
            advances=after,
            strangers=(),
            errors=errors,
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
            self._prior(X, np.diag(self.noise**2)),
            self._led(mean, after),
            after,
            disturbed=state.disturbed,
        )

    def _predicted(
        self, mean: Mean, P: Array, advances: list[Advance]
    ) -> tuple[Mean, Array]:
        """Mean and covariance after ``advances``."""
        x = 0.0
        y = 0.0
        F = np.eye(9)
        path = 0.0
        now = mean
        for one in advances:
            dx, dy = now.displacement(one)
            path += math.hypot(dx, dy)
            sx, sy = (dx, dy) if one.touching else slippery((dx, dy), self.along)
            wx, wy = Pose2(0.0, 0.0, now.yaw).rotate((sx, sy))
            turn = mean.a * sy - mean.b * sx
            if self.along is None:
                turn += one.turn
            if one.touching:
                F[:3, 6] += (wx, wy, turn)
                x += mean.pushed * dx
                y += mean.pushed * dy
            else:
                F[:3, 5] -= (wx, wy, turn)
                x += dx - mean.slip * sx
                y += dy - mean.slip * sy
            now = now.after(one, self.along)
        F[2, 2] -= mean.a * x + mean.b * y
        F[2, 3:5] = (y, -x)
        grown = np.diag(self._growth(advances, path))
        out: Array = F @ P @ F.T + grown
        return now, out

    def _growth(self, advances: list[Advance], path: float) -> Array:
        """Growth (9,) of the variances over ``advances``, along a ``path`` [m]."""
        growth = np.zeros(9)
        touching = math.fsum(math.hypot(*one.tip) for one in advances if one.touching)
        growth[6] = touching / PUSHED_LENGTH
        for one in advances:
            place, yaw = one.growth
            growth[:2] += place * place * one.dt
            growth[2] += yaw * yaw * one.dt
        place, yaw = SLIPPED
        growth[:2] += place * place * path
        growth[2] += yaw * yaw * path
        growth[3:5] = (ARM / self.radius) ** 2 * path / ARM_LENGTH
        growth[5] = self._slip**2 * path / SLIP_LENGTH
        return growth

    def _led(self, mean: Mean, advances: Sequence[Advance]) -> Mean:
        for advance in advances:
            mean = mean.after(advance, self.along)
        return mean

    @property
    def _tip_deviation(self) -> float:
        """Standard deviation [m] of where the tip touches from where it was to touch: a
        camera with less noise agrees better with the arm.
        """
        return min(HAND_EYE, 2.0 * float(self.noise[0]))

    @property
    def _slip(self) -> float:
        """Standard deviation of the share of its motion by which the tip slips."""
        return SLIP if self.along is None else SLIP_ALONG

    def _mean_at(self, X_WG: Pose2) -> Mean:
        x, y = X_WG.apply(self.point)
        return Mean(x, y, X_WG.yaw, *self.arm)

    def _prior(self, X_WG: Pose2, pose: Array) -> Array:
        """Covariance (9, 9) before a touch, of an object whose pose has the covariance
        ``pose`` (3, 3).
        """
        lx, ly = X_WG.rotate(self.point)
        to_C = np.array(((1.0, 0.0, -ly), (0.0, 1.0, lx), (0.0, 0.0, 1.0)))
        P = np.zeros((9, 9))
        P[:3, :3] = to_C @ pose @ to_C.T
        known = (ARM / self.radius) ** 2 * np.eye(2)
        P[3:5, 3:5] = known if self.doubt is None else self.doubt
        P[5, 5] = self._slip**2
        c, s = X_WG.rotate((1.0, 0.0))
        R = np.array(((c, -s), (s, c)))
        hand_eye = self.hand_eye or HandEye.within(self._tip_deviation)
        offset = hand_eye.covariance_in(X_WG)
        P[:2, 7:] = R @ offset
        P[7:, :2] = P[:2, 7:].T
        P[:2, :2] += R @ offset @ R.T
        P[7:, 7:] = offset
        return P

    def _untouched(self, state: FilterState, lets_go: bool) -> FilterState:
        """The ``state`` before a touch, which places the tip anew, or before the tip
        ``lets_go``.

        A push that touches again may have slid along its face: the turn arm learnt from
        it is discarded.
        """
        means = [self._mean_at(self.pose(one)) for one in (state.mean, state.present)]
        P = self._prior(self.pose(state.mean), self._pose_covariance(state))
        if lets_go or self.along is None:
            arm = {"a": state.mean.a, "b": state.mean.b}
            means = [one._replace(**arm) for one in means]
            P[3:5, 3:5] = state.covariance[3:5, 3:5]
        return state._replace(mean=means[0], present=means[1], covariance=P)


def _weighed(
    before: tuple[float, float, float], error: Array, S: Array
) -> tuple[tuple[float, float, float], Array]:
    """Weighted sums of pictures' errors after one more ``error`` (3,) with covariance
    ``S`` (3, 3), and variances (3,) to add to those of a pose that all of them contradict.

    A contradicted sum starts over.
    """
    deviation = np.sqrt(np.diag(S))
    sums = RECENT * np.array(before) + error / deviation
    contradicted = np.abs(sums) * math.sqrt(1.0 - RECENT * RECENT) > CONTRADICTED
    mean = (1.0 - RECENT) * sums * deviation
    doubt: Array = np.where(contradicted, mean * mean, 0.0)
    x, y, yaw = np.where(contradicted, 0.0, sums).tolist()
    return (x, y, yaw), doubt


def _jacobian(arm: Point, yaw: float) -> Array:
    """Derivative (3, 9) of G's pose with respect to the state.

    C is at ``arm`` [m] from G, in world axes.
    """
    H = np.zeros((3, 9))
    H[0, 0] = H[1, 1] = H[2, 2] = 1.0
    H[0, 2] = arm[1]
    H[1, 2] = -arm[0]
    c = math.cos(yaw)
    s = math.sin(yaw)
    H[0, 7:] = (-c, s)
    H[1, 7:] = (-s, -c)
    return H
