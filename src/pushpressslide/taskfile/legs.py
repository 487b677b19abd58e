"""The legs of a task: what each does otherwise than the task says, and where it ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Leg, Motion


def inherited(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the file's plain data with the task's ``motion`` in each leg that does not
    have it otherwise; what is no section is left to the reader.
    """
    motion = data.get("motion") or {}
    legs = data.get("legs")
    if not (isinstance(motion, dict) and isinstance(legs, list)):
        return dict(data)
    full = []
    for leg in legs:
        own = (leg.get("motion") or {}) if isinstance(leg, dict) else None
        full.append(
            {**leg, "motion": {**motion, **own}} if isinstance(own, dict) else leg
        )
    return {**data, "legs": full}


def legs(d: Mapping[str, Any], goal: Pose2, source: str) -> tuple[Leg, ...]:
    """Return the legs of read data ``d``, the last one to ``goal``.

    Raises TaskError beside ``modes`` or a tool, and for a leg without a pose that is
    not the last, or with one that is.
    """
    items = d["legs"] or ()
    for field in ("modes", "tool") if items else ():
        given = d["modes"] if field == "modes" else d["goal"]["body"]
        if given not in (None, "object"):
            name = "modes" if field == "modes" else "goal.body"
            raise TaskError(
                source, name, given, "a task has legs or this; allowed: one of the two"
            )
    out = []
    for i, leg in enumerate(items):
        last = i == len(items) - 1
        pose = leg["pose"]
        if (pose is None) != last:
            allowed = (
                "allowed: null for the last leg, which ends at the goal"
                if last
                else "it is missing"
            )
            raise TaskError(source, f"legs[{i}].pose", pose, allowed)
        end = (
            goal if last else Pose2(pose["x"], pose["y"], math.radians(pose["yaw_deg"]))
        )
        for field in ("control_period", "time_step"):
            given = leg["motion"][field]
            of_task = d["motion"][field]
            if given != of_task:
                allowed = f"allowed: motion.{field} of the task, {of_task:g} s"
                raise TaskError(source, f"legs[{i}].motion.{field}", given, allowed)
        out.append(Leg(leg["mode"], end, Motion(**leg["motion"])))
    return tuple(out)
