"""Opacity of each arm in pictures of a run. An arm that hides a contact or a goal from
the camera becomes transparent.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.systems.framework import Context
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import PHASES, Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Shape
from pushpressslide.view.drake.playback import Playback
from pushpressslide.view.drake.sight import Limb, Moment, hidden_by_arms
from pushpressslide.view.drake.subject import (
    LINK_RADIUS,
    contacts_at,
    limbs_of_arm,
    tips_at,
)

FAINT = 0.25  # opacity of an arm that is seen through
RATE = 20.0  # [1/s] at which lines of sight are checked
# [s] before and after a point is hidden, in which the arm is faint too: what is hidden
# again and again does not flicker
HOLD = 0.4
SOFTEN = 0.3  # [s] of a change of opacity
SHARE = 0.3  # of a goal's points, from which on it is hidden
FLANGE = 0.11  # [m] of the last joint's body towards the tip
TOUCHING = tuple(map(PHASES.index, ("touch", "move")))

Target = tuple[Vector3, ...]
"""Points [m] of a contact, or of a goal, that are hidden together."""


class ArmOpacity:
    """Opacity of each arm over a run, for a camera at rest."""

    def __init__(self, playback: Playback, position: Array) -> None:
        """Check the lines of sight to a camera at ``position`` (3,) [m] in the world."""
        self._time = playback.record.arrays["time"]
        start, end = float(self._time[0]), float(self._time[-1])
        self._grid = np.arange(start, end + 1.0 / RATE, 1.0 / RATE)
        ticks = playback.ticks_at(self._grid)
        frame = playback.task.support.frame
        x, y, z = map(float, position)
        eye = np.array(frame.coordinates((x, y, z)))
        goals = goal_targets(playback.goals)
        arms = range(len(playback.scene.robots))
        context = playback.scene.plant.CreateDefaultContext()
        rows = []
        for tick in ticks:
            playback.set_plant(context, tick)
            targets = [*goals, *contact_targets(playback, tick)]
            links = [links_of_arm(playback, context, arm) for arm in arms]
            rows.append([hides(link, targets, eye) for link in links])
        self._opacity = smooth_opacity(np.array(rows, dtype=float))

    def of_tick(self, tick: int) -> tuple[float, ...]:
        """Opacity of each arm at a tick, up to 1."""
        time = float(self._time[tick])
        columns = self._opacity.T
        return tuple(float(np.interp(time, self._grid, row)) for row in columns)


def links_of_arm(playback: Playback, context: Context, arm: int) -> Moment:
    """Links of an arm that may hide something. Of the tip's rod only the flange is
    included.
    """
    *links, rod = limbs_of_arm(playback, context, arm)
    start = np.array(rod.start)
    along = np.array(rod.end) - start
    share = min(1.0, FLANGE / max(float(np.linalg.norm(along)), 1e-9))
    x, y, z = (start + share * along).tolist()
    return Moment((), (), (*links, Limb(rod.start, (x, y, z), LINK_RADIUS)))


def goal_targets(goals: Sequence[tuple[Shape, Pose2]]) -> list[Target]:
    """Points on the support of each goal: its corners and its centre."""
    targets = []
    for shape, X_WG in goals:
        outline = shape.outline()
        corners = outline[:: max(1, len(outline) // 8)]
        points = [X_WG.apply(corner) for corner in (*corners, (0.0, 0.0))]
        targets.append(tuple((x, y, 0.0) for x, y in points))
    return targets


def contact_targets(playback: Playback, tick: int) -> list[Target]:
    """Tips in contact at ``tick``."""
    if playback.record.arrays["phase"][tick] not in TOUCHING:
        return []
    return [(tip,) for tip in tips_at(playback, tick, contacts_at(playback, tick))]


def hides(arm: Moment, targets: Sequence[Target], eye: Array) -> bool:
    """Whether an arm hides one of the ``targets`` from a camera at ``eye`` (3,) [m]."""
    shares = (float(hidden_by_arms(arm, np.array(t), eye).mean()) for t in targets)
    return any(share > SHARE for share in shares)


def smooth_opacity(hidden: Array) -> Array:
    """Opacity (K, A) of arms over time. It falls, at ``RATE``, where ``hidden`` (K, A)
    is 1.
    """
    held = maximum_filter1d(hidden, 2 * round(HOLD * RATE) + 1, axis=0)
    soft = uniform_filter1d(held, round(SOFTEN * RATE), axis=0, mode="nearest")
    return np.asarray(1.0 - (1.0 - FAINT) * soft)
