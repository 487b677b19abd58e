"""The search for a joint path: frozen results, no more work than requested, refusals
that follow from the result alone.
"""

import re
from dataclasses import FrozenInstanceError, replace
from itertools import pairwise

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.paths import all_arms
from pushpressslide.arms.paths import joint_path as joint_paths
from pushpressslide.arms.paths.all_arms import Conflict
from pushpressslide.arms.paths.approach import Descent
from pushpressslide.arms.paths.arm_problem import (
    CONDITION_ROOM,
    JOINT_ROOM,
    LEAVING,
    OBJECT_ROOM,
    STEP,
    ArmProblem,
    object_path,
)
from pushpressslide.arms.paths.joint_path import (
    NOWHERE,
    SearchResult,
    _approach_miss,
    first_roomy,
    joint_path,
    search,
)
from pushpressslide.arms.paths.postures import (
    YAW_OFFSETS,
    Miss,
    Posture,
    continued_moves,
    problem_text,
    tool_options,
)
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.robots.continuation import Continuation
from pushpressslide.robots.tool import UPRIGHT
from pushpressslide.selection.solve import plan as make_plan
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.sim.clearance import DrakeClearance

POSTURE = Posture(UPRIGHT, 0.0, np.zeros((2, 7)))


@pytest.fixture(scope="module")
def push() -> Plan:
    return pps.plan(pps.load_task("rear-push-rear"))


@pytest.fixture(scope="module")
def unsure(push: Plan) -> Plan:
    """The push, with a belief that states errors."""
    belief = replace(push.task.belief, friction_error=0.3)
    return replace(push, task=replace(push.task, belief=belief))


@pytest.fixture(scope="module")
def counted(push: Plan) -> tuple[list[SearchResult], list[int]]:
    """Return the results, and how many postures were looked at before the first, after
    it and after each other one.
    """
    least = DrakeClearance.min_distance
    postures = 0

    def count(model, q, poses, **options):
        nonlocal postures
        postures += len(q)
        return least(model, q, poses, **options)

    found = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(DrakeClearance, "min_distance", count)
        stream = search(ArmProblem(DRAKE, push, 0))
        counts = [postures]
        for result in stream:
            found.append(result)
            counts.append(postures)
    return found, counts


@pytest.fixture(scope="module")
def results(counted: tuple[list[SearchResult], list[int]]) -> list[SearchResult]:
    return counted[0]


def hopeless() -> Plan:
    """A push whose tip begins in the robot's base."""
    task = pps.load_task("rear-push-rear")
    start = Pose2(0.095 + task.robots[0].tip_radius, 0.0, 0.0)
    goal = start.compose(Pose2(0.25, 0.03, 0.26))
    return make_plan(replace(task, start=start, goal=goal), force=True)


def test_each_result_extends_the_one_before_by_one_solution(
    results: list[SearchResult],
) -> None:
    assert len(results) > 1
    for i, result in enumerate(results):
        assert len(result.solutions) == i + 1
    for before, after in pairwise(results):
        assert after.solutions[:-1] == before.solutions


def test_the_first_result_costs_only_the_first_solution(
    counted: tuple[list[SearchResult], list[int]],
) -> None:
    results, postures = counted
    assert postures[0] == 0
    assert postures[1] <= postures[-1] / len(results) * 2.0


def test_the_joint_path_is_the_best_of_the_first_result(
    push: Plan, results: list[SearchResult]
) -> None:
    path, attitude = joint_path(DRAKE, push)
    best = results[-1].best(ArmProblem(DRAKE, push, 0))
    np.testing.assert_array_equal(path.approach, best.path.approach)
    assert attitude == best.move.posture.attitude


def test_a_search_without_a_solution_has_one_result_with_its_misses() -> None:
    plan = hopeless()
    problem = ArmProblem(DRAKE, plan, 0)
    (result,) = search(problem)
    assert not result.solutions
    assert result.misses
    with pytest.raises(InfeasibleTaskError) as caught:
        result.best(problem)
    assert str(caught.value).endswith(result.misses[0].reason)
    assert next(search(problem, force=True)).solutions


def test_an_arm_that_could_not_let_go_is_refused_at_once(
    push: Plan, results: list[SearchResult], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = results[0].solutions[0].path
    monkeypatch.setattr(joint_paths, "_candidates", None)  # nothing is looked for
    touching = ArmProblem(DRAKE, push, 0, start=path.move[0])
    (result,) = search(touching)
    assert not result.solutions
    assert re.search(
        r"where the arm stands \w+ and object come as near as .* mm, allowed from 5 mm",
        result.misses[0].reason,
    )
    with pytest.raises(TypeError):  # an arm that stands clear is not refused
        next(search(ArmProblem(DRAKE, push, 0, start=path.approach[0])))


def test_an_arm_that_stands_too_near_may_leave(
    push: Plan, results: list[SearchResult]
) -> None:
    """It stands where a joint limit has ended its retreat."""
    path = results[0].solutions[0].path
    problem = ArmProblem(DRAKE, push, 0)
    shapes = problem.object_path.shapes[:1]
    touches, back = path.move[0], path.approach[-1]
    postures = [touches + k * (back - touches) for k in np.linspace(0.0, 1.0, 200)]
    stands = {
        problem.clearance.min_distance(q[None], shapes, touching=False).distance: q
        for q in postures
    }
    near = [gap for gap in stands if 0.002 < gap < 0.0045]
    assert near
    gap = max(near)
    leaving = ArmProblem(DRAKE, push, 0, start=stands[gap])
    assert next(search(leaving)).solutions
    stays = leaving.approach_clearance(leaving.clearance, stands[gap][None])
    assert stays.allowed == pytest.approx(gap - LEAVING)


def test_the_refusal_depends_on_nothing_but_the_result(push: Plan) -> None:
    problem = ArmProblem(DRAKE, push, 0)
    misses = tuple(Miss(0.1 * i, f"miss {i}", POSTURE) for i in (1, 2))
    result = SearchResult((), misses)
    for _ in range(2):
        with pytest.raises(InfeasibleTaskError, match="along the contact: miss 1"):
            result.best(problem)
    with pytest.raises(FrozenInstanceError):
        result.misses = ()  # type: ignore[misc]


def test_the_object_path_is_sampled_finely_from_start_to_goal(push: Plan) -> None:
    path = object_path(push)
    assert np.diff(path.arc_length).min() > 0.0
    assert np.diff(path.arc_length).max() <= STEP + 1e-12
    for X_WG, planned in ((path.shapes[0], push.task.start), (path.shapes[-1], None)):
        last = push.segments[-1]
        X = planned or push.object_pose(last, last.path.length)
        assert (X_WG.x, X_WG.y) == pytest.approx((X.x, X.y))
    X_GB = push.task.object.X_GB
    for X_WG, X_WB in zip(path.shapes, path.bodies, strict=True):
        again = X_WG.compose(X_GB)
        assert (again.x, again.y) == pytest.approx((X_WB.x, X_WB.y))


def test_an_arm_that_keeps_its_contact_goes_on_from_its_posture(
    push: Plan, results: list[SearchResult]
) -> None:
    q = results[0].solutions[0].path.move
    problem = ArmProblem(DRAKE, push, 0, q[0], holds=True)
    assert problem.along is not None
    axes = push.task.support.frame.axes
    tip = problem.along.tip
    (move,) = continued_moves(problem.kin, tip, q[0], axes, force=False)
    np.testing.assert_allclose(move.posture.q[0], q[0], atol=1e-5)
    (elsewhere,) = continued_moves(problem.kin, tip, q[0] + 0.2, axes, force=False)
    assert isinstance(elsewhere, Miss)
    assert "holds on is elsewhere" in elsewhere.reason
    solution = next(search(problem)).best(problem)
    assert (solution.path.approach == q[0]).all()


@pytest.mark.parametrize("rolls", [False, True])
def test_an_upright_tool_comes_first_and_every_other_option_leans(rolls: bool) -> None:
    axes = pps.load_task("rear-push-rear").support.frame.axes
    upright, *others = tool_options((0.3, 0.9), 0.2, axes, rolls=rolls)
    assert upright[0].tilt == 0.0
    np.testing.assert_array_equal(upright[1], YAW_OFFSETS)
    assert all(tool.tilt > 0.0 for tool, _ in others)
    assert others[0][0].turns == rolls
    for tool, offsets in others:
        assert len(offsets) == len(YAW_OFFSETS) or tool.turns


def test_the_conflict_of_the_latest_stage_decides_then_the_largest_distance() -> None:
    contact = Conflict(0, "along the contacts", 0.004)
    near = Conflict(1, "on the way to the object", -0.01)
    nearly = Conflict(1, "on the way to the object", 0.003)
    assert max([nearly, contact, near]) == nearly
    assert max([contact, near]) == near


def test_two_arms_are_refused_with_their_greatest_conflict(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = pps.plan(pps.load_task("orthogonal-push"))
    monkeypatch.setattr(all_arms, "least_distance", lambda *_: 0.0012)
    with pytest.raises(InfeasibleTaskError) as caught:
        all_arms.joint_paths(DRAKE, plan)
    assert "along the contacts the arms come" in str(caught.value)
    assert "as near as 1.2 mm to each other" in str(caught.value)


def test_a_search_without_a_single_posture_is_refused_in_one_line(push: Plan) -> None:
    with pytest.raises(InfeasibleTaskError, match="no attitude of the tool"):
        SearchResult(()).best(ArmProblem(DRAKE, push, 0))


def test_a_path_that_misses_its_attitude_is_not_called_short_of_reach() -> None:
    path = Continuation(
        q=np.zeros((2, 7)),
        position_residual=np.zeros(2),
        angle_residual=np.array([0.0, 0.1]),
        joint_margins=np.ones(2),
        conditions=np.full(2, 15.0),
        status="unreachable",
        failed_at=1,
    )
    why = problem_text(path, np.zeros((2, 3)))
    assert why.startswith("5.7 deg short of the tool's attitude")


def test_an_approach_that_was_not_judged_names_no_figure_that_is_allowed() -> None:
    followed = Continuation(
        np.zeros((2, 7)),
        np.zeros(2),
        np.zeros(2),
        np.ones(2),
        np.full(2, 15.0),
        "ok",
        None,
    )
    descent = Descent(
        np.zeros((2, 3)), followed, 1, 1, 0.05, np.zeros((0, 7)), np.zeros(0)
    )
    miss = _approach_miss(POSTURE, descent, NOWHERE)
    assert "allowed" not in miss.reason


def test_only_an_object_that_is_not_known_exactly_asks_for_room(
    push: Plan, unsure: Plan
) -> None:
    assert ArmProblem(DRAKE, push, 0).margin_share(0.0, 0.0) == 1.0
    problem = ArmProblem(DRAKE, unsure, 0)
    assert problem.margin_share(OBJECT_ROOM, JOINT_ROOM) == 1.0
    assert problem.margin_share(0.5 * OBJECT_ROOM) == pytest.approx(0.5)
    assert problem.margin_share(OBJECT_ROOM, 0.2 * JOINT_ROOM) == pytest.approx(0.2)
    steady = problem.margin_share(OBJECT_ROOM, JOINT_ROOM, CONDITION_ROOM)
    weak = problem.margin_share(OBJECT_ROOM, JOINT_ROOM, 2.0 * CONDITION_ROOM)
    assert (steady, weak) == (1.0, pytest.approx(0.75))
    near = problem.margin_share(0.6 * OBJECT_ROOM, JOINT_ROOM, 2.0 * CONDITION_ROOM)
    assert near == pytest.approx(0.6)


def test_a_joint_path_with_room_is_taken_before_one_without(
    results: list[SearchResult],
) -> None:
    solutions = results[-1].solutions[:3]
    rooms = (0.4, 1.0, 1.0)
    tight = [
        replace(solution, path=replace(solution.path, margin_share=room))
        for solution, room in zip(solutions, rooms, strict=True)
    ]
    stream = iter([SearchResult(tuple(tight[: i + 1])) for i in range(3)])
    result = first_roomy(stream)
    assert len(result.solutions) == 2
    assert result.solutions[0] is tight[0]
    assert max(result.solutions, key=lambda s: s.path.margin_share) is tight[1]
    assert len(list(stream)) == 1  # no further one was looked for


def test_of_the_links_only_the_tip_may_be_near_the_object_it_touches(
    unsure: Plan,
) -> None:
    path, _ = joint_path(DRAKE, unsure)
    model = DrakeClearance(unsure, 0)
    along = object_path(unsure)
    touching = model.min_distance(path.move, along.shapes, touching=True)
    alone = model.min_distance(path.move, along.shapes, touching=False)
    assert alone.distance < 1e-3 < alone.to_object
    assert touching.to_object == alone.to_object
    assert path.condition < CONDITION_ROOM
    assert path.margin_share == pytest.approx(
        min(1.0, touching.to_object / OBJECT_ROOM)
    )
