"""States between motions."""

from dataclasses import replace

from pushpressslide import load_task
from pushpressslide.core.bodies import start_state
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.state import OBJECT, HeldContacts, WorldState

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
    held = HeldContacts.by("press_slide", (CONTACT,))
    assert held == HeldContacts.by("press_slide", (harder,))
    assert held != HeldContacts.by("press_slide", (CONTACT.shifted((0.01, 0.0)),))
    assert held != HeldContacts.by("bimanual_press_slide", (CONTACT,))


def test_states_that_are_the_same_are_found_again() -> None:
    held = HeldContacts.by("press_slide", (CONTACT,))
    known = {WorldState({OBJECT: AWAY}, ((0.1, 0.2),), held)}
    assert WorldState({OBJECT: Pose2(0.6, 0.2, 0.3)}, ((0.1, 0.2),), held) in known
    assert WorldState({OBJECT: AWAY}, ((0.1, 0.2),)) not in known
    assert WorldState({OBJECT: AWAY}, ((0.1, 0.3),), held) not in known


def test_a_body_that_is_led_away_is_held_no_more() -> None:
    joints = ((0.1, 0.2),)
    begin = WorldState(
        {OBJECT: AWAY, "b": Pose2()}, joints, HeldContacts("press_slide", (CONTACT,))
    )
    led = begin.with_body_at("b", AWAY)
    assert led == WorldState({OBJECT: AWAY, "b": AWAY}, joints)
    assert begin.poses["b"] == Pose2()
