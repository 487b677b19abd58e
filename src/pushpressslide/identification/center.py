"""Online identification of the centre of mass of an object moved by one contact. Only
its coordinate across the line to the contact is identified (docs/mechanics.md, sections
2 to 4).

Only measured poses are used. In any turn, the virtual axle has no velocity across the
heading. If the centre of mass is displaced, the line from it to the contact is turned
by an angle u, and the heading and the whole pattern of motions are turned with it. With
the velocity of B's origin along and across the planned heading, the turn rate w, and
the axle's coordinate a on the heading,
    across = tan(u) along - a w.
Straight motion determines u, without forces or a model of the friction. A turn
determines a if u is known, or u as accurately as a is known.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from pushpressslide.core import margins
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import screw
from pushpressslide.identification.online import LEAST_SPEED, WINDOW

WINDOWS = 40  # number of remembered windows
# [rad] prior uncertainty of the line to the contact if the belief states none
HEADING = 0.15
# error of a turn's axle with a true belief, as a share of its distance from the centre
# of pressure
AXLE = 0.2
WINDOW_HEADING = 0.05  # [rad] error of a window's heading: the noise of poses
# of what a turn moves B's origin across, that the axle itself slips by: on the exact
# surface it lies off the line to the contact where the force is at a large angle
AXLE_SLIP = 0.3
SEGMENT = 0.05  # [rad] error of a whole segment's heading
# largest identified displacement of the centre if the belief states no uncertainty, as
# a share of the lever
BOUND = 0.5

Row = tuple[float, float, float]  # of u, of a, and what they add up to


# standard deviations by which the centre is elsewhere, before it counts against a belief
SURE = 2.0


class Doubt(NamedTuple):
    """Standard deviations of the parameters used to plan a segment."""

    heading: float = HEADING  # [rad] of the line to the contact
    axle: float = 0.0  # [m] of the virtual axle's place on the heading
    # [rad] above which the centre counts as displaced
    off_line: float = margins.ARM.off_line
    # largest identified displacement of the centre, as a share of the lever
    max_share: float = BOUND
    # standard deviations that it has to be elsewhere by: a belief that says that it is
    # unsure is given up for less
    sure: float = SURE


def doubt(
    scene: Scene, contact: Point, lever: float, reach: float, height: float
) -> Doubt:
    """Uncertainty of a plan with a ``contact`` [m] in B, at ``height`` [m] above the
    base.

    The ``lever`` [m] is that of the contact about the centre of pressure, and ``reach``
    [m] is the distance from there to the axle. The lever changes with an error of the
    centre of mass along the line, and with an error of the friction, through the moment
    of the drag.
    """
    distance = math.hypot(*contact)
    drag = scene.friction_error * scene.support.friction * height
    axle = AXLE
    if lever > 0.0:
        axle += scene.center_error / distance + drag / lever
    if scene.center_error == 0.0:
        return Doubt(axle=axle * reach)
    heading = scene.center_error / distance
    most = min(BOUND, math.sqrt(2.0) * heading)
    return Doubt(heading, axle * reach, margins.ARM.off_line_unsure, most, 0.0)


TOUCHED = 1e-3
"""Standard deviation [m] of the touched place, beside noise: errors of tip and base."""
LEARNT = 0.7
"""Largest standard deviation of an identified line, as a share of that of the belief."""
BOUNDED = 0.3
"""Standard deviation of a displacement at its bound, as a share of the lever."""
LEAST_WINDOWS = 5
"""Smallest number of windows that give the centre an interval."""


class Aside(NamedTuple):
    """Identified coordinate of the centre of mass across the line to the contact."""

    value: float  # [m] from B's origin
    deviation: float  # [m] standard deviation
    across: Point  # direction in B
    at_bound: bool = False  # the centre may be farther off


class Window(NamedTuple):
    """Measured motion of the object during a time window, in B."""

    contact: Point  # [m]
    twist: tuple[float, float, float]  # [m/s], [rad/s] about the origin


class CenterState(NamedTuple):
    """Completed time windows, and the one being filled."""

    center: Point = (0.0, 0.0)  # p_BCom [m] as identified
    windows: tuple[Window, ...] = ()
    slides: bool = False  # whether the object slid in the window before
    pose: Pose2 | None = None  # X_WB at the window's start
    time: float = 0.0  # [s] of its start
    force: Point = (0.0, 0.0)  # [N] summed over its ticks, in B
    off: float = math.inf  # [rad] standard deviation of the line to the contact
    known: float = 0.0  # [1/rad^2] weight of the windows of previous segments
    before: Point = (0.0, 0.0)  # the centre at the end of the segment before
    filtered: bool = False  # whether it is that of a filter of the pose


class CenterIdentifier:
    """Least-squares estimate of heading and axle near a prediction, for one segment."""

    def __init__(
        self,
        X_BV: Pose2,
        contact: Point,
        center: Point,
        doubt: Doubt,
        window: float = WINDOW,
    ) -> None:
        """Bind to a segment planned with its axle at ``X_BV``, for a ``contact`` and a
        ``center`` of mass [m] in B.

        Each twist is measured over a ``window`` [s].
        """
        self._off_line = doubt.off_line
        self._window = window
        lever = math.hypot(*contact)
        self._lever = lever
        self._across = (-contact[1] / lever, contact[0] / lever)
        self._planned = self._aside(center)
        self._heading = (math.cos(X_BV.yaw), math.sin(X_BV.yaw))
        self._axle = X_BV.x * self._heading[0] + X_BV.y * self._heading[1]
        self._spread = doubt.axle
        self._prior = 1.0 / doubt.heading**2
        self._most = doubt.max_share
        self._sure = doubt.sure

    def step(
        self,
        state: CenterState,
        time: float,
        X_WB: Pose2,
        force: Point,
        contact: Point,
    ) -> CenterState:
        """Next state after a tick.

        ``force`` [N] is that of the tip on the object, along the support, at
        ``contact`` [m], both in B.
        """
        if state.pose is None:
            return state._replace(pose=X_WB, time=time, force=(0.0, 0.0))
        fx = state.force[0] + force[0]
        fy = state.force[1] + force[1]
        span = time - state.time
        if span < self._window:
            return state._replace(force=(fx, fy))
        vx, vy, w = (value / span for value in screw(state.pose, X_WB))
        size = math.hypot(fx, fy)
        power = 0.0
        if size > 0.0:
            x, y = contact
            power = ((vx - w * y) * fx + (vy + w * x) * fy) / size
        slides = power > LEAST_SPEED
        fresh = state._replace(pose=X_WB, time=time, force=(0.0, 0.0), slides=slides)
        # in the first one the force has yet to turn to where it drives
        if not (slides and state.slides):
            return fresh
        seen = Window(contact, (vx, vy, w))
        windows = (*state.windows[1 - WINDOWS :], seen)
        center, off = self._fit(state, windows)
        return fresh._replace(windows=windows, center=center, off=off)

    def contradicts(self, state: CenterState, followed: Point) -> bool:
        """Whether the identified centre differs from ``followed`` [m] by more than its
        uncertainty.
        """
        aside = math.dist(state.center, followed) / self._lever
        sure = max(self._sure, 1.0) if state.filtered else self._sure
        return aside > max(self._off_line, sure * state.off)

    def aside(self, state: CenterState) -> Aside | None:
        """The identified coordinate. None if few windows or nothing but the belief
        determine it. A bound tells little more than the side.
        """
        value = self._aside(state.center)
        seen = state.filtered or len(state.windows) >= LEAST_WINDOWS
        if not seen or state.off > LEARNT / math.sqrt(self._prior):
            return None
        deviation = math.hypot(state.off * self._lever, TOUCHED)
        at_bound = abs(value) > 0.99 * self._most * self._lever
        if at_bound:
            deviation = math.hypot(deviation, BOUNDED * self._lever)
        return Aside(value, deviation, self._across, at_bound)

    def carry_over(self, state: CenterState) -> CenterState:
        """State that remains valid after the end of a segment."""
        known = state.known
        if state.windows:
            straight, mixed, turned, _, _ = self._sums(state.windows, state)
            weight = straight - mixed * mixed / turned - self._prior - known
            known += weight / (1.0 + weight * SEGMENT**2)
        return CenterState(state.center, known=known, before=state.center)

    def _aside(self, point: Point) -> float:
        """Distance [m] of ``point`` across the line to the contact."""
        return point[0] * self._across[0] + point[1] * self._across[1]

    def _fit(
        self, state: CenterState, windows: Sequence[Window]
    ) -> tuple[Point, float]:
        """Estimated p_BCom [m], and its standard deviation as an angle [rad].

        The estimate lies on the line through B's origin perpendicular to the line from
        there to the contact.
        """
        straight, mixed, turned, seen, seen_turned = self._sums(windows, state)
        weight = straight * turned - mixed * mixed
        u = (turned * seen - mixed * seen_turned) / weight
        across = self._lever * min(max(u, -self._most), self._most)
        center = (across * self._across[0], across * self._across[1])
        return center, math.sqrt(turned / weight)

    def _sums(
        self, windows: Sequence[Window], state: CenterState
    ) -> tuple[float, float, float, float, float]:
        """Normal equations for two unknowns: the centre's offset divided by the lever,
        and the axle's offset divided by its believed standard deviation.
        """
        before = self._aside(state.before) / self._lever
        straight = self._prior + state.known
        seen = state.known * before
        mixed = 0.0
        turned = 1.0
        seen_turned = 0.0
        for window in windows:
            u, a, off = self._row(window)
            straight += u * u
            mixed += u * a
            turned += a * a
            seen += u * off
            seen_turned += a * off
        return straight, mixed, turned, seen, seen_turned

    def _row(self, window: Window) -> Row:
        """Linear equation from one time window, scaled to noise of standard deviation
        1.
        """
        vx, vy, w = window.twist
        ex, ey = self._heading
        along = vx * ex + vy * ey
        across = vy * ex - vx * ey
        size = max(math.hypot(along, across), abs(w) * self._lever)
        noise = WINDOW_HEADING * size + AXLE_SLIP * abs(self._axle * w)
        turned = (self._aside(window.contact) + self._planned) / self._lever
        off = across + self._axle * w - along * turned
        return -along / noise, -self._spread * w / noise, off / noise
