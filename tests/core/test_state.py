"""States between motions, and the tasks that begin in them."""

from dataclasses import replace

from pushpressslide import load_task
from pushpressslide.core.bodies import motion_task, start_state
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.state import OBJECT, Held, State

CONTACT = Contact(0, "top", (0.01, 0.0), (0.0, 0.0), 0.1, load=7.0)
AWAY = Pose2(0.6, 0.2, 0.3)


def test_a_state_has_every_body_that_can_be_moved() -> None:
    task = load_task("swap")
    movable = {obstacle.name for obstacle in task.obstacles if obstacle.movable}
    begin = start_state(task)
    assert set(begin.poses) == {OBJECT, *movable}
    assert begin.object == task.start


def test_what_is_held_is_the_same_however_hard_it_is_pressed() -> None:
    harder = replace(CONTACT, load=9.0)
    held = Held.by("press_slide", (CONTACT,))
    assert held == Held.by("press_slide", (harder,))
    assert held != Held.by("press_slide", (CONTACT.shifted((0.01, 0.0)),))
    assert held != Held.by("bimanual_press_slide", (CONTACT,))


def test_states_that_are_the_same_are_found_again() -> None:
    held = Held.by("press_slide", (CONTACT,))
    known = {State({OBJECT: AWAY}, ((0.1, 0.2),), held)}
    assert State({OBJECT: Pose2(0.6, 0.2, 0.3)}, ((0.1, 0.2),), held) in known
    assert State({OBJECT: AWAY}, ((0.1, 0.2),)) not in known
    assert State({OBJECT: AWAY}, ((0.1, 0.3),), held) not in known


def test_a_body_that_is_led_away_is_held_no_more() -> None:
    joints = ((0.1, 0.2),)
    begin = State({OBJECT: AWAY, "b": Pose2()}, joints, Held("press_slide", (CONTACT,)))
    led = begin.led("b", AWAY)
    assert led == State({OBJECT: AWAY, "b": AWAY}, joints)
    assert begin.poses["b"] == Pose2()


def test_the_task_of_a_motion_begins_in_its_state() -> None:
    task = load_task("swap")
    other = next(obstacle for obstacle in task.obstacles if obstacle.movable)
    there = Pose2(0.4, -0.2, 0.1)
    begin = start_state(task).led(other.name, AWAY).led(OBJECT, Pose2(0.5, 0.0, 0.0))
    part = motion_task(task, begin, there)
    assert (part.start, part.goal) == (Pose2(0.5, 0.0, 0.0), there)
    moved = next(o for o in part.obstacles if o.name == other.name)
    assert moved == replace(other, pose=AWAY)
    alone = motion_task(task, State({OBJECT: AWAY}), there)
    assert alone.obstacles == task.obstacles
