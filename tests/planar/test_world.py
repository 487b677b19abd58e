"""Tips and object over time: free flight, touch, slip, presses, loads, and the exact
surface as truth.
"""

import math
from itertools import pairwise

import numpy as np
import pytest

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.control import TipCommand
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2, cross
from pushpressslide.core.task import (
    Box,
    Cylinder,
    ObjectModel,
    Prism,
    Robot,
    Support,
    Task,
)
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.mechanics.limit_surface import exact_wrench
from pushpressslide.mechanics.pressure import center_of_pressure, support_pressure
from pushpressslide.mechanics.virtual_axle import axle_with_height, dragged_twist
from pushpressslide.planar.world import World

DT = 0.004
RADIUS = 0.02
BOX = Box((0.15, 0.1, 0.1))
BAR = Box((0.6, 0.2, 0.1))
REAR = Contact(0, "side", (-0.075, 0.0), (1.0, 0.0), 0.03)


def command(
    force=(0.0, 0.0, 0.0),
    velocity=(0.0, 0.0, 0.0),
    damping=300.0,
    yaw=0.0,
    position=None,
    k=0.0,
):
    place = (0.0, 0.0, 0.0) if position is None else position
    return TipCommand(
        force,
        place,
        velocity,
        (k, k, k),
        (damping, damping, damping),
        yaw,
        0.0,
        0.0,
        25.0,
        0.0,
    )


def world(shape, contacts, mass=1.0, com=(0.0, 0.0), support=0.3, contact=0.6, dt=DT):
    arms = 1 + max(c.arm for c in contacts)
    robots = tuple(
        Robot("hand", (0.3 + i, 0.2, 0.1), tip_radius=RADIUS) for i in range(arms)
    )
    body = ObjectModel(shape, mass, com)
    task = Task(
        "by-hand",
        body,
        Pose2(),
        Pose2(),
        robots,
        Support("table", support),
        contact_friction=contact,
    )
    return World(task, contacts, dt)


def states(made, commands, ticks, gap=0.0, X_WG=Pose2()):  # noqa: B008
    """Start and every state after; ``commands`` of one tick, or a function of the
    state.
    """
    state = made.start(X_WG, X_WG, gap)
    out = [state]
    for _ in range(ticks):
        state = made.step(state, commands(state) if callable(commands) else commands)
        out.append(state)
    return out


def gap_of(state, made, i=0):
    tip = state.tips[made.contacts[i].arm].position
    return made.faces[i].gap(state.X_WB.unapply(tip[:2]), tip[2])[0]


def test_a_tip_that_is_drawn_back_lets_go_and_flies_free():
    made = world(BOX, (REAR,))
    run = states(made, (command(force=(-3.0, 1.5, 0.6)),), 5)
    for before, after in pairwise(run):
        assert after.contacts == ("free",)
        assert after.tips[0].force == (0.0, 0.0, 0.0)
        assert after.tips[0].velocity == pytest.approx((-0.01, 0.005, 0.002))
        step = np.subtract(after.tips[0].position, before.tips[0].position)
        assert step == pytest.approx(np.array((-0.01, 0.005, 0.002)) * DT)
        assert after.X_WB == run[0].X_WB


def test_a_tip_comes_to_its_face_without_going_into_it_and_stays():
    made = world(BOX, (REAR,), mass=10.0)
    run = states(made, (command(velocity=(0.03, 0.0, 0.0)),), 300, gap=0.0201)
    gaps = [gap_of(state, made) for state in run]
    assert min(gaps) > -1e-12
    assert abs(gaps[-1]) < 1e-12
    assert run[-1].contacts == ("stick",)
    assert run[-1].tips[0].force == pytest.approx(
        (9.0, 0.0, 0.0), abs=1e-5
    )  # the servo, held by the object at rest
    assert math.dist(run[-1].X_WB.position, run[0].X_WB.position) < 1e-6


def test_a_sticking_tip_keeps_its_place_on_a_turning_object_to_the_last_bit_of_its_gap():
    contact = Contact(0, "side", (-0.075, 0.03), (1.0, 0.0), 0.03)
    made = world(BOX, (contact,))
    run = states(made, (command(velocity=(0.05, 0.0, 0.0)),), 250)
    assert abs(run[-1].X_WB.yaw) > 0.1
    assert {state.contacts[0] for state in run[1:]} == {"stick"}
    for state in run:
        assert state.X_WB.unapply(state.tips[0].position[:2]) == pytest.approx(
            (-0.095, 0.03), abs=1e-12
        )


def test_a_stiff_spring_does_not_ring():
    made = world(BOX, (REAR,))
    start = made.start(Pose2(), Pose2(), 0.0).tips[0].position
    target = (start[0] + 0.004, start[1], start[2])
    run = states(made, (command(position=target, damping=0.0, k=1e6),), 30)
    x = [state.X_WB.x for state in run]
    assert all(b >= a - 1e-9 for a, b in pairwise(x))
    # what is missing is friction over stiffness
    assert x[-1] == pytest.approx(0.004, abs=1e-5)
    assert x[-1] < 0.004


def test_a_tip_that_slides_off_the_end_of_its_face_loses_contact():
    made = world(BOX, (REAR,), mass=50.0, contact=0.2)
    run = states(
        made, (command(force=(5.0, 0.0, 0.0), velocity=(0.0, 0.05, 0.0)),), 400
    )
    statuses = [state.contacts[0] for state in run[1:]]
    assert set(statuses) == {"slip_left", "free"}
    lost = statuses.index("free")
    assert set(statuses[lost:]) == {"free"}
    assert run[lost].tips[0].position[1] == pytest.approx(0.05, abs=1e-3)
    assert run[-1].X_WB.position == pytest.approx((0.0, 0.0), abs=1e-5)


def test_a_tip_slides_around_a_cylinder_and_presses_along_its_normal():
    contact = Contact(0, "side", (-0.09, 0.0), (1.0, 0.0), 0.03)
    mu = 0.3
    made = world(
        Cylinder(0.08, 0.1), (contact,), mass=50.0, com=(0.01, 0.0), contact=mu
    )
    run = states(
        made, (command(force=(8.0, 0.0, 0.0), velocity=(0.0, 0.05, 0.0)),), 200
    )
    sliding = [
        (before, state)
        for before, state in pairwise(run)
        if state.contacts[0] == "slip_left"
    ]
    assert len(sliding) > 100
    for before, state in sliding:
        x, y, _ = before.tips[0].position
        n = (-x / 0.1, -y / 0.1)
        force = state.tips[0].force
        assert math.hypot(*n) == pytest.approx(1.0, abs=1e-4)
        assert cross(n, force) == pytest.approx(mu * np.dot(n, force[:2]), abs=1e-3)
    assert run[-1].tips[0].position[1] > 0.03


def test_a_press_comes_down_and_bears_what_it_is_pushed_with():
    contact = Contact(0, "top", (0.02, 0.01), (0.0, 0.0), 0.1, 8.0)
    made = world(BOX, (contact,))
    run = states(made, (command(force=(0.0, 0.0, -8.0)),), 300, gap=0.03)
    height = [state.tips[0].position[2] for state in run]
    assert height[0] == pytest.approx(0.15)
    assert height[1] == pytest.approx(0.15 - DT * 8.0 / 300.0)
    assert min(height) == pytest.approx(0.12, abs=1e-12)
    assert height[-1] == min(height)
    assert run[-1].tips[0].force == pytest.approx((0.0, 0.0, -8.0))
    assert run[-1].contacts == ("stick",)
    lifted = made.step(run[-1], (command(force=(0.0, 0.0, 3.0)),))
    assert lifted.contacts == ("free",)
    assert lifted.tips[0].velocity[2] == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("pull", "moves", "slips"), [(2.0, False, False), (6.0, True, False)]
)
def test_a_press_pulls_the_object_with_it_above_the_limit_only(pull, moves, slips):
    contact = Contact(0, "top", (0.02, 0.0), (0.0, 0.0), 0.1, 10.0)
    # slides at 0.2 (9.81 + 10) = 3.96 N, slips at 8
    made = world(BOX, (contact,), support=0.2, contact=0.8)
    run = states(made, (command(force=(pull, 0.0, -10.0)),), 50)
    assert (run[-1].X_WB.x > 1e-3) == moves
    assert (run[-1].contacts[0] == "slip") == slips
    assert run[-1].tips[0].force[0] == pytest.approx(
        min(pull, 0.2 * (9.81 + 10.0)), abs=1e-5
    )


def test_a_press_that_is_pulled_beyond_its_friction_slips_and_leaves_the_object():
    contact = Contact(0, "top", (-0.05, 0.0), (0.0, 0.0), 0.1, 3.0)
    made = world(BOX, (contact,), support=0.3, contact=0.5)
    run = states(
        made, (command(velocity=(0.05, 0.0, 0.0), force=(0.0, 0.0, -3.0)),), 1000
    )
    assert run[1].contacts == ("slip",)
    assert run[1].tips[0].force == pytest.approx((1.5, 0.0, -3.0))
    assert run[1].tips[0].velocity[0] == pytest.approx(0.05 - 1.5 / 300.0)
    assert run[-1].X_WB.x == pytest.approx(0.0, abs=1e-6)
    assert run[-1].contacts == ("free",)  # over the edge
    assert run[-1].tips[0].force == (0.0, 0.0, 0.0)


def pressure_of(shape):
    return lambda cop: face_pressure(shape, (0.0, 0.0), cop)


@pytest.mark.parametrize(("direction", "axle"), [(1.0, 0.034), (-1.0, -0.198)])
def test_the_pressed_bar_turns_about_the_axle_of_the_papers_experiment(direction, axle):
    """docs/mechanics.md, section 4: 0.3 kg pressed with 8 N at 0.2 m, pulled forward
    and pushed back.
    """
    contact = Contact(0, "top", (0.2, 0.0), (0.0, 0.0), 0.1, 8.0)
    made = world(BAR, (contact,), mass=0.3, support=0.3, contact=0.9)
    angle = 0.02  # nearly straight
    pull = (direction * 0.05 * math.cos(angle), direction * 0.05 * math.sin(angle), 0.0)

    def along(state):
        v = (*state.X_WB.rotate(pull[:2]), 0.0)
        return (
            command(
                force=(0.0, 0.0, -8.0), velocity=v, damping=500.0, yaw=state.X_WB.yaw
            ),
        )

    run = states(made, along, 50)
    twist = run[-1].twist.moved_to((0.0, 0.0))
    assert run[-1].contacts == ("stick",)
    assert -twist.vy / twist.w == pytest.approx(axle, abs=0.004)
    force = run[-2].X_WB.unrotate(run[-1].tips[0].force[:2])
    cop = (8.0 * 0.2 / (8.0 + 0.3 * GRAVITY), 0.0)
    exact = axle_with_height(
        pressure_of(BAR), 0.3, cop, contact.point, 0.1, math.atan2(force[1], force[0])
    )
    assert -twist.vy / twist.w == pytest.approx(exact[0], abs=0.002)


@pytest.mark.parametrize("steering", [-0.4, 0.05, 0.25, 0.5])
def test_a_push_at_a_height_moves_the_object_as_the_exact_surface_says(steering):
    made = world(BOX, (REAR,))
    n = 300.0 * 0.05
    t = 300.0 * 0.05 * math.tan(steering)
    run = states(
        made,
        lambda s: (command(force=(*s.X_WB.rotate((n, t)), 0.0), yaw=s.X_WB.yaw),),
        30,
    )
    force = run[-2].X_WB.unrotate(run[-1].tips[0].force[:2])
    along = (force[0] / math.hypot(*force), force[1] / math.hypot(*force))
    expected = dragged_twist(
        pressure_of(BOX), 0.3, (0.0, 0.0), REAR.point, REAR.height, along
    )
    twist = run[-1].twist.moved_to((0.0, 0.0))
    scale = math.hypot(twist.vx, twist.vy, 0.05 * twist.w)
    wanted = math.hypot(expected.vx, expected.vy, 0.05 * expected.w)
    assert (
        twist.vx / scale,
        twist.vy / scale,
        0.05 * twist.w / scale,
    ) == pytest.approx(
        (expected.vx / wanted, expected.vy / wanted, 0.05 * expected.w / wanted),
        abs=3e-3,
    )


def wandering(seed, contacts):
    """Commands that change all the time: pushes, pulls, presses, and none."""
    rng = np.random.default_rng(seed)

    def commands(_):
        out = [None] * 2
        for contact in contacts:
            if rng.random() < 0.95:
                push = rng.uniform(0.0, 8.0)
                force = (*(rng.normal(size=2)).tolist(), -push)
                velocity = (*(0.05 * rng.normal(size=2)).tolist(), 0.02 * rng.normal())
                out[contact.arm] = command(
                    force, velocity, rng.uniform(50.0, 800.0), rng.uniform(-3.0, 3.0)
                )
        return tuple(out)

    return commands


TRIANGLE = Prism(((-0.1, -0.08), (0.12, -0.06), (0.0, 0.11)), 0.1)


@pytest.mark.parametrize("shape", [BOX, TRIANGLE, Cylinder(0.075, 0.1)])
@pytest.mark.parametrize("seed", [1, 2])
def test_whatever_two_arms_do_the_support_takes_the_exact_surfaces_wrench_and_only_dissipates(
    shape, seed
):
    side = Contact(0, "side", (-0.075, 0.0), (1.0, 0.0), 0.03)
    top = Contact(1, "top", (0.01, 0.01), (0.0, 0.0), 0.1, 5.0)
    made = world(shape, (side, top))
    run = states(made, wandering(seed, (side, top)), 400)
    checked = 0
    for before, state in pairwise(run):
        X = before.X_WB
        assert np.isfinite(
            [(*tip.position, *tip.velocity, *tip.force) for tip in state.tips]
        ).all()
        assert np.isfinite((X.x, X.y, X.yaw, *state.twist[:3])).all()
        assert state.tips[1].force[2] <= 0.0
        points = [X.unapply(tip.position[:2]) for tip in before.tips]
        # the force acts on the face, not at the tip's centre
        if state.contacts[0] != "free":
            gap, normal = made.faces[0].gap(points[0], before.tips[0].position[2])
            points[0] = tuple(
                p + (gap + RADIUS) * n for p, n in zip(points[0], normal, strict=True)
            )
        given = [X.unrotate(tip.force[:2]) for tip in state.tips]
        press = -state.tips[1].force[2]
        was = [X.unrotate(tip.force[:2]) for tip in before.tips]
        heights = (before.tips[0].position[2], 0.1)
        cop = center_of_pressure(
            GRAVITY, (0.0, 0.0), (press,), points[1:], was, heights
        )
        if made.support.outwards(cop) > 0.9 or math.hypot(*state.twist[:2]) < 1e-3:
            continue
        samples = support_pressure(shape, GRAVITY + press, (0.0, 0.0), cop, 12)
        taken = exact_wrench(samples, 0.3, Twist(*state.twist[:3], cop))
        limit = 0.3 * (GRAVITY + press)
        fx = sum(f[0] for f in given)
        fy = sum(f[1] for f in given)
        tau = sum(
            cross((p[0] - cop[0], p[1] - cop[1]), f)
            for p, f in zip(points, given, strict=True)
        )
        assert (fx, fy) == pytest.approx((taken.fx, taken.fy), abs=0.01 * limit)
        assert tau == pytest.approx(taken.tau, abs=0.01 * limit * 0.06)
        vx, vy, w = state.twist[:3]
        assert fx * vx + fy * vy + tau * w >= 0.0
        checked += 1
    assert checked > 40


def test_a_tip_without_a_command_stays_and_one_without_a_contact_is_at_its_base():
    second = Contact(1, "side", (0.0, -0.05), (0.0, 1.0), 0.03)
    made = world(BOX, (second,))
    start = made.start(Pose2(), Pose2(), 0.01)
    assert start.tips[0].position == (0.3, 0.2, 0.1)
    assert start.tips[1].position == pytest.approx((0.0, -0.08, 0.03))
    after = made.step(start, (None, None))
    assert after == start
    pushed = made.step(start, (None, command(velocity=(0.0, 0.05, 0.0))))
    assert pushed.tips[0] == start.tips[0]
    assert pushed.tips[1].position[1] > -0.08


def test_a_push_too_high_tips_the_object():
    tall = Box((0.1, 0.1, 0.4))
    low, high = (Contact(0, "side", (-0.05, 0.0), (1.0, 0.0), h) for h in (0.05, 0.3))
    for contact, tips in ((low, False), (high, True)):
        made = world(tall, (contact,), support=0.4)
        run = states(made, (command(velocity=(0.05, 0.0, 0.0)),), 20)
        assert run[-1].tipping == tips


def test_two_equal_pushes_drive_a_box_straight_ahead():
    contacts = tuple(
        Contact(i, "side", (-0.075, y), (1.0, 0.0), 0.03)
        for i, y in enumerate((0.03, -0.03))
    )
    made = world(BOX, contacts)
    run = states(made, (command(velocity=(0.05, 0.0, 0.0)),) * 2, 250)
    end = run[-1].X_WB
    assert end.x > 0.04
    assert abs(end.y) < 1e-9
    assert abs(end.yaw) < 1e-9
    assert [tip.force[0] for tip in run[-1].tips] == pytest.approx([0.15 * GRAVITY] * 2)


def test_half_the_tick_ends_at_the_same_place():
    contact = Contact(0, "top", (0.2, 0.03), (0.0, 0.0), 0.1, 8.0)
    ends = []
    for dt in (0.004, 0.002):
        made = world(BAR, (contact,), mass=0.3, contact=0.9, dt=dt)
        drive = (command(force=(0.0, 0.0, -8.0), velocity=(0.03, 0.04, 0.0)),)
        ends.append(states(made, drive, round(4.0 / dt))[-1].X_WB)
    assert math.dist(ends[0].position, ends[1].position) < 2e-4
    assert ends[0].yaw == pytest.approx(ends[1].yaw, abs=2e-3)
