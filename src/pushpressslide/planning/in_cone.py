"""Paths of at most three constant twists, each within a cone that moves with the body.

As long as the body does not turn, sums of twists stay in a convex cone. A second and a
third twist help because the cone turns with the body: the first twist turns it towards
the goal, and the last one turns the body back to the goal's yaw.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain, islice
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core import margins
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import Ends
from pushpressslide.core.twist_path import TwistPath, TwistRate, reached, screw, screws
from pushpressslide.planning.run_in import longest_way

# lengths of the first and the last piece, in units of the screw to the goal
TRIED = 4  # number of paths in the cone that are evaluated exactly
SHARES = (0.15, 0.3, 0.5, 0.75)


@dataclass(frozen=True, slots=True)
class Inside:
    """Required margins [rad] of a path's twists inside a cone."""

    straight: float  # for a path of one twist
    first: float  # for the first of several twists
    rest: float  # for each later one
    max_sections: int = 3  # largest number of twists


# The preferred first. During the motion the rest is replanned from where the body is, so that
# a last piece with room makes up for a first one along the cone's edge; three pieces
# along the edge seldom end at the goal.
PLANNED = (
    Inside(margins.CONE_MARGIN, margins.BENT_MARGIN, margins.BENT_MARGIN),
    Inside(margins.CONE_MARGIN, margins.CONE_MARGIN, margins.BENT_MARGIN, 2),
    Inside(margins.CONE_MARGIN, margins.CONE_MARGIN, margins.CONE_MARGIN, 2),
)
UNDER_WAY = (
    *PLANNED,
    Inside(margins.REPLAN_MARGIN, margins.REPLAN_MARGIN, margins.REPLAN_MARGIN),
)

Margin = Callable[[TwistRate], float]


class Cone(Protocol):
    """The twists with which the body can be driven."""

    def cone_margin(self, vx: float, vy: float, w: float) -> float:
        """Angle [rad] of a twist from the edge of the cone, regardless of the twist's
        size. Negative outside.
        """
        ...

    def cone_margins(self, twists: NDArray[np.float64]) -> NDArray[np.float64]:
        """``cone_margin`` (m,) of twists (m, 3)."""
        ...

    def rays(self, margin: float) -> list[TwistRate]:
        """Sample of twists around the edge of the cone, each ``margin`` [rad] inside."""
        ...


@dataclass(frozen=True, slots=True)
class ConeGoal:
    """The problem of driving a body from start to goal by twists in a cone."""

    start: Pose2  # X_WB
    goal: Pose2  # X_WB
    radius: float  # [m] weight of turns in the length
    longest: float  # [m] longest allowed path

    @classmethod
    def between(cls, ends: Ends, radius: float) -> ConeGoal:
        """The problem for an object of ``radius`` [m], limited to paths without a loop."""
        longest = longest_way(radius, TwistPath.between(ends, radius).length)
        return cls(*ends, radius, longest)

    @property
    def direct(self) -> TwistRate:
        """The single twist that leads from start to goal."""
        return screw(self.start, self.goal)

    def path(self, cone: Cone, exact: Margin | None = None) -> TwistPath | None:
        """Path by twists well inside ``cone``, or None.

        ``exact`` returns the margin [rad] of a twist, computed with the limit surface
        at that twist. ``cone`` itself uses the limit surface at the direct twist.
        """
        for inside in PLANNED:
            paths = paths_in_cone(
                self.start, self.goal, cone, inside, self.radius, self.longest
            )
            for path in islice(paths, TRIED):
                direct = len(path.sections) == 1
                if exact is None or direct or _inside(path, exact):
                    return path
        return None


def _inside(path: TwistPath, exact: Margin) -> bool:
    return all(exact(rate) >= margins.REPLAN_MARGIN for rate, _ in path.sections)


def resume_path(
    start: Pose2, goal: Pose2, cone: Cone, radius: float, longest: float
) -> TwistPath | None:
    """Shortest path that keeps the planning margin inside the cone, or if there is
    none, the smaller margin of replans.

    None if there is no path with either margin.
    """
    paths = chain.from_iterable(
        paths_in_cone(start, goal, cone, inside, radius, longest)
        for inside in UNDER_WAY
    )
    return next(paths, None)


def paths_in_cone(
    start: Pose2,
    goal: Pose2,
    cone: Cone,
    inside: Inside,
    radius: float,
    longest: float,
) -> Iterator[TwistPath]:
    """Yield paths from ``start`` to ``goal`` whose twists are all ``inside`` the
    ``cone``, the shortest first.

    A path is a screw motion, with a segment along a ray of the cone before it, after
    it, both, or neither. A turn by one radian counts as ``radius`` [m], and no path is
    longer than ``longest`` [m]. The order is deterministic.
    """
    direct = screw(start, goal)
    whole = math.hypot(direct[0], direct[1], radius * direct[2])
    if whole > longest:
        return
    if cone.cone_margin(*direct) >= inside.straight:
        yield TwistPath.between((start, goal), radius)
        return
    scale = np.array([1.0, 1.0, radius])
    first_twists, first_lengths = _edge_pieces(cone, inside.first, whole, scale)
    last_twists, last_lengths = _edge_pieces(cone, inside.rest, whole, scale)
    firsts = reached(start, first_twists)
    lasts = reached(goal, -last_twists)
    middles = screws(firsts, lasts)
    lengths = np.linalg.norm(middles * scale, axis=-1)
    lengths += first_lengths[:, None] + last_lengths
    needed = np.full(lengths.shape, inside.rest)
    needed[0, 1:] = inside.first
    found = cone.cone_margins(middles.reshape(-1, 3)).reshape(lengths.shape)
    lengths[found < needed] = math.inf
    if inside.max_sections < 3:
        lengths[1:, 1:] = math.inf
    for best in np.argsort(lengths, axis=None, kind="stable"):
        i, j = divmod(int(best), len(lasts))
        if not lengths[i, j] < longest:
            return
        middle = (Pose2(*firsts[i].tolist()), Pose2(*lasts[j].tolist()))
        yield TwistPath.between((start, *middle, goal), radius)


def _edge_pieces(
    cone: Cone, margin: float, whole: float, scale: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Twists (k, 3) of segments along the rays of ``cone`` that are ``margin`` [rad]
    inside, and their lengths (k,) [m]. The first segment is empty.

    Lengths are fractions of ``whole`` [m], measured by the norm of a twist times
    ``scale`` (3,).
    """
    rays = np.array(cone.rays(margin)).reshape(-1, 3)
    rays /= np.linalg.norm(rays * scale, axis=1, keepdims=True)
    along = np.repeat(SHARES, len(rays)) * whole
    twists = along[:, None] * np.tile(rays, (len(SHARES), 1))
    return np.concatenate([np.zeros((1, 3)), twists]), np.append(0.0, along)


def least_cone_margin(path: TwistPath, cone: Cone) -> float:
    """Smallest cone margin [rad] of a path's twists."""
    return min((cone.cone_margin(*rate) for rate, _ in path.sections), default=math.inf)


def describe_cone_margin(margin: float, required: float = margins.CONE_MARGIN) -> str:
    """Cone margin and its required value [rad], in words."""
    degrees = math.degrees(margin)
    if margin >= required:
        return f"{degrees:.0f} deg inside the cone"
    side = f"{degrees:.1f} deg inside"
    if margin < 0.0:
        side = f"{-degrees:.0f} deg outside"
    return f"{side} the cone, needed {math.degrees(required):.0f} deg inside"
