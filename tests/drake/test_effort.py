"""The torques that a contact takes, by the arm's own statics."""

import pushpressslide as pps
from pushpressslide.sim.arm_model import ArmModel
from pushpressslide.sim.joints.effort import largest_share
from pushpressslide.sim.joints.joint_path import joint_path


def share(overrides: list[str]) -> float:
    light = pps.plan(pps.load_task("press-slide"))
    plan = pps.plan(pps.load_task("press-slide", overrides))
    path, _ = joint_path(light)
    (segment,) = light.segments
    bodies = [segment.body_pose(s) for s in path.arc_length]
    contact = plan.contacts[0]
    return largest_share(
        plan, contact, ArmModel(plan.task.robots[0]), path.move, bodies
    )


def test_a_heavy_press_takes_more_than_a_wrist_has() -> None:
    few = share([])
    many = share(["motion.press_force=72", "object.mass=3.0"])
    assert 0.2 < few < 0.5
    assert many > few + 0.2
