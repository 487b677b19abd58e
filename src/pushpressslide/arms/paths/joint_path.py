"""Joint path of one arm: the approach to its contact, then along it.

The tip follows its contact point, and the tool's yaw follows the object, since a tip
that does not turn with the face rolls along it. Free parameters are the tool's yaw
relative to the object, its tilt, and the elbow. All combinations of a grid are followed
by continuation (postures.py), which keeps the elbow away from the joint limits. The
best one that keeps clear of table, object and obstacles is taken. If there is none, the
nearest misses are refined by trajectory optimisation (refine.py) and checked again. An
arm without a contact waits (waiting.py).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, islice
from operator import attrgetter

import numpy as np

from pushpressslide.arms.paths.approach import (
    BARELY,
    CAREFUL,
    LEAST_GAP,
    Care,
    Descent,
    Trajectory,
)
from pushpressslide.arms.paths.arm_problem import ArmProblem, ContactPath
from pushpressslide.arms.paths.clearance import CLEARANCE, Clearance, Gap
from pushpressslide.arms.paths.effort import largest_share
from pushpressslide.arms.paths.library import ArmLibrary
from pushpressslide.arms.paths.postures import (
    JOINT_MARGIN,
    POSE,
    Miss,
    Move,
    Posture,
    TipPath,
    ToolOption,
    continued_moves,
    moves,
    problem_text,
    shortfall,
)
from pushpressslide.arms.paths.waiting import waiting_moves
from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

GLANCE = 8  # every eighth posture of an approach is checked before all of them are
COMPARED = 4  # joint paths, where none has all the room
REFINED = 4  # largest number of misses that are refined
# moves along a contact that something is in the way of, after which no more are looked
# at in a search over sequences of motions
MOST_BLOCKED = 24
# share of a torque limit that holding the contact at rest may take; the rest is for
# control
MOST_EFFORT = 0.8
NEAR = 0.1  # largest shortfall of a miss that is refined
BACK = 3  # samples before the contact that a refined move includes
STANDING = np.array([0.0, 0.5])  # [s] approach of an arm that stays where it is
NOWHERE = Gap(-math.inf, "")  # of an approach that is not found
SHORTFALL = attrgetter("shortfall")

ArmPath = tuple[JointPath, ToolAttitude]


@dataclass(frozen=True)
class Solution:
    """A move along the contact, and the joint path that includes its approach."""

    move: Move
    path: JointPath
    care: Care = CAREFUL  # with which its approach was found


@dataclass(frozen=True)
class SearchResult:
    """Solutions and misses known at one stage of a search.

    A miss is a posture that is not feasible.
    """

    solutions: tuple[Solution, ...]  # the preferred first
    # where nothing was found: first the moves that something is in the way of, then
    # those that the joints cannot do; each from the smallest shortfall
    misses: tuple[Miss, ...] = ()

    def best(self, problem: ArmProblem) -> Solution:
        """The preferred joint path: the first with the most room.

        Raises InfeasibleTaskError, with the shortfall of the nearest miss, if there is
        none.
        """
        if self.solutions:
            return max(self.solutions, key=attrgetter("path.margin_share"))
        lacks = "joint path along the contact"
        reason = "no attitude of the tool can be followed"
        if problem.along is None:
            lacks = "place to wait"
            reason = "no motion leads there"
        if self.misses:
            reason = self.misses[0].reason
        raise InfeasibleTaskError(
            f"{problem.query.source}: robots: the {problem.kin.facts.name} has no "
            f"{lacks}: {reason}"
        )


def joint_path(
    library: ArmLibrary, plan: Plan, arm: int = 0, *, force: bool = False
) -> ArmPath:
    """Joint path and tool attitude of one arm, ignoring other arms.

    ``force`` takes the best path available, however bad. Raises InfeasibleTaskError,
    with the deciding number, if no tried posture has a path.
    """
    problem = ArmProblem(library, plan, arm)
    solution = first_roomy(search(problem, force=force)).best(problem)
    return solution.path, solution.move.posture.attitude


def first_roomy(results: Iterator[SearchResult]) -> SearchResult:
    """Result of a search at its first joint path with all the room, or after a few with
    less.
    """
    for result in islice(results, COMPARED):
        if not result.solutions or result.solutions[-1].path.margin_share >= 1.0:
            break
    return result


def search(problem: ArmProblem, *, force: bool = False) -> Iterator[SearchResult]:
    """Yield the result after each new joint path, the preferred one first.

    A search that finds nothing yields one result, with the misses. Postures of low
    quality at the touch, and refined moves, are tried only if the grid has no other
    joint path. The search is lazy: it advances only when the next result is requested.
    """
    stuck = None if force else _stuck(problem)
    if stuck is not None:
        yield SearchResult((), (stuck,))
        return
    solutions: tuple[Solution, ...] = ()
    blocked: list[Miss] = []
    unreached: list[Miss] = []
    upper = MOST_BLOCKED if problem.plan.from_search else None
    for move in _candidates(problem, force):
        if isinstance(move, Miss):
            unreached.append(move)
            continue
        path = path_of_move(problem, move, force=force)
        if isinstance(path, Miss):
            blocked.append(path)
            if len(blocked) == upper:
                break
            continue
        solutions = (*solutions, Solution(move, path))
        yield SearchResult(solutions)
    if solutions:
        return
    for i, miss in enumerate(blocked):
        if miss.drawn_back:
            continue
        move = Move.from_posture(problem.kin, miss.posture)
        path = path_of_move(problem, move, care=BARELY)
        if isinstance(path, Miss):
            blocked[i] = path
            continue
        solutions = (Solution(move, path, BARELY),)
        yield SearchResult(solutions)
        return
    blocked.sort(key=SHORTFALL)
    unreached.sort(key=SHORTFALL)
    # even the nearest blocked move is far from allowed: refining would not help; an arm
    # that waits may be led around what is in its way
    too_hard = bool(blocked) and blocked[0].shortfall > NEAR + MOST_EFFORT
    too_hard = too_hard and problem.along is not None
    misses = (*blocked, *unreached)
    if not too_hard:
        for better in _refined(problem, misses):
            solutions = (*solutions, better)
            yield SearchResult(solutions)
    if not solutions:
        yield SearchResult((), misses)


def _stuck(problem: ArmProblem) -> Miss | None:
    """Miss for an arm whose posture after release is blocked, so that no approach can
    start from it. None if the posture is clear.
    """
    if problem.start is None or problem.holds or problem.along is None:
        return None
    start = problem.start[None]
    gap = problem.approach_clearance(problem.clearance, start)
    if gap.clear:
        return None
    posture = Posture(UPRIGHT, 0.0, start)
    reason = f"where the arm stands {gap.text}"
    return Miss(10.0 * gap.lack, reason, posture, in_approach=True)


def path_of_move(
    problem: ArmProblem,
    move: Move,
    *,
    others: Mapping[int, Array] | None = None,
    force: bool = False,
    thorough: bool = False,
    care: Care = CAREFUL,
) -> JointPath | Miss:
    """Whole joint path of a move, its approach included.

    ``others`` are postures (n,) of further arms that stand still during the approach.
    ``thorough`` also searches for approaches around obstacles. ``care`` is the required
    posture quality at the start of the touch.
    """
    posture = move.posture
    along = problem.along
    if along is None:
        return _waiting_path(problem, move, others or {}, force, thorough)
    contact = problem.contact_clearance(posture.q)
    miss = None if force else _contact_miss(problem, posture, contact)
    if miss is not None:
        return miss
    if problem.holds:
        standing = _standing(problem.posture)
        return _joint_path(problem, move, standing, [contact], math.inf)
    least_gap = 0.0 if force else LEAST_GAP
    approach = problem.approach
    descent = approach.descent(along.tip, along.normal, posture, least_gap, care)
    touching = problem.touch_clearance(descent.touch)
    if not touching.clear and not force:
        return _approach_miss(posture, descent, touching)
    model = _model(problem, others or {})
    searches = [problem.approach.direct(descent)]
    if thorough:
        free = partial(problem.free, model)
        searches.append(problem.approach.around(descent, free))
    trajectory, gap = _clear_approach(problem, model, searches, force=force)
    if trajectory is None:
        return _approach_miss(posture, descent, gap)
    gaps = [contact, touching, gap]
    path = _joint_path(problem, move, trajectory, gaps, descent.gap)
    return replace(path, touch=descent.touch)


def _clear_approach(
    problem: ArmProblem,
    model: Clearance,
    searches: Iterable[Iterable[Trajectory]],
    *,
    force: bool,
) -> tuple[Trajectory | None, Gap]:
    """Approach of the first search that has a clear one, and its tightest gap.

    Within a search, the first with the most room is taken. None, with the nearest
    miss's gap, if no approach is clear. ``force`` takes the first of all.
    """
    nearest = NOWHERE
    for trajectories in searches:
        clear: list[tuple[Trajectory, Gap]] = []
        for trajectory in trajectories:
            gap = _approach_clearance(problem, model, trajectory.postures)
            if force or (gap.clear and problem.margin_share(gap.to_object) >= 1.0):
                return trajectory, gap
            if gap.clear:
                clear.append((trajectory, gap))
            if gap.lack < nearest.lack:
                nearest = gap
        if clear:
            return max(clear, key=lambda pair: pair[1].to_object)
    return None, nearest


def _waiting_path(
    problem: ArmProblem,
    move: Move,
    others: Mapping[int, Array],
    force: bool,
    thorough: bool,
) -> JointPath | Miss:
    """Path of an arm to its waiting posture. The other parameters are as in
    ``path_of_move``.
    """
    posture = move.posture.q[0]
    waiting = problem.waiting_clearance(posture)
    start = problem.approach.start_posture
    if np.array_equal(posture, start):
        return _joint_path(problem, move, _standing(start), [waiting], math.inf)
    model = _model(problem, others)
    searches = [problem.approach.to(posture)]
    if thorough:
        searches.append(problem.approach.to(posture, partial(problem.free, model)))
    trajectory, gap = _clear_approach(problem, model, searches, force=force)
    if trajectory is None:
        reason = f"on the way to where it waits, {gap.text}"
        return Miss(10.0 * gap.lack, reason, move.posture, in_approach=True)
    return _joint_path(problem, move, trajectory, [waiting, gap], math.inf)


def _standing(posture: Array) -> Trajectory:
    """Approach of an arm that stays in a posture (n,)."""
    return Trajectory(STANDING, np.repeat(posture[None], 2, axis=0))


def _model(problem: ArmProblem, others: Mapping[int, Array]) -> Clearance:
    """Clearance model of the arm, including further arms that stand still."""
    if not others:
        return problem.clearance
    return problem.library.clearance(
        problem.plan, problem.arm, {**problem.others, **others}
    )


def _joint_path(
    problem: ArmProblem,
    move: Move,
    approach: Trajectory,
    gaps: Sequence[Gap],
    touch_gap: float,
) -> JointPath:
    """Joint path with its tightest ``gaps``. The touch begins ``touch_gap`` [m] off the
    contact.
    """
    return JointPath(
        approach.times,
        approach.postures,
        problem.object_path.arc_length,
        move.posture.q,
        move.posture.offset,
        move.margin,
        move.condition,
        min(gap.distance for gap in gaps),
        touch_gap,
        margin_share=problem.margin_share(
            min(gap.to_object for gap in gaps), move.margin, move.condition
        ),
    )


def _approach_clearance(problem: ArmProblem, model: Clearance, postures: Array) -> Gap:
    """Tightest gap of the approach.

    A coarse check of every eighth posture comes first. If its gap is already too small,
    it is the result.
    """
    coarse = problem.approach_clearance(model, postures[::GLANCE])
    return problem.approach_clearance(model, postures) if coarse.clear else coarse


def _approach_miss(posture: Posture, descent: Descent, gap: Gap) -> Miss:
    """Miss for an approach blocked by ``gap``, or for one not found if that is
    ``NOWHERE``.
    """
    if gap is NOWHERE:
        reason = "the arm is stretched too far to feel for it"
        if not descent.retreat.ok:
            reason = problem_text(descent.retreat, descent.points)
        lack = shortfall(descent.retreat, descent.needed)
        return Miss(lack, f"before the contact, {reason}", posture, drawn_back=False)
    return Miss(
        10.0 * gap.lack,
        f"on the way to the object {gap.text}",
        posture,
        in_approach=True,
    )


def _contact_miss(problem: ArmProblem, posture: Posture, gap: Gap) -> Miss | None:
    """Miss for a posture with a fault along the contact, or None."""
    if not gap.clear:
        return Miss(10.0 * gap.lack, gap.text, posture)
    along = problem.along
    assert along is not None
    bodies = problem.object_path.bodies
    share = largest_share(
        problem.plan, along.contact, problem.dynamics, posture.q, bodies
    )
    if share > MOST_EFFORT:
        reason = f"holding its contact takes {share:.2f} of a joint's torque limit, allowed {MOST_EFFORT:g}"
        return Miss(NEAR + share, reason, posture)
    rolled = _rolled(problem, along, posture.attitude)
    allowed = margins.ROLLED * math.hypot(*along.contact.point)
    if rolled > allowed:
        reason = f"a tool that leans and does not turn rolls its tip by {rolled * 1e3:.0f} mm"
        return Miss(NEAR + rolled, f"{reason}, allowed {allowed * 1e3:.0f} mm", posture)
    return None


def _rolled(problem: ArmProblem, along: ContactPath, attitude: ToolAttitude) -> float:
    """Distance [m] that a single press rolls from its start, zero for other contacts."""
    if [contact.kind for contact in problem.plan.contacts] != ["top"]:
        return 0.0
    return attitude.rolled(problem.robot.tip_radius, float(np.ptp(along.tip.yaws)))


def _candidates(problem: ArmProblem, force: bool) -> Iterator[Move | Miss]:
    """Yield the moves along the contact, the preferred first, and the misses in
    between.

    Upright tools come before tilted ones; stretched arms come last.
    """
    along = problem.along
    if along is None:
        yield from waiting_moves(problem, force=force)
        return
    if problem.holds:
        axes = problem.query.scene.support.frame.axes
        yield from continued_moves(
            problem.kin, along.tip, problem.posture, axes, force=force
        )
        return
    options = problem.tool_options(along)
    stretched: list[Move] = []
    for _, group in groupby(options, _kind_of_attitude):
        good, worse, misses = moves(problem.kin, along.tip, list(group), force=force)
        stretched += worse
        yield from misses
        yield from good
    yield from stretched


def _kind_of_attitude(option: ToolOption) -> tuple[bool, bool]:
    """Whether the tool is tilted, and whether it turns with the object."""
    tool, _ = option
    return tool.tilt > 0.0, tool.turns


def _refined(problem: ArmProblem, misses: tuple[Miss, ...]) -> Iterator[Solution]:
    """Yield joint paths refined from the nearest misses. Within a search over sequences
    of motions none are yielded, since other motions are tried instead.
    """
    along = problem.along
    if along is None:
        yield from _parked_around(problem, misses)
        return
    if problem.holds or problem.kin.facts.size < POSE:
        return
    if problem.plan.from_search:
        return
    near = [_with_clearance(problem, m) for m in misses if m.shortfall < NEAR]
    near = sorted((m for m in near if m.shortfall < NEAR), key=SHORTFALL)
    for miss in _diverse(near):
        move: Move | None = Move.from_posture(problem.kin, miss.posture)
        if not miss.in_approach:
            move = _refined_move(problem, along, miss.posture)
        if move is None:
            continue
        path = path_of_move(problem, move, thorough=True, care=BARELY)
        if isinstance(path, JointPath):
            yield Solution(move, path, BARELY)


def _parked_around(problem: ArmProblem, misses: tuple[Miss, ...]) -> Iterator[Solution]:
    """Yield paths to waiting postures, around obstacles on the direct path."""
    blocked = [miss for miss in misses if miss.in_approach]
    for miss in blocked[:REFINED]:
        move = Move.from_posture(problem.kin, miss.posture)
        path = path_of_move(problem, move, thorough=True)
        if isinstance(path, JointPath):
            yield Solution(move, path)


def _with_clearance(problem: ArmProblem, miss: Miss) -> Miss:
    """The miss, with the shortfall of clearance along the contact added."""
    gap = problem.contact_clearance(miss.posture.q)
    lack = max(miss.shortfall, 10.0 * gap.lack)
    return replace(miss, shortfall=lack)


def _diverse(misses: list[Miss]) -> list[Miss]:
    """Nearest misses with different tool attitudes."""
    out: list[Miss] = []
    for miss in misses:
        if not any(miss.posture.resembles(chosen.posture) for chosen in out):
            out.append(miss)
    return out[:REFINED]


def _refined_move(
    problem: ArmProblem, along: ContactPath, posture: Posture
) -> Move | None:
    """Feasible move near a missed posture, or None.

    The end of the approach is refined with it, so that the arm can retreat.
    """
    tip = along.tip
    first = tip.positions[0]
    gap = min(LEAST_GAP, problem.approach.before)
    back = np.linspace(first - gap * np.array(along.normal), first, BACK + 1)[:-1]
    extended = TipPath(
        np.concatenate([back, tip.positions]),
        np.concatenate([np.repeat(tip.yaws[:1], BACK), tip.yaws]),
        [*[tip.objects[0]] * BACK, *tip.objects],
    )
    q = np.concatenate([np.repeat(posture.q[:1], BACK, axis=0), posture.q])
    better = problem.library.refined(
        problem.kin,
        problem.clearance,
        extended,
        replace(posture, q=q),
        JOINT_MARGIN,
        CLEARANCE,
    )
    if better is None:
        return None
    move = Move.from_posture(problem.kin, replace(better, q=better.q[BACK:]))
    if not move.allowed:
        return None
    return move
