"""Identification on the way: where the centre of mass of an object is that one contact
moves, across the line to the contact.

From measured poses and the measured contact force alone (docs/mechanics.md, section 2).
A force turns the object by its moment about the centre of pressure. With the unit force
e at p, the turn rate w and the velocity v of the centre of pressure,

    cross(p - c, e) = R w / (v . e),

c the CoM and R = rho^2 N / N_o, which the plan knows. That says where c is across the
line from p; along it, another c and another R turn the object alike.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.twist_path import screw
from pushpressslide.identification.online import LEAST_SPEED, WINDOW
from pushpressslide.mechanics.turning import Turning

WINDOWS = 40  # that are remembered
GRID = 4  # places to either side that are tried
FINER = 0.3  # reach of a grid over that of the one before
PASSES = 5
# What the prediction weighs, in windows that were seen: a window is right to some 0.03
# of the lever, R to 0.2, the believed centre to 0.1 of the object's inner radius
PRIOR = 0.1
PRIOR_R = 0.02
BOUND = 0.5  # of the lever, that the centre is at most found to be off


class Window(NamedTuple):
    """What was seen in a window, in B."""

    contact: Point  # [m]
    force: Point  # unit vector
    twist: tuple[float, float, float]  # [m/s], [rad/s] about the origin


class CenterState(NamedTuple):
    """The windows so far, and the one that is being filled."""

    center: Point = (0.0, 0.0)  # p_BCom [m] as identified
    windows: tuple[Window, ...] = ()
    slides: bool = False  # whether the object slid in the window before
    pose: Pose2 | None = None  # X_WB at the window's start
    time: float = 0.0  # [s] of its start
    force: Point = (0.0, 0.0)  # [N] summed over its ticks, in B

    known: float = 0.0  # [1/rad^2] what windows of segments before weigh
    before: Point = (0.0, 0.0)  # the centre at the end of the segment before


class CenterIdentifier(ABC):
    """What identifies the CoM from windows; its state goes in and out."""

    def step(
        self,
        state: CenterState,
        time: float,
        X_WB: Pose2,
        force: Point,
        contact: Point,
    ) -> CenterState:
        """Return the next state after a tick.

        ``force`` [N] is that of the tip on the object, along the support, at ``contact``
        [m], both in B.
        """
        if state.pose is None:
            return state._replace(pose=X_WB, time=time, force=(0.0, 0.0))
        fx = state.force[0] + force[0]
        fy = state.force[1] + force[1]
        span = time - state.time
        if span < WINDOW:
            return state._replace(force=(fx, fy))
        vx, vy, w = (value / span for value in screw(state.pose, X_WB))
        size = math.hypot(fx, fy)
        power = 0.0
        if size > 0.0:
            x, y = self._slider(state, contact)
            power = ((vx - w * y) * fx + (vy + w * x) * fy) / size
        slides = power > LEAST_SPEED
        fresh = state._replace(pose=X_WB, time=time, force=(0.0, 0.0), slides=slides)
        # in the first one the force has yet to turn to where it drives
        if not (slides and state.slides):
            return fresh
        seen = Window(contact, (fx / size, fy / size), (vx, vy, w))
        windows = (*state.windows[1 - WINDOWS :], seen)
        return fresh._replace(windows=windows, center=self._fit(state, windows))

    @abstractmethod
    def onward(self, state: CenterState) -> CenterState:
        """Return what stays known when a segment ends."""

    @abstractmethod
    def _slider(self, state: CenterState, contact: Point) -> Point:
        """Return the point in B [m] whose motion along the force says that the object
        slides.
        """

    @abstractmethod
    def _fit(self, state: CenterState, windows: Sequence[Window]) -> Point:
        """Return p_BCom [m] that fits ``windows`` best."""


class PushedCenter(CenterIdentifier):
    """Of a pushed object: least squares about a prediction.

    Besides the centre a factor on R is unknown, which a model has wrong.
    """

    def __init__(
        self, across: Point, lever: float, turning: Turning, size: float
    ) -> None:
        """Bind to a contact ``lever`` [m] from the believed CoM; ``across`` is the unit
        vector in B across the line between them, ``size`` [m] the object's inner radius.
        """
        self._lever = lever
        self._turning = turning
        self._size = size
        self._grid = np.outer(np.linspace(-1.0, 1.0, 2 * GRID + 1), across)

    def onward(self, state: CenterState) -> CenterState:
        """Return what stays known when a segment ends."""
        return CenterState(state.center, state.windows)

    def _slider(self, state: CenterState, contact: Point) -> Point:
        return state.center

    def _fit(self, state: CenterState, windows: Sequence[Window]) -> Point:
        """Return the best of a grid, of finer ones about the best place of the one
        before.
        """
        best = np.zeros(2)
        most = BOUND * self._lever
        reach = most
        for _ in range(PASSES):
            places = best + reach * self._grid
            places = places[np.hypot(places[:, 0], places[:, 1]) <= most + 1e-12]
            best = places[np.argmin(self._misfit(windows, places))]
            reach = FINER * reach
        return (float(best[0]), float(best[1]))

    def _misfit(self, windows: Sequence[Window], places: Array) -> Array:
        """Return how badly a centre at each of ``places`` (m, 2) [m] fits, with the
        factor on R that fits it best.
        """
        contacts, forces, twists = zip(*windows, strict=True)
        ex, ey = np.array(forces).T
        vx, vy, w = np.array(twists).T
        x, y = np.array(contacts).T
        cx, cy = (part[:, None] for part in places.T)
        rx = x - cx
        ry = y - cy
        speed = (vx - w * cy) * ex + (vy + w * cx) * ey
        moment = rx * ey - ry * ex
        angle = np.arctan2(moment, rx * ex + ry * ey)
        turned = self._turned(angle) * w / np.maximum(speed, LEAST_SPEED)
        off = moment / self._lever - turned
        share = (off * turned).sum(1) / ((turned * turned).sum(1) + PRIOR_R)
        rest = off - share[:, None] * turned
        far = np.hypot(cx, cy)[:, 0] / self._size
        misfit = (rest * rest).sum(1) + PRIOR_R * share**2 + PRIOR * far**2
        return np.asarray(misfit)

    def _turned(self, angle: Array) -> Array:
        """Return R over the lever at force angles [rad]."""
        found = np.interp(
            angle, self._turning.angles, self._turning.values, period=2.0 * math.pi
        )
        return np.asarray(found / self._lever)
