"""Torques required by a contact, by the arm's own statics."""

import pushpressslide as pps
from pushpressslide.arms.paths.effort import largest_share
from pushpressslide.arms.paths.joint_path import joint_path
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.sim.arm_model import DrakeArmModel

HEAVY = ["motion.press_force=72", "object.mass=3.0"]


def shares(overrides: list[str]) -> tuple[float, float]:
    """Return those of the way there, and of the way back with the same postures."""
    light = pps.plan(pps.load_task("press-slide"))
    plan = pps.plan(pps.load_task("press-slide", overrides))
    path, _ = joint_path(DRAKE, light)
    (segment,) = light.segments
    bodies = [segment.body_pose(s) for s in path.arc_length]
    contact = plan.contacts[0]
    model = DrakeArmModel(plan.task.robots[0])
    there = largest_share(plan, contact, model, path.move, bodies)
    back = largest_share(plan, contact, model, path.move[::-1], bodies[::-1])
    return there, back


def test_a_heavy_press_takes_more_than_a_wrist_has() -> None:
    few = max(shares([]))
    many = max(shares(HEAVY))
    assert 0.2 < few < 0.5
    assert many > few + 0.2


def test_a_drag_counts_the_way_that_it_goes() -> None:
    """Dragged one way, the object helps the arm to bear its own weight."""
    there, back = shares(HEAVY)
    assert abs(there - back) > 0.1
