"""Force and position of a press."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core import margins
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.plan import Contact
from pushpressslide.core.refusal import RefusedError
from pushpressslide.core.task import Box, Cylinder, ObjectModel, Prism, Task
from pushpressslide.mechanics.pressing import (
    friction_use,
    least_lever,
    least_load,
    lever_refusal,
    press_loads,
)
from pushpressslide.mechanics.top import inside_top, room_inside, top_places
from pushpressslide.planning.pressed.placements import turned_by_tool
from pushpressslide.taskfile.load import load_task

BAR = ObjectModel(Box((0.6, 0.2, 0.1)), 0.3, (0.0, 0.0))


def test_the_least_press_uses_all_of_its_friction() -> None:
    load = least_load(10.0, 0.3, 0.6)
    assert load == pytest.approx(0.3 * 10.0 / 0.3)
    assert friction_use(load, 10.0, 0.3, 0.6) == pytest.approx(1.0)
    assert least_load(10.0, 0.3, 0.3) == math.inf


def light(mass: float, load: float, place: float, mu_contact: float = 0.8) -> Task:
    """A bar of a ``mass`` [kg], pressed on its long axis with ``load`` [N]."""
    base = load_task("press-slide")
    motion = replace(base.motion, contacts=((place, 0.0),), press_force=load)
    body = replace(base.object, mass=mass)
    return replace(base, object=body, contact_friction=mu_contact, motion=motion)


@given(st.floats(0.005, 1.0), st.floats(3.0, 40.0), st.floats(0.35, 1.0))
def test_at_the_least_lever_drag_and_tip_hold_each_other(
    mass: float, load: float, mu_contact: float
) -> None:
    scene = light(mass, load, 0.2, mu_contact).scene
    lever = least_lever(scene, load)
    drag = scene.support.friction * (mass * GRAVITY + load)
    held = mu_contact * load * margins.PATCH * scene.tip_radius
    assert drag * lever == pytest.approx(held)
    press = Contact(0, "top", (0.2, 0.0), (0.0, 0.0), 0.1, load)
    own = 0.2 * mass * GRAVITY / (mass * GRAVITY + load)
    refusal = lever_refusal(scene, press)
    assert (refusal is None) == (own >= lever)
    if refusal is not None:
        assert refusal.figure == pytest.approx(own)
        assert refusal.allowed == pytest.approx(lever)
    turned = turned_by_tool(scene, press)
    assert turned == (margins.HELD_TURN * own >= lever)


def test_what_the_object_pushes_is_dragged_along_too() -> None:
    loads = press_loads(5.0, 0.3, 0.9, 60.0, pushed=4.4)
    assert friction_use(loads[0], 5.0, 0.3, 0.9, 4.4) == pytest.approx(0.7)
    assert loads[0] == pytest.approx((0.3 * 5.0 + 4.4) / (0.7 * 0.9 - 0.3))
    with pytest.raises(
        RefusedError, match=r"straight sliding takes 1\.64 of its friction"
    ) as caught:
        press_loads(5.0, 0.3, 0.9, 60.0, 5.0, pushed=4.4)
    refusal = caught.value.refusal
    assert (refusal.code, refusal.allowed) == ("friction", margins.FRICTION_USES[-1])
    assert refusal.figure == pytest.approx(friction_use(5.0, 5.0, 0.3, 0.9, 4.4))


def test_the_papers_bar_needs_a_friction_ratio_of_1_368() -> None:
    assert friction_use(8.0, 2.943, 0.3, 1.368 * 0.3) == pytest.approx(1.0, abs=1e-3)
    with pytest.raises(RefusedError, match="slips before the object"):
        press_loads(2.943, 0.3, 1.3 * 0.3, 60.0, 8.0)
    assert press_loads(2.943, 0.3, 1.5 * 0.3, 60.0, 8.0) == [8.0]


def test_a_tip_no_rougher_than_the_support_is_told_so() -> None:
    with pytest.raises(RefusedError, match="must exceed") as caught:
        press_loads(10.0, 0.4, 0.4, 60.0)
    refusal = caught.value.refusal
    assert (refusal.code, refusal.figure, refusal.allowed) == ("smooth_tip", 0.4, 0.4)


@pytest.mark.parametrize(
    "body",
    [
        BAR,
        ObjectModel(Cylinder(0.1, 0.1), 1.0, (0.02, 0.01)),
        ObjectModel(
            Prism(((0.1, 0.0), (-0.05, 0.09), (-0.05, -0.09)), 0.1), 1.0, (0.0, 0.0)
        ),
    ],
)
def test_places_on_top_are_inside_its_outline(body: ObjectModel) -> None:
    places = top_places(body, 0.012)
    assert len(places) > 20
    for place in places:
        assert inside_top(body, place, 0.0119)
        assert room_inside(body, place) > 0.0
    assert not inside_top(body, (1.0, 0.0), 0.0)
    assert room_inside(body, (1.0, 0.0)) < 0.0


@pytest.mark.parametrize("pushed", [0.0, 1.5])
def test_with_the_friction_that_a_refusal_says_is_needed_the_press_is_just_allowed(
    pushed: float,
) -> None:
    with pytest.raises(RefusedError) as caught:
        press_loads(2.943, 0.3, 0.35, 60.0, 8.0, pushed=pushed)
    needed = float(str(caught.value.refusal).rpartition("needed ")[2])
    assert friction_use(8.0, 2.943, 0.3, needed, pushed) == pytest.approx(
        margins.FRICTION_USES[-1], abs=2e-3
    )


def test_under_any_cap_that_the_least_press_keeps_a_press_is_found_the_safest_first() -> (
    None
):
    every = press_loads(10.0, 0.3, 0.6, math.inf)
    assert every == sorted(every, reverse=True)
    for least, cap in enumerate(every):
        assert press_loads(10.0, 0.3, 0.6, 1.001 * cap) == every[least:]
    with pytest.raises(RefusedError, match="needs a press of"):
        press_loads(10.0, 0.3, 0.6, 0.999 * every[-1])
