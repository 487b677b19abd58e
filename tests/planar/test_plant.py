"""The planar plant keeps what the run loop relies on."""

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import Plan
from pushpressslide.planar.engine import run
from pushpressslide.planar.plant import PlanarPlant


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Two arms, two placements."""
    return pps.plan(pps.load_task("pivot-and-move"))


def test_it_starts_with_the_object_at_its_true_start(plan: Plan) -> None:
    plant = PlanarPlant(plan)
    assert plant.time == 0.0
    pose = plant.measure().object_pose
    start = plan.task.true_start
    assert pose.position == pytest.approx(start.position)
    assert pose.yaw == pytest.approx(start.yaw)


def test_to_measure_changes_nothing(plan: Plan) -> None:
    plant = PlanarPlant(plan)
    plant.apply((None, None))
    plant.advance()
    assert plant.measure() == plant.measure()


def test_without_commands_nothing_moves_but_time(plan: Plan) -> None:
    plant = PlanarPlant(plan)
    before = plant.measure()
    for _ in range(3):
        plant.apply((None, None))
        plant.advance()
    after = plant.measure()
    assert after.time == pytest.approx(3.0 * plan.task.motion.control_period)
    assert after.object_pose == before.object_pose
    assert [tip.position for tip in after.tips] == [tip.position for tip in before.tips]
    assert plant.row().object_twist == (0.0, 0.0, 0.0)
    assert plant.diverged() is None


def test_a_hand_over_leaves_the_tips_where_they_are(plan: Plan) -> None:
    """They travel to their next contacts as they are commanded."""
    plant = PlanarPlant(plan)
    before = plant.measure().tips
    plant.hand_over(plan.by_placement[1], frozenset({0}))
    assert plant.measure().tips == before


def test_an_object_that_is_led_over_the_edge_of_its_table_tips() -> None:
    """The table is cut off after the plan is made."""
    made = pps.plan(pps.load_task("rear-push-rear"))
    end = made.task.goal.y + 0.05
    region = ((0.0, end), (1.0, end), (1.0, 1.0), (0.0, 1.0))
    task = replace(made.task, support=replace(made.task.support, region=region))
    record = run(replace(made, task=task))
    assert record.reason == "diverged"
    assert "tips over" in record.reason_text
