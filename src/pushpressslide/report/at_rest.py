"""Record of a task without motion: the object is at its goal already."""

from __future__ import annotations

import numpy as np

from pushpressslide.core.control import PHASES
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record


def record_at_rest(plan: Plan, engine: str) -> Record:
    """Record of a single sample, the object's pose at rest, made without an engine.

    ``engine`` is the name of the requested engine.
    """
    X = plan.task.true_start
    pose = np.array([(X.x, X.y, X.yaw)])
    arrays = {
        "time": np.zeros(1),
        "phase": np.full(1, float(PHASES.index("done"))),
        "object_pose": pose,
        "placement": np.zeros(1),
        "stretch": np.zeros(1),
        "leg": np.zeros(1),
        "plan_path": pose,
        "plan_stretch": np.zeros(1),
    }
    text = "the object is at its goal already"
    meta = {}
    if not plan.task.sensing.exact_pose:
        believed = plan.task.start
        seen = [believed.x, believed.y, believed.yaw]
        meta["last_look"] = {"pose": seen, "spread": [0.0, 0.0]}
    return Record(arrays, "goal_reached", text, str(engine), 0, 0.0, (), plan, meta)
