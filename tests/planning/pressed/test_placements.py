"""Order in which presses are tried: firm ones before those that a creep turns."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from pushpressslide.core import margins
from pushpressslide.core.task import Task
from pushpressslide.planning.pressed.placements import press_placements, turned_by_tool
from pushpressslide.taskfile.load import load_task


@pytest.fixture
def task() -> Task:
    """A light cylinder on a support nearly as rough as the tip: the safest press has 12
    times its weight. The tip is so small that it holds the object's turn nowhere.
    """
    overrides = (
        "object.shape={cylinder: {radius: 0.041, height: 0.073}}",
        "object.mass=0.22",
        "support.friction=0.48",
        "contact.friction=0.74",
        "motion.contacts=null",
        "robots.0.tip_radius=0.005",
    )
    return load_task("press-slide", overrides)


def lever(task: Task, point: tuple[float, float], load: float) -> float:
    """Return the distance [m] from the centre of pressure to a press, written out."""
    weight = task.object.mass * 9.81
    return math.hypot(*point) * weight / (weight + load)


def test_firm_presses_come_first(task: Task) -> None:
    groups = press_placements(task.query).turning(task.scene)
    firm = [
        all(
            lever(task, press.point, press.load) >= margins.ARM.firm_lever
            for press in group
        )
        for group in groups
    ]
    assert True in firm
    assert False in firm
    assert firm == sorted(firm, reverse=True)
    loads = [
        group[0].load for group, is_firm in zip(groups, firm, strict=True) if is_firm
    ]
    assert loads == sorted(loads, reverse=True)


@pytest.mark.parametrize("radius", [0.005, 0.01, 0.02])
def test_only_presses_whose_tip_holds_the_turn_are_left_out(
    task: Task, radius: float
) -> None:
    task = replace(task, robots=(replace(task.robots[0], tip_radius=radius),))
    placements = press_placements(task.query)
    groups = placements.turning(task.scene)
    presses = {(press.point, press.load) for group in groups for press in group}
    every = [
        replace(place, load=load)
        for place in placements.contacts
        for load in placements.loads
    ]
    turned = [p for p in every if turned_by_tool(task.scene, p)]
    assert presses == {(press.point, press.load) for press in turned}


def test_a_heavy_object_has_the_safest_press_first(task: Task) -> None:
    heavy = replace(task, object=replace(task.object, mass=0.6))
    rough = replace(heavy, contact_friction=1.2)
    groups = press_placements(rough.query).turning(rough.scene)
    assert groups[0][0].load == max(press_placements(rough.query).loads)
