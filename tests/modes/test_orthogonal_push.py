"""Two arms on two faces (docs/mechanics.md, section 6): feasible motions, their
execution, and refusals.
"""

import math
import re
from dataclasses import replace
from itertools import product

import pytest

from pushpressslide import load_task
from pushpressslide.allocation.orthogonal import feasibility
from pushpressslide.core.plan import Choice, Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Cylinder, ObjectModel, Robot, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.friction import cone_margin
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Measured
from pushpressslide.modes.orthogonal_push import OrthogonalPush
from pushpressslide.planar.engine import run
from pushpressslide.report.metrics import result
from pushpressslide.rom.drives import TwistDrive
from pushpressslide.selection.select import select
from pushpressslide.selection.solve import plan

MODE = MODES["orthogonal_push"]
assert isinstance(MODE, OrthogonalPush)
SHIPPED = load_task("orthogonal-push")
HANDS = tuple(Robot("hand", (0.0, y, 0.0)) for y in (0.5, -0.5))
D = 0.2
MU = 0.6
SYMMETRIC = (
    Contact(0, "side", (0.0, D), (0.0, -1.0), 0.09),
    Contact(1, "side", (-D, 0.0), (1.0, 0.0), 0.09),
)


def to(x: float, y: float, yaw_deg: float, **more) -> Task:
    """Return the shipped task for free tips, to a goal seen from the start."""
    goal = SHIPPED.start.compose(Pose2(x, y, math.radians(yaw_deg)))
    return replace(SHIPPED, robots=HANDS, goal=goal, **more)


def on_rear_and_left(choices: list[Choice]) -> list[Choice]:
    """Return the choices that push the faces -x and +y."""
    wanted = {(1.0, 0.0), (0.0, -1.0)}
    return [
        c
        for c in choices
        if {tuple(round(v) for v in k.normal) for k in c.contacts} == wanted
    ]


def test_the_shipped_task_is_done_by_one_twist_with_the_left_arm_on_the_left_face() -> (
    None
):
    choice = select(SHIPPED)[0]
    assert choice.feasible, choice.reason
    (segment,) = choice.segments
    assert isinstance(segment.drive, TwistDrive)
    assert segment.drive.radius == pytest.approx(math.hypot(0.2, 0.2))
    assert isinstance(segment.path, TwistPath)
    assert len(segment.path.sections) == 1
    assert choice.contacts[0].normal == pytest.approx((0.0, -1.0))
    assert choice.contacts[1].normal == pytest.approx((1.0, 0.0))


@pytest.mark.parametrize(
    "goal", [(0.4, -0.25, 20.0), (0.3, -0.3, -25.0), (0.35, -0.1, -10.0)]
)
def test_every_wrench_of_a_plan_is_given_with_both_contacts_pushing(goal) -> None:
    feasible = [c for c in MODE.choices(to(*goal).query) if c.feasible]
    assert feasible
    for choice in feasible:
        (segment,) = plan(to(*goal), choice).segments
        drive = segment.drive
        allocate = MODE.allocator(choice.contacts, MU, drive.rho, drive.center)
        tracker = MODE.tracker(to(*goal).query, segment)
        path = segment.path
        for i in range(20):
            s = path.length * i / 19
            guidance = tracker.step(path, path.pose(s), s, 0.05, 1.0)
            allocation = allocate(*guidance.wrench[:3])
            assert allocation.status == "ok"
            for contact, force in zip(choice.contacts, allocation.forces, strict=True):
                assert cone_margin(force, contact.normal, MU) >= -1e-9
            assert min(allocation.normals) > 0.02 * drive.max_friction


def test_back_it_is_refused_with_the_wrench_and_the_angle_that_decide() -> None:
    refusals = on_rear_and_left(MODE.choices(to(-0.3, 0.3, 0.0).query))
    assert refusals
    for choice in refusals:
        assert not choice.feasible
        found = re.search(
            r"requires \((.*), (.*)\) N and (.*) N m, (\d+) deg outside the cone",
            choice.reason,
        )
        assert found is not None, choice.reason
        fx, fy, tau = (float(found.group(i)) for i in (1, 2, 3))
        assert fx < -3.0 < 3.0 < fy
        assert not feasibility(fx, fy, tau, D, MU).feasible
        assert int(found.group(4)) == 90  # the nearest that they can give is nothing


def test_what_is_refused_no_placement_on_those_faces_can_give() -> None:
    for goal in ((-0.3, 0.3, 0.0), (0.0, 0.0, 30.0), (-0.2, -0.1, 0.0)):
        (choice,) = on_rear_and_left(MODE.choices(to(*goal).query))[:1]
        assert not choice.feasible
        found = re.search(r"requires \((.*), (.*)\) N and (.*) N m", choice.reason)
        assert found is not None
        wrench = [float(found.group(i)) for i in (1, 2, 3)]
        for a, b in product((-0.18, -0.06, 0.0, 0.06, 0.18), repeat=2):
            contacts = (
                replace(SYMMETRIC[0], point=(a, D)),
                replace(SYMMETRIC[1], point=(-D, b)),
            )
            assert MODE.allocator(contacts, MU)(*wrench).status != "ok"


def test_a_goal_beside_the_cone_takes_several_twists() -> None:
    """0.3 m ahead and 0.15 m to the left, of which the two faces push away."""
    paths = [
        c.segments[0].path
        for c in on_rear_and_left(MODE.choices(to(0.3, 0.15, 0.0).query))
        if c.segments
    ]
    assert paths
    assert all(isinstance(path, TwistPath) and len(path.sections) > 1 for path in paths)


def test_a_friction_above_one_does_not_make_it_push_backwards() -> None:
    task = to(-0.3, 0.3, 0.0, belief=replace(SHIPPED.full_belief, contact_friction=1.5))
    assert not any(c.feasible for c in on_rear_and_left(MODE.choices(task.query)))


def test_what_stands_against_it_is_told_with_the_number() -> None:
    cylinder = ObjectModel(Cylinder(0.2, 0.2), 2.0, (0.0, 0.0))
    refusal = MODE.choices(to(0.3, -0.3, 0.0, object=cylinder).query)[0]
    assert "no flat faces" in refusal.reason
    weak = replace(SHIPPED.limits, normal_force=4.0)
    refusal = MODE.choices(to(0.3, -0.3, 0.0, limits=weak).query)[0]
    assert "pushed with up to 4.2 N, allowed 3.6 N" in refusal.reason


def test_outside_the_cone_the_three_projections_keep_what_they_say() -> None:
    wanted = (3.0, -2.0, 1.2)  # more moment than friction has
    assert not feasibility(*wanted, D, MU).feasible
    kept = {}
    for projection in ("nearest", "force_priority", "torque_priority"):
        allocation = MODE.allocator(SYMMETRIC, MU, 0.12, projection=projection)(*wanted)
        assert allocation.status == "projected"
        kept[projection] = allocation.residual
        for contact, force in zip(SYMMETRIC, allocation.forces, strict=True):
            assert cone_margin(force, contact.normal, MU) >= -1e-9
    assert kept["force_priority"][:2] == pytest.approx((0.0, 0.0), abs=1e-9)
    assert kept["torque_priority"][2] == pytest.approx(0.0, abs=1e-9)
    sizes = {name: math.hypot(*r[:2], r[2] / 0.12) for name, r in kept.items()}
    assert sizes["nearest"] <= min(sizes.values()) + 1e-9


@pytest.mark.parametrize(
    "goal", [(0.4, -0.25, 20.0), (0.3, -0.3, -25.0), (0.3, -0.03, 45.0)]
)
def test_the_planar_engine_ends_where_the_plan_does(goal) -> None:
    task = to(*goal)
    made = plan(task, next(c for c in MODE.choices(task.query) if c.feasible))
    figures = result(task, made, run(made), {})
    assert figures["final_position_error"] < 1e-3
    assert figures["final_yaw_error"] < math.radians(0.3)
    assert figures["contact_loss_time"] == 0.0
    assert figures["slip_distance"] < 2e-3


def test_a_start_that_is_off_is_made_up_for() -> None:
    task = to(0.4, -0.25, 10.0, start_error=Pose2(0.01, -0.008, math.radians(4.0)))
    made = plan(task, next(c for c in MODE.choices(task.query) if c.feasible))
    figures = result(task, made, run(made), {})
    assert figures["final_position_error"] < 2e-3
    assert figures["final_yaw_error"] < math.radians(0.5)


def test_a_plan_made_anew_starts_where_the_object_is_and_ends_at_the_goal() -> None:
    task = to(0.4, -0.25, 10.0)
    made = plan(task, MODE.choices(task.query)[0])
    contacts = made.segments[0].contacts
    X_WB = task.start.compose(Pose2(0.004, -0.005, 0.03))
    touched = tuple(c.point for c in made.contacts)
    length = made.segments[0].path.length
    off = Measured.touching(X_WB, contacts, touched, 1.2 * length)
    (fresh,) = MODE.replan(task.query, made.segments, off)
    for s, wanted in ((0.0, X_WB), (fresh.path.length, task.goal)):
        pose = made.object_pose(fresh, s)
        assert math.dist(pose.position, wanted.position) < 1e-9
        turn = math.remainder(pose.yaw - wanted.yaw, 2.0 * math.pi)
        assert turn == pytest.approx(0.0, abs=1e-9)
    scant = Measured.touching(X_WB, contacts, touched, 0.5 * length)
    assert MODE.replan(task.query, made.segments, scant) == ()
