"""Joint paths of arms, from one placement to the next."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.paths.approach import led_in
from pushpressslide.arms.paths.capsules import least_distance
from pushpressslide.arms.paths.clearance import LOOK
from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.arms.paths.library import ArmLibrary
from pushpressslide.arms.paths.placements import PlacementPaths
from pushpressslide.control.spacing import Spacing
from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.task import Robot
from pushpressslide.planning.free_space import Bounds


class ArmPlacements:
    """A ``control.cell.Placements`` based on the search for joint paths."""

    def __init__(
        self,
        library: ArmLibrary,
        arms: Sequence[JointArm],
        paths: Sequence[tuple[ArmPath, ...]],
        within: Bounds | None = None,
    ) -> None:
        """Move ``arms`` along ``paths``, which hold one path per arm for each
        placement.

        ``within`` [m] bounds the region of the object: x_min, x_max, y_min, y_max.
        """
        self._library = library
        self._arms = arms
        self._within = within
        self._prepared = PlacementPaths(library)  # of what is ahead
        self._prepared.paths = list(paths)
        self._ahead = self._prepared  # before the last planner was prepared

    def begin_placement(
        self, query: MotionQuery, postures: Sequence[Array] | None = None
    ) -> None:
        """Give the arms the joint paths of the next placement of ``query``. Arms in
        ``postures`` (n,) [rad] first move to the start of these paths.
        """
        taken = self._prepared.paths.pop(0)
        paths = [path for path, _ in taken]
        if postures is not None:
            facts = [arm.model.facts for arm in self._arms]
            paths = led_in(paths, facts, postures)
        period = query.motion.control_period
        frame = query.scene.support.frame
        for arm, path, (_, attitude) in zip(self._arms, paths, taken, strict=True):
            arm.follow(path, attitude, period, frame)

    def spacing(self, robots: Sequence[Robot]) -> Spacing | None:
        """Distance between the arms of ``robots``. None of a single one."""
        if len(robots) < 2:
            return None
        outlines = [self._library.capsules(one, i) for i, one in enumerate(robots)]

        def distance(postures: Sequence[Array]) -> float:
            arms = zip(outlines, (q[None] for q in postures), strict=True)
            return min(
                least_distance(one, other, q, its, LOOK)
                for (one, q), (other, its) in combinations(arms, 2)
            )

        return distance

    def prepare(self) -> PlacementPaths:
        """Empty planner of placements and joint paths that starts from the last
        measured postures.
        """
        self._prepared = PlacementPaths(
            self._library, postures=self._postures(), within=self._within
        )
        return self._prepared

    def restore(self) -> None:
        """Go on with the joint paths that no prepared planner has replaced."""
        self._prepared = self._ahead

    def hand_over(self, placement: Plan, kept_arms: frozenset[int]) -> None:
        """Take the next joint paths, from the last measured postures."""
        self._ahead = self._prepared
        self.begin_placement(placement.query, self._postures())

    def _postures(self) -> tuple[Array, ...]:
        return tuple(arm.state.q for arm in self._arms)
