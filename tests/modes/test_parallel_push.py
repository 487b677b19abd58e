"""Two arms side by side (docs/mechanics.md, section 5): feasible motions, their
execution, and refusals.
"""

import math
from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Cylinder, ObjectModel, Robot, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.friction import cone_margin
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Measured
from pushpressslide.planar.engine import run
from pushpressslide.report.metrics import result
from pushpressslide.rom.drives import CarDrive
from pushpressslide.selection.select import select
from pushpressslide.selection.solve import plan

MODE = MODES["parallel_push"]
SHIPPED = load_task(
    "parallel-push",
    [
        "object.shape.box=[0.4, 0.4, 0.2]",
        "start.x=0.40",
        "start.y=0.08",
        "goal.x=0.86",
        "goal.y=0.10",
    ],
)
HANDS = tuple(Robot("hand", (0.0, y, 0.0)) for y in (0.5, -0.5))
# on which every pair of places leaves room for the tools
WIDE = ObjectModel(Box((0.4, 0.46, 0.2)), 2.0, (0.0, 0.0))
REAR = 3
D = 0.2


def to(x: float, y: float, yaw_deg: float, drive: str | None = None, **more) -> Task:
    """Return the shipped task for free tips, pushed on its rear face to a goal seen
    from the start.
    """
    goal = SHIPPED.start.compose(Pose2(x, y, math.radians(yaw_deg)))
    motion = replace(SHIPPED.motion, face=REAR, vehicle=drive)
    return replace(SHIPPED, robots=HANDS, goal=goal, motion=motion, **more)


def best(task: Task) -> Choice:
    choice = MODE.choices(task.query)[0]
    assert choice.feasible, choice.reason
    return choice


def allocations(made: Plan, count: int = 40):
    """Yield the tracker's wrenches along the path of a plan, and the forces that
    produce them.
    """
    (segment,) = made.segments
    tracker = MODE.tracker(made.task.query, segment)
    drive = segment.drive
    friction = made.task.scene.contact_friction
    allocate = MODE.allocator(segment.contacts, friction, drive.rho, drive.center)
    path = segment.path
    for i in range(count + 1):
        s = path.length * i / count
        guidance = tracker.step(path, segment.body_pose(s), s, 0.05, 1.0)
        yield guidance, allocate(*guidance.wrench[:3])


def test_the_shipped_task_is_done_with_each_arm_on_its_own_side() -> None:
    choice = select(SHIPPED)[0]
    assert choice.feasible, choice.reason
    assert [c.arm for c in choice.contacts] == [0, 1]
    assert choice.contacts[0].point[1] > 0.0 > choice.contacts[1].point[1]
    assert all(c.normal == pytest.approx((1.0, 0.0)) for c in choice.contacts)


def test_the_differential_car_takes_no_friction_at_all() -> None:
    choice = best(to(0.46, 0.05, 10.0, "differential"))
    for _, allocation in allocations(plan(to(0.46, 0.05, 10.0), choice)):
        assert allocation.status == "ok"
        for force, normal in zip(allocation.forces, allocation.normals, strict=True):
            assert force == pytest.approx((normal, 0.0), abs=1e-9)
            assert normal > 0.0


def test_the_synchronised_car_is_pushed_with_equal_forces() -> None:
    task = to(0.46, 0.05, 10.0, "synchronised")
    for guidance, allocation in allocations(plan(task, best(task))):
        assert allocation.status == "ok"
        assert allocation.forces[0] == pytest.approx(allocation.forces[1], abs=1e-9)
        assert guidance.wrench.tau == pytest.approx(-D * guidance.wrench.fy, abs=1e-9)


def test_a_goal_aside_is_a_loop_for_the_car_and_one_twist_for_both_mixed() -> None:
    aside = (0.25, 0.08, 0.0)
    car = MODE.choices(to(*aside, "differential").query)[0]
    assert not car.feasible
    assert "a loop of" in car.reason
    choice = best(to(*aside))
    assert isinstance(choice.segments[0].path, TwistPath)
    assert "mixed" in choice.reason
    for _, allocation in allocations(plan(to(*aside), choice)):
        assert allocation.status == "ok"
        # friction carries it to the left
        assert allocation.forces[0][1] + allocation.forces[1][1] > 0.3
        for contact, force in zip(choice.contacts, allocation.forces, strict=True):
            assert cone_margin(force, contact.normal, 0.6) > 0.0


@pytest.mark.parametrize("goal", [(-0.3, 0.0, 0.0), (0.0, 0.0, 40.0), (0.0, 0.3, 0.0)])
def test_back_on_the_spot_and_sideways_are_refused_with_the_numbers(goal) -> None:
    choices = MODE.choices(to(*goal, object=WIDE).query)
    assert not any(c.feasible for c in choices)
    for choice in choices:
        assert "a loop of" in choice.reason
        assert "deg outside the cone, needed 6 deg inside" in choice.reason


def test_the_differential_car_may_turn_with_w_over_rho_squared() -> None:
    told = replace(SHIPPED.full_belief, rho=0.13)
    task = to(0.46, 0.05, 10.0, "differential", belief=told, object=WIDE)
    choices = MODE.choices(task.query)
    assert choices
    for choice in choices:
        half_width = 0.5 * math.dist(*(c.point for c in choice.contacts))
        drive = choice.segments[0].drive
        assert isinstance(drive, CarDrive)
        assert drive.car.left == pytest.approx(half_width / 0.13**2)
        assert drive.car.right == pytest.approx(half_width / 0.13**2)


def test_what_stands_against_it_is_told_with_the_number() -> None:
    cylinder = ObjectModel(Cylinder(0.2, 0.2), 2.0, (0.0, 0.0))
    assert (
        "no flat face"
        in MODE.choices(to(0.3, 0.0, 0.0, object=cylinder).query)[0].reason
    )
    narrow = ObjectModel(Box((0.4, 0.1, 0.2)), 2.0, (0.0, 0.0))
    refusal = MODE.choices(to(0.3, 0.0, 0.0, object=narrow).query)[0]
    assert "contacts 76 mm apart, two tools need 100 mm" in refusal.reason
    weak = replace(SHIPPED.limits, normal_force=3.0)  # the drag of 5.9 N is shared
    refusal = MODE.choices(to(0.3, 0.0, 0.0, limits=weak).query)[0]
    assert "pushed with up to 2.9 N, allowed 2.7 N" in refusal.reason
    enough = replace(SHIPPED.limits, normal_force=4.0)
    assert MODE.choices(to(0.3, 0.0, 0.0, limits=enough).query)[0].feasible
    beside = ObjectModel(Box((0.4, 0.4, 0.2)), 2.0, (0.0, 0.19))
    refusal = MODE.choices(to(0.3, 0.0, 0.0, object=beside).query)[0]
    assert "contacts 24 mm apart" in refusal.reason


@pytest.mark.parametrize("drive", ["differential", "synchronised", "mixed"])
@pytest.mark.parametrize("goal", [(0.46, 0.03, 8.0), (0.4, -0.04, -12.0)])
def test_the_planar_engine_ends_where_the_plan_does(drive: str, goal) -> None:
    task = to(*goal, drive)
    made = plan(task, best(task))
    figures = result(task, made, run(made), {})
    assert figures["reason"]["code"] in ("goal_reached", "goal_missed")
    assert figures["final_position_error"] < 1e-3
    assert figures["final_yaw_error"] < math.radians(0.3)
    assert figures["contact_loss_time"] == 0.0


@pytest.mark.parametrize("drive", ["differential", "mixed"])
def test_a_plan_made_anew_starts_where_the_object_is_and_ends_at_the_goal(
    drive: str,
) -> None:
    task = to(0.46, 0.05, 10.0, drive)
    made = plan(task, best(task))
    contacts = made.segments[0].contacts
    X_WB = task.start.compose(Pose2(0.004, -0.005, 0.03))
    touched = tuple((c.point[0], c.point[1] + 0.004) for c in made.contacts)
    length = made.segments[0].path.length
    off = Measured.touching(X_WB, contacts, touched, 1.2 * length)
    (fresh,) = MODE.replan(task.query, made.segments, off)
    assert [c.point for c in fresh.contacts] == list(touched)
    for s, wanted in ((0.0, X_WB), (fresh.path.length, task.goal)):
        pose = made.object_pose(fresh, s)
        assert math.dist(pose.position, wanted.position) < 1e-9
        turn = math.remainder(pose.yaw - wanted.yaw, 2.0 * math.pi)
        assert turn == pytest.approx(0.0, abs=1e-9)
    scant = Measured.touching(X_WB, contacts, touched, 0.5 * length)
    assert MODE.replan(task.query, made.segments, scant) == ()
