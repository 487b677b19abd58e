"""Joint paths of all arms of a plan, with clearance between two arms. If only one arm
has a contact, the other waits out of its way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from pushpressslide.arms.paths.arm_problem import ArmProblem
from pushpressslide.arms.paths.capsules import (
    ArmCapsules,
    least_distance,
    pair_distances,
)
from pushpressslide.arms.paths.clearance import LOOK
from pushpressslide.arms.paths.joint_path import (
    ArmPath,
    Solution,
    first_roomy,
    path_of_move,
    search,
)
from pushpressslide.arms.paths.library import ArmLibrary
from pushpressslide.arms.paths.postures import Miss
from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.planning.side_contacts import room_before
from pushpressslide.robots.continuation import continuation
from pushpressslide.robots.tool import ToolAttitude

Pair = Sequence[Solution]  # one joint path of each arm

# [m] smallest distance between the arms' capsules, which contain the real outline with
# 1 cm to spare
APART = 0.01
# [m] the same along contacts of an object that may leave its plan, where there is room
ROOMY = 0.03
PERIOD = 0.02  # [s] at most, between samples of an approach
GLANCE = 6  # every sixth sample is checked before all of them are
RETREAT_SAMPLES = 7
IN_TURN = 8  # largest number of pairs for which one arm is led around the other
FEW = 16  # joint paths of each arm, in a search over sequences of motions


@dataclass(frozen=True, order=True)
class Conflict:
    """Insufficient clearance between two arms.

    Conflicts compare by ``stage``, then by ``distance``.
    """

    stage: int  # 0: along the contacts; 1: in the approach
    place: str
    distance: float  # [m]


def joint_paths(
    library: ArmLibrary,
    plan: Plan,
    *,
    force: bool = False,
    postures: tuple[Array, ...] | None = None,
    holding: frozenset[int] = frozenset(),
) -> tuple[ArmPath, ...]:
    """Joint path and tool attitude of each arm.

    Two arms keep clear of each other, if necessary by waiting during the approach.
    ``postures`` (n,) [rad] are the arms' present postures, None for their ready
    postures. The arms in ``holding`` already have their contact, and keep it. ``force``
    takes the best paths available. Raises InfeasibleTaskError, with the deciding
    number, if an arm has no path, or two arms come too near to each other.
    """
    starts = postures or (None,) * len(plan.task.robots)
    still = {arm: q for arm, q in enumerate(starts) if arm in holding and q is not None}
    problems = [
        ArmProblem(
            library,
            plan,
            arm,
            start,
            arm in holding,
            {other: q for other, q in still.items() if other != arm},
        )
        for arm, start in enumerate(starts)
    ]
    if len(problems) > 1:
        paths = _TwoArms(plan, problems, force).paths()
    else:
        solution = first_roomy(search(problems[0], force=force)).best(problems[0])
        paths = ((solution.path, solution.move.posture.attitude),)
    return _with_ways_back(problems, paths)


def drawn_back(
    paths: tuple[ArmPath, ...], holding: frozenset[int] = frozenset()
) -> tuple[Array, ...]:
    """Posture (n,) [rad] of each arm after its path, with its tip retreated.

    The arms in ``holding`` keep their contact.
    """
    out = []
    for arm, (path, _) in enumerate(paths):
        route = path.back
        if route is None or arm in holding:
            route = path.move
        out.append(route[-1])
    return tuple(out)


def _with_ways_back(
    problems: Sequence[ArmProblem], paths: tuple[ArmPath, ...]
) -> tuple[ArmPath, ...]:
    """Paths extended by the retreat of each arm.

    A retreat ends before the first sample that the arm cannot follow, or at which it is
    not clear of everything.
    """
    routes = [
        _way_back(problem, path, attitude)
        for problem, (path, attitude) in zip(problems, paths, strict=True)
    ]
    count = min(len(route) for route, _ in routes)
    if len(routes) > 1:
        one, other = map(_capsules, problems)
        (left, _), (right, _) = routes

        def arms_are_separated(i: int) -> bool:
            near = least_distance(one, other, left[i : i + 1], right[i : i + 1], LOOK)
            return near >= APART

        count = _clear_count(arms_are_separated, count)
    out = []
    for problem, (path, attitude), (route, step) in zip(
        problems, paths, routes, strict=True
    ):
        if problem.along is not None:
            path = replace(path, back=route[:count], max_retreat=step * (count - 1))
        out.append((path, attitude))
    return tuple(out)


def _way_back(
    problem: ArmProblem, path: JointPath, attitude: ToolAttitude
) -> tuple[Array, float]:
    """Postures (b, n) of an arm that retreats from its contact, and the distance [m]
    between them.

    The arm retreats until it can follow no further. An arm that waits has the same
    posture throughout.
    """
    q = path.move[-1]
    along = problem.along
    if along is None:
        return np.repeat(q[None], RETREAT_SAMPLES, axis=0), 0.0
    objects = problem.object_path
    contact = along.contact
    query = problem.query
    frame = query.scene.support.frame
    clearance = query.motion.clearance
    slack = room_before(query.scene, contact, margins.ARM.retreat, clearance)
    R, p = problem.kin.tip_pose(q)
    normal = np.array(frame.direction(contact.direction(objects.bodies[-1])))
    points = np.linspace(p, p - slack * normal, RETREAT_SAMPLES)
    yaws = np.full(len(points), attitude.yaw(R))
    # an arm that ends inside the buffer may use half of what is left to the limit
    lower = min(margins.ARM.joint_buffer, 0.5 * float(problem.kin.joint_margin(q)))
    route = continuation(problem.kin, points, yaws, q, attitude, lower)
    end = objects.shapes[-1:]

    def clear(i: int) -> bool:
        gap = problem.clearance.min_distance(route.q[i : i + 1], end, touching=True)
        return gap.clear

    reached = len(route.q) if route.failed_at is None else max(1, route.failed_at)
    return route.q[: _clear_count(clear, reached)], slack / (RETREAT_SAMPLES - 1)


def _clear_count(clear: Callable[[int], bool], count: int) -> int:
    """Number of leading samples, of ``count``, that are clear. The first is assumed
    clear.
    """
    blocked = (i for i in range(1, count) if not clear(i))
    return next(blocked, count)


def _capsules(problem: ArmProblem) -> ArmCapsules:
    return problem.library.capsules(problem.robot, problem.arm)


class _TwoArms:
    """Search for two joint paths with clearance between the arms."""

    def __init__(self, plan: Plan, problems: list[ArmProblem], force: bool) -> None:
        self.plan = plan
        self.problems = problems
        self.force = force
        self._capsules = [_capsules(problem) for problem in problems]
        unsure = plan.query.scene.planned_for_errors
        self._wanted = ROOMY if unsure else APART

    def paths(self) -> tuple[ArmPath, ...]:
        """First attempt without a conflict. Raises InfeasibleTaskError with the largest
        conflict if all attempts have one.
        """
        conflicts = []
        for attempt in self._attempts():
            if not isinstance(attempt, Conflict):
                return attempt
            conflicts.append(attempt)
        worst = max(conflicts)
        raise InfeasibleTaskError(
            f"{self.plan.query.source}: robots: {worst.place} the arms come as near "
            f"as {worst.distance * 1e3:.1f} mm to each other, allowed from "
            f"{APART * 1e3:.0f} mm"
        )

    def _attempts(self) -> Iterator[tuple[ArmPath, ...] | Conflict]:
        """Yield both paths, or their conflict: each arm's best path first, then all
        pairs, ordered by the lower of their scores. Pairs that are nearer than wanted,
        or lack room beside the object, come last.
        """
        tight: list[tuple[Pair, float]] = []
        searches = [search(problem, force=self.force) for problem in self.problems]
        results = []
        best = []
        for problem, stream in zip(self.problems, searches, strict=True):
            results.append(first_roomy(stream))
            best.append(results[-1].best(problem))
        along = self._along(best)
        if along >= self._wanted or self.force:
            yield from self._waiting(best, along)
        for arm, problem in enumerate(self.problems):
            if problem.along is None:
                # whatever the other arm does, this one may get out of its way
                for result in searches[arm]:
                    results[arm] = result
                    best[arm] = result.solutions[-1]
                    along = self._along(best)
                    if along >= self._wanted:
                        yield from self._waiting(best, along)
        options = []
        upper = FEW if self.plan.from_search else None
        for result, stream in zip(results, searches, strict=True):
            *_, complete = [result, *islice(stream, upper)]
            options.append(complete.solutions)
        apart = []
        pairs, nearest = self._apart_at_first(options)
        if nearest > -math.inf:
            yield Conflict(0, "along the contacts", nearest)
        for pair in sorted(pairs, key=_score, reverse=True):
            along = self._along(pair)
            if along < APART:
                yield Conflict(0, "along the contacts", along)
                continue
            apart.append((pair, along))
            roomy = all(solution.path.margin_share >= 1.0 for solution in pair)
            if along < self._wanted or not roomy:
                tight.append((pair, along))
                continue
            yield from self._waiting(pair, along)
        for pair, along in tight:
            yield from self._waiting(pair, along)
        for pair, along in apart[:IN_TURN]:
            yield from self._in_turn(pair, along)

    def _apart_at_first(
        self, options: Sequence[Sequence[Solution]]
    ) -> tuple[list[Pair], float]:
        """Pairs of solutions whose arms are clear of each other when the contacts
        start, and the largest distance [m], at most LOOK, among the other pairs.
        """
        left, right = options
        one, other = (
            np.stack([solution.move.posture.q[0] for solution in each])
            for each in options
        )
        mine, its = self._capsules
        distances = pair_distances(mine, its, one, other, LOOK)
        apart = distances >= APART
        pairs: list[Pair] = [(left[i], right[j]) for i, j in np.argwhere(apart)]
        return pairs, float(distances[~apart].max(initial=-math.inf))

    def _along(self, pair: Pair) -> float:
        """Smallest distance [m] between the arms at the touch and along the contacts.

        A coarse check of every sixth sample comes first. If its distance is already too
        small, it is the result.
        """
        touching = self._touching(pair)
        if touching < APART:
            return touching
        left, right = (solution.move.posture.q for solution in pair)
        return min(touching, self._glanced(left, right))

    def _touching(self, pair: Pair) -> float:
        """Smallest distance [m] between the arms while both move from near the object
        to their contacts.
        """
        paths = []
        for problem, solution in zip(self.problems, pair, strict=True):
            path = solution.path.touch
            if problem.along is None:
                path = solution.path.move[:1]
            if path is None:
                return LOOK
            paths.append(path)
        left, right = paths
        if len(left) > 1 and len(right) > 1:
            count = min(len(left), len(right))
            left = left[-count:]
            right = right[-count:]
        return self._min_distance(left, right)

    def _glanced(self, left: Array, right: Array) -> float:
        """Smallest distance [m] over every sixth sample if that is already too small,
        otherwise over all samples.
        """
        coarse = self._min_distance(left[::GLANCE], right[::GLANCE])
        if coarse < APART:
            return coarse
        return self._min_distance(left, right)

    def _min_distance(self, left: Array, right: Array) -> float:
        """Smallest distance [m] between the arms, at most LOOK, over postures (k, n) of
        each.
        """
        one, other = self._capsules
        return least_distance(one, other, left, right, LOOK)

    def _waiting(
        self, pair: Pair, along: float
    ) -> Iterator[tuple[ArmPath, ...] | Conflict]:
        """Yield both paths started together, then both with one arm waiting for the
        other.
        """
        left, right = (float(solution.path.approach_time[-1]) for solution in pair)
        for delays in ((0.0, 0.0), (0.0, left), (right, 0.0)):
            force = self.force and delays[0] > 0.0
            yield self._delayed(pair, delays, along, force=force)

    def _in_turn(
        self, pair: Pair, along: float
    ) -> Iterator[tuple[ArmPath, ...] | Conflict]:
        """Yield both paths with one arm led around the other.

        The other arm waits, before its own approach or after it.
        """
        for first, second in ((0, 1), (1, 0)):
            start = pair[second].path.approach[0]
            leading = self._around(first, pair[first], {second: start})
            if leading is None:
                continue
            end = leading.path.approach[-1]
            trailing = self._around(second, pair[second], {first: end})
            if trailing is None:
                continue
            delay = float(leading.path.approach_time[-1])
            if first == 0:
                yield self._delayed((leading, trailing), (0.0, delay), along)
            else:
                yield self._delayed((trailing, leading), (delay, 0.0), along)

    def _around(
        self, arm: int, solution: Solution, others: dict[int, Array]
    ) -> Solution | None:
        """``solution`` with an approach that avoids ``others``. None if no such
        approach is found.
        """
        care = solution.care
        path = path_of_move(
            self.problems[arm], solution.move, others=others, thorough=True, care=care
        )
        if isinstance(path, Miss):
            return None
        return Solution(solution.move, path, care)

    def _delayed(
        self, pair: Pair, delays: Sequence[float], along: float, *, force: bool = False
    ) -> tuple[ArmPath, ...] | Conflict:
        """Both paths, each started after its delay [s], or the conflict of their
        approaches.
        """
        paths = [
            _after(solution.path, delay)
            for solution, delay in zip(pair, delays, strict=True)
        ]
        end = max(float(path.approach_time[-1]) for path in paths)
        times = np.linspace(0.0, end, max(2, math.ceil(end / PERIOD)))
        clear = self._glanced(*(_sampled(path, times) for path in paths))
        if clear < APART and not force:
            return Conflict(1, "on the way to the object", clear)
        return tuple(
            (
                replace(path, clearance=min(path.clearance, clear, along)),
                solution.move.posture.attitude,
            )
            for solution, path in zip(pair, paths, strict=True)
        )


def _score(pair: Pair) -> float:
    return min(solution.move.score for solution in pair)


def _after(path: JointPath, delay: float) -> JointPath:
    """Path of an arm that first waits ``delay`` [s]."""
    if delay == 0.0:
        return path
    times = np.concatenate([[0.0], path.approach_time + delay])
    return replace(
        path,
        approach_time=times,
        approach=np.concatenate([path.approach[:1], path.approach]),
    )


def _sampled(path: JointPath, times: Array) -> Array:
    """Postures (m, n) of the approach at ``times`` (m,)."""
    return np.column_stack(
        [np.interp(times, path.approach_time, column) for column in path.approach.T]
    )
