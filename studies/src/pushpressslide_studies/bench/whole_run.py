"""A whole run in Drake compared with a simulation that plays back the run's torques,
and the times of the run's ticks.
"""

from __future__ import annotations

import math
import statistics

import numpy as np

from pushpressslide.core.plan import ENOUGH
from pushpressslide_studies.bench.compared import Row

TASKS = (
    "rear-push-rear",
    "press-slide",
    "pivot",
    "parallel-push",
    "orthogonal-push",
    "bimanual-slide",
)
ROUNDS = 5


def runs() -> list[Row]:
    """A row for each shipped task: the time of a tick in a run, the time of planning,
    and the ratio of the run's wall time to a playback of its torques.

    Both are the best of five rounds.
    """
    return [_row(name) for name in TASKS]


def _row(name: str) -> Row:
    from pushpressslide.control.run_loop import RunOptions
    from pushpressslide.jobs.engines import ArmOptions, engine_named
    from pushpressslide.selection.solve import solve
    from pushpressslide.taskfile.load import load_task
    from pushpressslide_studies.sim.playback import played_back

    task = load_task(name)
    engine = engine_named("drake")
    preparation = engine.placement_planner(False)
    solution = solve(preparation, task, ENOUGH)
    records = []
    played = []
    arms = ArmOptions(paths=preparation.paths)
    for _ in range(ROUNDS):
        record = engine.run(solution.plan, RunOptions(0), arms)
        records.append(record)
        played.append(played_back(solution.plan, record))
    whole = [record.wall_time for record in records]
    physics = [playback.wall_time for playback in played]
    ratios = [run / alone for run, alone in zip(whole, physics, strict=True)]
    simulated = float(records[0].arrays["time"][-1]) + task.motion.control_period
    ticks = [record.arrays["tick_total"] for record in records]
    pose = records[0].arrays["object_pose_3d"][-1]
    distances = math.dist(played[0].object_pose[4:], pose[4:])
    return {
        "task": name,
        "tick_us": 1e6 * min(float(np.median(t)) for t in ticks),
        "p99_us": 1e6 * min(float(np.percentile(t, 99)) for t in ticks),
        "longest_us": 1e6 * min(float(t.max()) for t in ticks),
        "late": min(int((t > task.motion.control_period).sum()) for t in ticks),
        "run_over_played_back": statistics.median(ratios),
        "wall_per_simulated": min(whole) / simulated,
        "planned_s": sum(solution.planning_time.values()),
        "apart_mm": 1e3 * distances,
    }
