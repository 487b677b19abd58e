"""Presses offered, and their order."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide import load_task
from pushpressslide.core import margins
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.motion import PLANNED_SHARE
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Cylinder, ObjectModel, Task
from pushpressslide.jobs.sampling import random_task
from pushpressslide.mechanics.pressing import least_load, lever_refusal
from pushpressslide.modes.press_slide import MODE, dragged
from pushpressslide.planning.pressed.placements import turned_by_tool
from pushpressslide.planning.pressed.turns import steering_of
from pushpressslide.planning.pressed.vehicle import press_of
from pushpressslide.rom.drives import TurnDrive, UnicycleDrive

BASE = load_task("press-slide")
QUERY = BASE.query


MASS = 1.0  # [kg] of the bar: enough for friction to decide, not the least press


def bar(most: float) -> Task:
    """A low bar that is to go forward, planned to be pressed with up to ``most`` [N]."""
    return replace(
        BASE,
        object=ObjectModel(Box((0.5, 0.16, 0.02)), MASS, (0.0, 0.0)),
        contact_friction=0.9,
        start=Pose2(0.45, -0.2, 0.5 * math.pi),
        goal=Pose2(0.45, 0.2, 0.5 * math.pi),
        limits=replace(BASE.limits, normal_force=most / PLANNED_SHARE),
        motion=replace(BASE.motion, contacts=((0.12, 0.0),), press_force=None),
    )


def test_the_hardest_press_allowed_may_take_all_of_the_friction_that_is_allowed() -> (
    None
):
    load = least_load(MASS * GRAVITY, 0.3, 0.9, margins.FRICTION_USES[-1])
    assert load > margins.ARM.least_press
    choices = MODE.choices(bar(1.0001 * load).query)
    assert choices[0].feasible
    assert not any("pushed body" in choice.reason for choice in choices)


def test_a_press_that_does_not_steer_like_a_unicycle_is_tried_last() -> None:
    """The drag at the top of a high box moves the axle beyond a pulling contact; no
    manoeuvre ends in time.
    """
    task = random_task(BASE, 1, seed=2)
    shape = task.object.shape
    assert isinstance(shape, Box)
    length, width, height = shape.size
    high = Box((length, width, 1.3 * height))
    limits = replace(task.limits, time=60.0)
    task = replace(task, object=replace(task.object, shape=high), limits=limits)
    best = MODE.choices(task.query)[0]
    assert best.feasible
    assert "manoeuvre" not in best.reason
    drive = best.segments[-1].drive
    assert isinstance(drive, UnicycleDrive)
    press = press_of(task.scene, best.contacts[0])
    assert steering_of(press, drive.car.backward, task.motion.speed) == 0.0


@pytest.mark.parametrize("mass", [0.005, 0.01])
def test_a_body_that_turns_with_the_tool_is_refused_with_its_lever(
    mass: float,
) -> None:
    task = replace(BASE, object=replace(BASE.object, mass=mass))
    choices = MODE.choices(task.query)
    assert not any(choice.feasible for choice in choices)
    held = [c.refusal for c in choices if c.refusal and c.refusal.code == "held"]
    assert held
    lever = 0.2 * mass * GRAVITY / (mass * GRAVITY + 8.0)
    assert held[0].figure == pytest.approx(lever)
    assert "turns with the tool" in str(held[0])


def light_task(index: int) -> Task:
    """A small light object that is to go somewhere about a hand away."""
    rng = np.random.default_rng([601, index])
    length, width = rng.uniform(0.03, 0.15, 2).tolist()
    size = (length, width, float(rng.uniform(0.02, 0.1)))
    start = Pose2(0.5, 0.0, float(rng.uniform(-math.pi, math.pi)))
    ahead = float(rng.uniform(-math.pi, math.pi))
    way = (0.12 * math.cos(ahead), 0.12 * math.sin(ahead))
    turn = float(rng.uniform(-0.6, 0.6))
    support = float(rng.uniform(0.2, 0.6))
    robot = replace(BASE.robots[0], tip_radius=float(rng.uniform(0.005, 0.02)))
    return replace(
        BASE,
        object=ObjectModel(Box(size), float(rng.uniform(0.005, 0.1)), (0.0, 0.0)),
        start=start,
        goal=Pose2(*start.apply(way), start.yaw + turn),
        support=replace(BASE.support, friction=support),
        contact_friction=min(0.8, float(rng.uniform(1.2, 2.5)) * support),
        motion=replace(BASE.motion, contacts=None, press_force=None),
        robots=(robot,),
    )


@pytest.mark.parametrize("index", range(12))
def test_no_light_body_is_steered_where_the_tip_holds_its_turn(index: int) -> None:
    task = light_task(index)
    for choice in MODE.choices(task.query):
        if choice.feasible:
            (contact,) = choice.contacts
            turns = isinstance(choice.segments[0].drive, TurnDrive)
            if turns:
                assert turned_by_tool(task.scene, contact)
            else:
                assert lever_refusal(task.scene, contact) is None


def test_a_top_too_small_for_a_tip_is_refused_by_name() -> None:
    coin = ObjectModel(Cylinder(0.011, 0.02), 0.1, (0.0, 0.0))
    motion = replace(BASE.motion, contacts=None)
    task = replace(BASE, object=coin, motion=motion)
    (choice,) = MODE.choices(task.query)
    assert choice.refusal is not None
    assert choice.refusal.code == "off_top"
    assert "12 mm inside its edges" in choice.reason


def test_a_press_that_may_be_wrong_by_a_fifth_is_harder_and_farther_from_the_com() -> (
    None
):
    free = replace(BASE, motion=replace(BASE.motion, contacts=None, press_force=None))
    sure = MODE.choices(free.query)[0]
    told = replace(free.full_belief, friction_error=0.2, center_error=0.02)
    unsure = MODE.choices(replace(free, belief=told).query)
    assert unsure[0].feasible
    for choice in unsure:
        (contact,) = choice.contacts
        assert math.hypot(*contact.point) >= margins.SURE_LEVER * 0.02
        assert contact.load > sure.contacts[0].load


def test_where_the_com_is_known_too_badly_for_any_press_it_is_said() -> None:
    told = replace(BASE.full_belief, center_error=0.1)
    (choice,) = MODE.choices(replace(BASE, belief=told).query)
    assert choice.refusal is not None
    assert choice.refusal.code == "lever"
    assert "known to 100 mm" in choice.reason


def test_the_force_that_slides_the_object_tells_the_friction_of_its_support() -> None:
    contact = Contact(
        0, "top", (-0.05, 0.0), (0.0, 0.0), BASE.object.shape.height, 20.0
    )
    believed = BASE.scene.max_friction(20.0)

    def friction(ratio: float) -> float:
        """Return the friction believed after a drag of ``ratio`` times the believed."""
        return dragged(QUERY, contact, ratio * believed).scene.support.friction

    mu = BASE.scene.support.friction
    assert dragged(QUERY, contact, None) is QUERY
    assert friction(1.2) == pytest.approx(1.2 * mu)
    assert friction(0.8) == pytest.approx(0.8 * mu)
    # what a mean force may be off by, and what no friction explains
    assert friction(1.0 + 0.9 * margins.SURE_DRAG) == mu
    assert friction(9.0) == pytest.approx(margins.DRAG[1] * mu)
