"""The weight on a wall: along the plane, and its displacement of the centre of
pressure.
"""

import math
from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core import margins
from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.pressure import center_of_pressure
from pushpressslide.mechanics.wall import lean, lean_press, lever, weights

TASK = load_task("press-fit")
WEIGHT = 2.0 * 9.81


def test_the_weight_turns_backwards_in_the_body_as_it_turns() -> None:
    quarter = TwistPath.between((Pose2(), Pose2(0.0, 0.0, -0.5 * math.pi)), 0.3)
    first, *_, last = weights(TASK.scene, quarter)
    assert first == pytest.approx((0.0, -WEIGHT))
    assert last == pytest.approx((WEIGHT, 0.0))  # body x is down in the end


def test_on_a_table_there_is_none() -> None:
    table = load_task("bimanual-slide")
    assert weights(
        table.scene, TwistPath.between((Pose2(), Pose2(0.1, 0.0, 1.0)), 0.3)
    ) == [(0.0, 0.0)]
    assert lever(table.scene, 50.0) == 0.0 == lean_press(table.scene)
    assert lean(table.scene, table.goal, 10.0) == (0.0, 0.0)
    assert (table.scene.weight_along, table.scene.weight_on) == (
        (0.0, 0.0),
        pytest.approx(WEIGHT),
    )


def test_a_weight_that_the_tips_carry_at_the_top_moves_the_load_up_by_the_lever() -> (
    None
):
    load = 120.0
    # tips push up with the weight at the top, the weight pulls down at the middle;
    # nothing slides
    x, y = center_of_pressure(
        0.0,
        (0.0, 0.0),
        [0.5 * load] * 2,
        [(0.0, 0.25), (0.0, -0.25)],
        [(0.0, WEIGHT), (0.0, -WEIGHT)],
        [0.25, 0.125],
    )
    assert (x, y) == pytest.approx((0.0, lever(TASK.scene, load) * WEIGHT))
    # 20 mm at 120 N, as in docs/mechanics.md
    assert y == pytest.approx(0.0204, abs=1e-4)


def test_contacts_moved_by_the_lean_put_the_load_in_the_middle_at_the_goal() -> None:
    press = lean_press(TASK.scene)
    x, y = lean(TASK.scene, TASK.goal, press)
    # body x: the side that is down in the end
    assert (x, y) == pytest.approx((margins.LEAN * 0.125, 0.0))
    moved_by_weight = lever(TASK.scene, 2.0 * press) * WEIGHT
    assert x == pytest.approx(moved_by_weight)
    heavier = replace(TASK, object=replace(TASK.object, mass=4.0))
    assert lean_press(heavier.scene) == pytest.approx(2.0 * press)
