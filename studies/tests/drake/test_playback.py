"""A playback is the same run."""

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.jobs.engines import ArmOptions, engine_named
from pushpressslide.selection.solve import solve
from pushpressslide_studies.sim.playback import played_back


@pytest.mark.long
def test_recorded_torques_lead_to_the_same_end() -> None:
    task = pps.load_task("press-slide")
    whole = pps.plan(task)
    # 6 cm of its way
    task = replace(task, goal=whole.object_pose(whole.segments[0], 0.06))
    engine = engine_named("drake")
    preparation = engine.placement_planner(False)
    plan = solve(preparation, task, 1).plan
    from pushpressslide.control.run_loop import RunOptions

    record = engine.run(plan, RunOptions(0), ArmOptions(paths=preparation.paths))
    found = played_back(plan, record)
    pose = record.arrays["object_pose_3d"]
    assert math.dist(pose[0, 4:], pose[-1, 4:]) > 0.02
    assert math.dist(found.object_pose[4:], pose[-1, 4:]) < 1e-4
    assert found.wall_time > 0.0
