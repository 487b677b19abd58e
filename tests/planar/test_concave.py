"""Concave objects on the planar engine: walls of a notch stop a tip, tasks reach their
goals.
"""

import math
from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core.control import TipCommand
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import ObjectModel, Task
from pushpressslide.geometry.shapes import Prism
from pushpressslide.planar.world import World, WorldState

RADIUS = 0.01
L_SHAPE = Prism(
    ((0.0, 0.0), (0.16, 0.0), (0.16, 0.06), (0.06, 0.06), (0.06, 0.16), (0.0, 0.16)),
    0.06,
)
DT = 0.004


def l_task(mass: float = 50.0, friction: float = 0.05) -> Task:
    """Return the task of an L; as heavy as it is, it does not move."""
    task = load_task("rear-push-rear")
    com = L_SHAPE.centroid
    hand = replace(task.robots[0], model="hand", tip_radius=RADIUS)
    return replace(
        task,
        object=ObjectModel(L_SHAPE, mass, com),
        robots=(hand,),
        contact_friction=friction,
        start=Pose2(),
    )


def inner_contact() -> Contact:
    """Return a contact on the inner face that looks to +y, 3 cm from the corner."""
    x, y = L_SHAPE.centroid
    return Contact(0, "side", (0.09 - x, 0.06 - y), (0.0, -1.0), 0.03)


def command(force: tuple[float, float], state: WorldState) -> TipCommand:
    """Return a command to push with a force [N] in the plane, with damping alone."""
    return TipCommand(
        force=(*force, 0.0),
        position=state.tips[0].position,
        velocity=(0.0, 0.0, 0.0),
        stiffness=(0.0, 0.0, 100.0),
        damping=(50.0, 50.0, 50.0),
        normal_yaw=-0.5 * math.pi,
        tool_yaw=0.0,
        tool_yaw_rate=0.0,
        servo_cap=10.0,
        progress=0.0,
    )


def pushed(force: tuple[float, float], seconds: float) -> list[WorldState]:
    """Return the states of an L whose inner face is touched with a force [N]."""
    task = l_task()
    world = World(task, (inner_contact(),), DT)
    states = [world.start(task.start, task.start, 0.0)]
    for _ in range(round(seconds / DT)):
        states.append(world.step(states[-1], (command(force, states[-1]),)))
    return states


@pytest.mark.parametrize("force", [(-2.0, -1.0), (-1.0, 0.0), (-3.0, -0.1)])
def test_a_tip_that_slides_along_a_face_is_stopped_by_the_other_wall(
    force: tuple[float, float],
) -> None:
    states = pushed(force, 4.0)
    for state in states:
        x, y, _ = state.tips[0].position
        assert x >= 0.06 + RADIUS - 1e-6
        assert y >= 0.06 + RADIUS - 1e-6
    x, y, _ = states[-1].tips[0].position
    assert x == pytest.approx(0.06 + RADIUS, abs=1e-5)
    if force[1] < 0.0:
        assert y == pytest.approx(0.06 + RADIUS, abs=1e-5)
        assert states[-1].contacts == ("stick",)
        # the corner gives what the tip asks for, along both walls
        fx, fy, _ = states[-1].tips[0].force
        assert (fx, fy) == pytest.approx(force, abs=0.02)


def test_a_tip_slides_on_along_the_face_where_no_wall_is() -> None:
    states = pushed((2.0, -1.0), 2.5)
    statuses = {state.contacts[0] for state in states[5:40]}
    assert statuses & {"slip_left", "slip_right"}
    x, _, _ = states[-1].tips[0].position
    assert x > 0.16  # off the end of the face


def test_a_tip_in_a_corner_moves_a_light_object_both_ways() -> None:
    task = l_task(mass=0.2)
    x, y = L_SHAPE.centroid
    corner = Contact(0, "side", (0.0702 - x, 0.06 - y), (0.0, -1.0), 0.03)
    world = World(task, (corner,), DT)
    state = world.start(task.start, task.start, 0.0)
    start = state.X_WB
    for _ in range(100):
        state = world.step(state, (command((-3.0, -3.0), state),))
    assert state.X_WB.x < start.x - 0.005
    assert state.X_WB.y < start.y - 0.005
    # the tip is still in its corner of the object, wherever that is
    at = state.X_WB.unapply(state.tips[0].position[:2])
    assert at[0] + x == pytest.approx(0.06 + RADIUS, abs=1e-3)
    assert at[1] + y == pytest.approx(0.06 + RADIUS, abs=1e-3)
