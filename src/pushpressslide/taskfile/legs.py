"""The legs of a task: how they differ from the task's motion, and their end poses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Leg
from pushpressslide.taskfile.place import Fault


def inherited(data: Mapping[str, Any]) -> dict[str, Any]:
    """Plain data of the file with the task's ``motion`` in each leg.

    Fields given in the leg itself are kept. Anything that is not a section is left to
    the reader.
    """
    motion = data.get("motion") or {}
    legs = data.get("legs")
    if not (isinstance(motion, dict) and isinstance(legs, list)):
        return dict(data)
    return {**data, "legs": [_with_motion(leg, motion) for leg in legs]}


def _with_motion(leg: Any, motion: Mapping[str, Any]) -> Any:
    if not isinstance(leg, dict):
        return leg
    own = leg.get("motion") or {}
    if not isinstance(own, dict):
        return leg
    return {**leg, "motion": {**motion, **own}}


def legs_to(goal: Pose2, legs: tuple[Leg, ...] | None) -> tuple[Leg, ...]:
    """Legs of the file, the last one to ``goal``."""
    if legs is None:
        return ()
    return (*legs[:-1], replace(legs[-1], goal=goal))


def leg_faults(plain: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield faults for modes or a tool that conflict with the legs, for a leg without
    an end pose, for an end pose in the last leg, and for a leg with another time step.
    """
    legs = plain["legs"] or []
    goal = plain["goal"] or {"body": None}
    modes = plain["modes"]
    either = "a task has legs or this; allowed: one of the two"
    # legs that were found keep the modes from which they were
    if modes is not None and not {leg["mode"] for leg in legs} <= set(modes):
        yield "modes", modes, f"{either}, or all modes of the legs"
    if legs and goal["body"] not in (None, "object"):
        yield "goal.body", goal["body"], either
    for i, leg in enumerate(legs):
        field = f"legs[{i}]"
        pose = leg["pose"]
        last = leg is legs[-1]
        if last and pose is not None:
            allowed = "allowed: null for the last leg, which ends at the goal"
            yield f"{field}.pose", pose, allowed
        if pose is None and not last:
            yield f"{field}.pose", None, "it is missing"
        for name in ("control_period", "time_step"):
            value = leg["motion"][name]
            period = plain["motion"][name]
            if value != period:
                allowed = f"allowed: motion.{name} of the task, {period:g} s"
                yield f"{field}.motion.{name}", value, allowed
