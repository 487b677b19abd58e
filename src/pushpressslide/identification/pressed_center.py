"""Identification on the way: where the centre of mass of a pressed object is, across the
line to the contact, from measured poses alone (docs/mechanics.md, sections 2 and 4).

Whatever turns the object, its virtual axle does not move across its heading. A centre of
mass elsewhere turns the whole pattern of motions with the line from it to the contact,
and with it the heading. With the velocity of B's origin along and across the heading
that is planned, the turn rate w, the axle's place a on the heading and the angle u by
which the line is turned,

    across = tan(u) along - a w.

Straight motion says what u is, with no force and no model of the friction; a turn says
what a is, or u as far as a is known.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.identification.center import CenterIdentifier, CenterState, Window

HEADING = 0.15  # [rad] that the line to the contact may be turned by, before it is seen
# effective wheelbases, that the axle is elsewhere than planned: a centre of mass off
# along the line changes the lever, a friction the drag's moment
AXLE = 0.5
# [rad] that the heading of a window is off: the noise of poses, and the axle's own slip
WINDOW_HEADING = 0.05
KEPT = 0.5  # of what the windows weigh, from one segment to the next
BOUND = 0.5  # of the lever, that the centre is at most found to be off

Row = tuple[float, float, float]  # of u, of a, and what they add up to


class PressedCenter(CenterIdentifier):
    """Least squares for heading and axle about a prediction, for one segment."""

    def __init__(
        self, X_BV: Pose2, effective_wheelbase: float, contact: Point, center: Point
    ) -> None:
        """Bind to a segment that is planned with the axle at ``X_BV`` for a ``contact``
        and a ``center`` of mass [m] in B, with an ``effective_wheelbase`` [m].
        """
        lever = math.hypot(*contact)
        self._lever = lever
        self._across = (-contact[1] / lever, contact[0] / lever)
        self._planned = self._ahead(center)
        self._heading = (math.cos(X_BV.yaw), math.sin(X_BV.yaw))
        self._axle = X_BV.x * self._heading[0] + X_BV.y * self._heading[1]
        self._spread = AXLE * abs(effective_wheelbase)

    def onward(self, state: CenterState) -> CenterState:
        """Return what stays known when a segment ends."""
        weight = state.known
        if state.windows:
            straight, mixed, turned, _, _ = self._sums(state.windows, state)
            weight = straight - mixed * mixed / turned - 1.0 / HEADING**2
        return CenterState(state.center, known=KEPT * weight, before=state.center)

    def _slider(self, state: CenterState, contact: Point) -> Point:
        return contact

    def _ahead(self, point: Point) -> float:
        """Return how far ``point`` is across the line to the contact [m]."""
        return point[0] * self._across[0] + point[1] * self._across[1]

    def _fit(self, state: CenterState, windows: Sequence[Window]) -> Point:
        """Return p_BCom [m], on the line through B across the one to the contact."""
        straight, mixed, turned, seen, seen_turned = self._sums(windows, state)
        u = (turned * seen - mixed * seen_turned) / (straight * turned - mixed * mixed)
        across = self._lever * min(max(u, -BOUND), BOUND)
        return (across * self._across[0], across * self._across[1])

    def _sums(
        self, windows: Sequence[Window], state: CenterState
    ) -> tuple[float, float, float, float, float]:
        """Return the normal equations of the centre's place across, over the lever, and
        of the axle's place, over the spread of what is believed of it.
        """
        before = self._ahead(state.before) / self._lever
        straight = 1.0 / HEADING**2 + state.known
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
        """Return the equation of a window, in units of its noise."""
        vx, vy, w = window.twist
        ex, ey = self._heading
        along = vx * ex + vy * ey
        across = vy * ex - vx * ey
        size = max(math.hypot(along, across), abs(w) * self._lever)
        noise = WINDOW_HEADING * size
        turned = (self._ahead(window.contact) + self._planned) / self._lever
        off = across + self._axle * w - along * turned
        return -along / noise, -self._spread * w / noise, off / noise
