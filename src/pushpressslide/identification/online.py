"""Online identification for one contact: virtual axle, rho, and the drag of the object.

Only measured poses and the measured contact force are used. The axle is the point of
the heading axis (x of the vehicle frame V, through the CoM) that has no velocity across
this axis. Rho follows from the axle's distance to the centre of pressure
(docs/mechanics.md, sections 2 and 4).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.sensing import Sensing
from pushpressslide.core.twist_path import screw

# [s] shortest interval for a twist: short compared with a turn
WINDOW = 0.2
# standard deviations of a pose that the object moves by in a window: the noise of turn
# rates makes an axle look nearer than it is, by its variance over theirs
WINDOW_WAY = 40.0
# [s] of turning that is remembered; old data stay until there are new ones
MEMORY = 1.5
LEAST_TURN = 0.02  # [rad/s] below which a twist says nothing about the axle
# [m/s] speed of the contact below which the force may be too small to slide the object
LEAST_SPEED = 0.01
PRIOR = 0.003  # [rad^2/s^2] weight of the prediction, as an amount of measured turning
ENOUGH = 0.01  # [rad^2/s^2] amount of turning required for a result
BOUND = 6.0  # factor about the prediction that the estimates stay within
# share of the axle's distance by which it has to be off its prediction: the exact
# surface's own change with the force's angle, which the prediction's user takes into
# account, is less
OFF = 0.5
OFF_RHO = 0.1  # the same of an ellipsoid whose rho was given, which may be wrong


def window_of(sensing: Sensing, speed: float, lever: float) -> float:
    """Time window [s] for measuring the twist of a driven object.

    A contact at ``lever`` [m] drives the object at ``speed`` [m/s]; the noise is that
    of ``sensing``.
    """
    noise = max(sensing.position_noise, lever * sensing.yaw_noise)
    return max(WINDOW, WINDOW_WAY * noise / speed)


class AxleEstimate(NamedTuple):
    """Identified values, or the predicted values if nothing has been identified yet."""

    axle: float  # [m] of the virtual axle on the heading axis, from the CoM
    # [m] tan(force angle) per curvature, > 0; rho^2 / d on an ellipsoid
    effective_wheelbase: float
    drag: float  # [N] the force that slides the object straight, mu_s N
    rho: float = math.nan  # [m] of the ellipsoid that turns as was seen


class AxleState(NamedTuple):
    """Sums with forgetting, and the time window being filled."""

    pose: Pose2 | None = None  # X_WB at its start
    time: float = 0.0  # [s] of its start
    # [N] summed over its ticks, along and across the heading axis
    force: Point = (0.0, 0.0)
    ticks: int = 0
    ww: float = 0.0
    vw: float = 0.0
    fw: float = 0.0
    gg: float = 0.0
    rw: float = 0.0  # of rho^2 w^2
    drag: float | None = None  # [N]


class AxleIdentifier:
    """Least squares with forgetting, near a prediction. The caller keeps its state."""

    def __init__(
        self,
        yaw: float,
        predicted: AxleEstimate,
        lever: float,
        stiffness: float | None = None,
        cop: float = 0.0,
        off: float = OFF,
        window: float = WINDOW,
    ) -> None:
        """Bind to the heading axis at ``yaw`` [rad] in B.

        ``lever`` [m] is the contact's signed distance ahead of the centre of pressure
        along that axis; ``cop`` [m] is the coordinate of the centre of pressure on it.
        A contact force at an angle a from the axis is drag / sqrt(1 + stiffness sin^2
        a); by default ``stiffness`` is (d / rho)^2. An axle counts as identified only
        if it differs from its prediction by the fraction ``off`` of its distance. Each
        twist is measured over a ``window`` [s].
        """
        self._window = window
        self._axis = (math.cos(yaw), math.sin(yaw))
        self.predicted = predicted
        self._lever = lever
        self._cop = cop
        self._off = off
        self._sign = math.copysign(1.0, lever)
        self._stiffness = (
            abs(lever) / predicted.effective_wheelbase
            if stiffness is None
            else stiffness
        )

    def step(
        self, state: AxleState, time: float, X_WB: Pose2, force: Point
    ) -> AxleState:
        """Next state after a tick.

        ``force`` [N] is that of the tip on the object, along the support, in B.
        """
        if state.pose is None:
            return state._replace(pose=X_WB, time=time, force=(0.0, 0.0), ticks=0)
        ex, ey = self._axis
        sum_e, sum_t = state.force
        sum_e = sum_e + force[0] * ex + force[1] * ey
        sum_t = sum_t + force[1] * ex - force[0] * ey
        span = time - state.time
        ticks = state.ticks + 1
        if span < self._window:
            return state._replace(force=(sum_e, sum_t), ticks=ticks)
        vx, vy, w = (value / span for value in screw(state.pose, X_WB))
        along = vx * ex + vy * ey
        across = vy * ex - vx * ey
        keep = math.exp(-span / MEMORY)
        ww = state.ww
        vw = state.vw
        fw = state.fw
        gg = state.gg
        rw = state.rw
        drag = state.drag
        size = math.hypot(sum_e, sum_t)
        if abs(w) > LEAST_TURN and size > 0.0:
            ww = keep * ww + w * w
            vw = keep * vw - across * w
            # effective wheelbase times w f_e = f_t v_e
            turned = w * sum_e / size
            fw = keep * fw + self._sign * sum_t / size * along * turned
            gg = keep * gg + turned * turned
            # rho^2 w = (moment about the centre of pressure) (its speed along the
            # force) per force: it may be moved along the force, which changes neither
            power = along * sum_e + (across + w * self._cop) * sum_t
            moment = self._lever * sum_t
            rw = keep * rw + w * moment * power / (size * size)
        if size > 0.0:
            level = (
                size / ticks * math.sqrt(1.0 + self._stiffness * (sum_t / size) ** 2)
            )
            speed = math.hypot(along, across + w * (self._cop + self._lever))
            drag = self._drag(drag, level, keep, speed)
        return AxleState(X_WB, time, (0.0, 0.0), 0, ww, vw, fw, gg, rw, drag)

    def _drag(
        self, before: float | None, level: float, keep: float, speed: float
    ) -> float | None:
        """Drag [N] of the object after a time window.

        In the window the force was ``level`` [N], and the contact moved at ``speed``
        [m/s].
        """
        if speed > LEAST_SPEED:
            return level if before is None else keep * before + (1.0 - keep) * level
        # it rests although it is pushed: what holds it is at least as much
        known = self.predicted.drag if before is None else before
        return level if level > known else before

    def identified(self, state: AxleState) -> AxleEstimate | None:
        """Estimates, within bounds about the prediction. None while they do not
        contradict it, or while the object has turned too little.
        """
        axle, wheelbase, drag, _ = self.predicted
        seen = (state.vw + PRIOR * axle) / (state.ww + PRIOR)
        if state.ww < ENOUGH or abs(seen - axle) < self._off * wheelbase:
            return None
        square = wheelbase * abs(self._lever)
        square = min(
            max((state.rw + PRIOR * square) / (state.ww + PRIOR), square / BOUND),
            square * BOUND,
        )
        turning = (state.fw + PRIOR * wheelbase) / (state.gg + PRIOR)
        return AxleEstimate(
            min(max(seen, axle - BOUND * wheelbase), axle + BOUND * wheelbase),
            min(max(turning, wheelbase / BOUND), wheelbase * BOUND),
            drag
            if state.drag is None
            else min(max(state.drag, drag / BOUND), drag * BOUND),
            math.sqrt(square),
        )
