"""Joint paths: accurate at the tip, refused with a figure, refined if a grid of
postures just fails.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.paths import joint_path as search
from pushpressslide.arms.paths.approach import APPROACH_SPEED, LEAST_GAP, led_in
from pushpressslide.arms.paths.clearance import CLEARANCE
from pushpressslide.arms.paths.postures import CONDITION_LIMIT, JOINT_MARGIN
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.jobs.sampling import random_task
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.tool import ToolAttitude
from pushpressslide.selection.solve import plan as make_plan
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.sim.clearance import DrakeClearance


def base(robot: str = "panda") -> Task:
    task = pps.load_task("rear-push-rear")
    return replace(task, robots=(replace(task.robots[0], model=robot),))


def near_the_base(radius: float) -> Task:
    """Return a push that begins with the tip ``radius`` [m] in front of the base."""
    task = base()
    start = Pose2(radius + 0.075 + task.robots[0].tip_radius, 0.0, 0.0)
    return replace(
        task, start=start, goal=start.compose(Pose2(0.25, 0.03, math.radians(15.0)))
    )


def tip_errors(
    plan: Plan, path: JointPath, attitude: ToolAttitude
) -> tuple[float, float]:
    """Errors of the tip [m] and of the tool's rotation [rad] at the samples."""
    kin = arm_kinematics(plan.task.robots[0])
    (segment,) = plan.segments
    (contact,) = segment.contacts
    inside, height = contact.tip_place(plan.task.robots[0].tip_radius)
    bodies = [segment.body_pose(float(x)) for x in path.arc_length]
    R, p = kin.tip_pose(path.move)
    off = p - np.array([(*X.apply(inside), height) for X in bodies])
    wanted = attitude.rotation(np.array([X.yaw for X in bodies]) + path.tool_yaw_offset)
    turn = np.linalg.norm(R - wanted, axis=(1, 2)) / math.sqrt(2.0)
    return float(np.linalg.norm(off, axis=1).max()), float(turn.max())


def check(plan: Plan, path: JointPath, attitude: ToolAttitude) -> None:
    """Hold a joint path to everything that is asked of one."""
    kin = arm_kinematics(plan.task.robots[0])
    position, turn = tip_errors(plan, path, attitude)
    assert position < 2e-6
    assert turn < 2e-6
    assert kin.joint_margin(path.move).min() >= JOINT_MARGIN
    assert np.linalg.cond(kin.jacobian(path.move)).max() < CONDITION_LIMIT
    model = DrakeClearance(plan, 0)
    start = plan.task.start
    (segment,) = plan.segments
    objects = [plan.object_pose(segment, float(s)) for s in path.arc_length]
    assert model.min_distance(path.move, objects, touching=True).distance >= CLEARANCE
    before = model.min_distance(
        path.approach, [start] * len(path.approach), touching=False
    )
    assert before.distance >= CLEARANCE
    assert np.abs(np.diff(path.approach, axis=0)).max() < 0.1
    gap = path.gap * np.array(plan.contacts[0].direction(objects[0]))
    end, first = (
        np.asarray(kin.tip_pose(q)[1]) for q in (path.approach[-1], path.move[0])
    )
    assert np.linalg.norm(first - gap - end) < 1e-4


@pytest.mark.parametrize("name", ["rear-push-rear", "rear-push-left"])
def test_the_tip_of_a_shipped_task_is_right(name: str) -> None:
    plan = pps.plan(pps.load_task(name))
    path, attitude = search.joint_path(DRAKE, plan)
    check(plan, path, attitude)
    assert path.gap == pytest.approx(plan.task.motion.approach_distance)


def test_what_is_hopeless_is_refused_with_the_figure() -> None:
    plan = make_plan(near_the_base(0.02), force=True)
    told = r"panda_link0\w* and object come as near as -\d+\.\d mm, allowed from 5 mm"
    with pytest.raises(InfeasibleTaskError, match=told):
        search.joint_path(DRAKE, plan)


def test_a_tip_that_cannot_be_drawn_back_all_the_way_is_drawn_back_less() -> None:
    plan = pps.plan(random_task(base(), 71, seed=2))
    path, attitude = search.joint_path(DRAKE, plan)
    assert LEAST_GAP <= path.gap < plan.task.motion.approach_distance
    check(plan, path, attitude)


@pytest.mark.parametrize("radius", [0.24, 0.36])
def test_a_push_may_begin_near_the_base(radius: float) -> None:
    plan = pps.plan(near_the_base(radius))
    check(plan, *search.joint_path(DRAKE, plan))


def test_the_smooth_distance_is_a_lower_bound_and_its_gradient_is_right() -> None:
    plan = pps.plan(pps.load_task("rear-push-rear"))
    path, _ = search.joint_path(DRAKE, plan)
    model = DrakeClearance(plan, 0)
    rng = np.random.default_rng(0)
    for i in np.linspace(0, len(path.move) - 1, 5).astype(int):
        q = path.move[i] + rng.normal(0.0, 0.05, path.move.shape[1])
        pose = plan.object_pose(plan.segments[0], 0.0)
        smooth, gradient = model.smooth_least(q, pose, touching=False)
        exact = model.min_distance(q[None], [pose], touching=False).distance
        assert exact - 2e-3 < smooth <= exact
        step = 1e-6
        for joint, slope in enumerate(gradient):
            ahead = q.copy()
            behind = q.copy()
            ahead[joint] += step
            behind[joint] -= step
            rise = model.smooth_least(ahead, pose, touching=False)[0]
            rise -= model.smooth_least(behind, pose, touching=False)[0]
            assert rise / (2.0 * step) == pytest.approx(slope, abs=2e-3)


def test_arms_go_to_their_next_way_from_rest_to_rest_and_in_the_same_time() -> None:
    facts = arm_kinematics(base().robots[0]).facts
    home = facts.home
    path = JointPath(
        np.array([0.0, 1.0]),
        np.stack([home, home + 0.1]),
        np.zeros(1),
        home[None],
        0.0,
        1.0,
        1.0,
        0.1,
        0.1,
    )
    near, far = led_in([path, path], [facts, facts], [home + 0.01, home - 0.8])
    assert near.approach_time[-1] == pytest.approx(far.approach_time[-1])
    for led, start in ((near, home + 0.01), (far, home - 0.8)):
        assert led.approach[0] == pytest.approx(start)
        assert led.approach[-2:] == pytest.approx(path.approach)
        assert np.diff(led.approach_time[-2:]) == pytest.approx(1.0)
        rate = (
            np.abs(np.diff(led.approach[:-1], axis=0))
            / np.diff(led.approach_time[:-1])[:, None]
        )
        assert rate.max() <= 1.01 * APPROACH_SPEED
        assert max(rate[0].max(), rate[-1].max()) < 0.05 * rate.max()
