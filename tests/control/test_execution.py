"""Laws of a run that an experiment can change."""

import pushpressslide as pps
from pushpressslide.control.execution import Execution
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.planar.engine import run

NEAR = ["goal.x=0.50", "goal.y=0.22", "goal.yaw_deg=0"]  # only the end counts
QUICK = ["motion.recoveries=0", "motion.control_period=0.01", "limits.time=20"]
PLAN = pps.plan(pps.load_task("rear-push-rear", NEAR + QUICK))


def test_the_record_says_what_was_changed_and_nothing_else() -> None:
    usual = run(PLAN)
    assert "execution" not in usual.meta
    alone = run(PLAN, RunOptions(execution=Execution(servo=False, force_gain=1.03)))
    assert "force_gain=1.03" in alone.meta["execution"]
    assert alone.arrays["time"][-1] != usual.arrays["time"][-1]


def test_what_is_as_in_every_run_is_no_change() -> None:
    assert Execution().changed is None
    changed = Execution(joint_stiffness=10.0)
    assert changed.changed == repr(changed)


def test_a_force_alone_is_a_little_above_friction() -> None:
    assert Execution().gain == 1.0
    assert 1.0 < Execution(servo=False).gain < 1.2
    assert Execution(force_gain=0.9).gain == 0.9
