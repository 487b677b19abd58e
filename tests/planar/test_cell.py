"""The planar cell keeps the contract of the run loop."""

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import Plan
from pushpressslide.planar.cell import planar_cell
from pushpressslide.planar.engine import run


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Two arms, two placements."""
    return pps.plan(pps.load_task("pivot-and-move"))


def test_it_starts_with_the_object_at_its_true_start(plan: Plan) -> None:
    cell = planar_cell(plan)
    seen = cell.tracker.read()
    assert seen is not None
    assert cell.clock.time == seen.time == 0.0
    start = plan.task.true_start
    assert seen.X_WG.position == pytest.approx(start.position)
    assert seen.X_WG.yaw == pytest.approx(start.yaw)


def test_to_read_changes_nothing(plan: Plan) -> None:
    cell = planar_cell(plan)
    for arm in cell.arms:
        arm.send(None)
    cell.clock.advance()
    assert cell.tracker.read() == cell.tracker.read()
    for arm in cell.arms:
        assert arm.read() == arm.read()


def test_without_commands_nothing_moves_but_time(plan: Plan) -> None:
    cell = planar_cell(plan)
    before = cell.tracker.read()
    tips = [arm.read().tip.position for arm in cell.arms]
    for _ in range(3):
        cell.clock.advance()
    after = cell.tracker.read()
    assert before is not None
    assert after is not None
    assert after.time == pytest.approx(3.0 * plan.task.motion.control_period)
    assert after.X_WG == before.X_WG
    assert [arm.read().tip.position for arm in cell.arms] == tips
    assert cell.witness is not None
    assert cell.witness.observe().twist == (0.0, 0.0, 0.0)
    assert cell.clock.failure() is None


def test_a_hand_over_leaves_the_tips_where_they_are(plan: Plan) -> None:
    """They travel to their next contacts as they are commanded."""
    cell = planar_cell(plan)
    before = [arm.read() for arm in cell.arms]
    cell.placements.hand_over(plan.by_placement[1], frozenset({0}))
    assert [arm.read() for arm in cell.arms] == before


def test_an_object_that_is_led_over_the_edge_of_its_table_tips() -> None:
    """The table is cut off after the plan is made."""
    made = pps.plan(pps.load_task("rear-push-rear"))
    end = made.task.goal.y + 0.05
    region = ((0.0, end), (1.0, end), (1.0, 1.0), (0.0, 1.0))
    task = replace(made.task, support=replace(made.task.support, region=region))
    record = run(replace(made, task=task))
    assert record.reason == "diverged"
    assert "tips over" in record.reason_text
