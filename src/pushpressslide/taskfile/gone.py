"""Fields of older task files that now belong to a run's execution."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from pushpressslide.core.errors import TaskError

EXECUTION = "control.execution.Execution"
GONE: Mapping[str, tuple[object, str]] = {
    "velocity_servo": (True, f"{EXECUTION}(servo=False)"),
    "force_gain": (None, f"{EXECUTION}(force_gain=...)"),
    "joint_tracking": (False, f"{EXECUTION}(joint_stiffness=10.0)"),
    "joint_stiffness": (10.0, f"{EXECUTION}(joint_stiffness=...)"),
    "fixed_target": (False, "pushpressslide_studies.paper.execution.FixedTarget"),
}
"""Removed fields of ``motion``: the value that every run now uses, and the replacement
for other values.
"""


def without_gone(data: Mapping[Any, Any], source: str, ran: bool) -> dict[Any, Any]:
    """Plain data of a file without the removed fields.

    Raises TaskError for a value that runs no longer take from a task, unless the task
    belongs to a finished run (``ran``).
    """
    out = _without(data, "", source, ran)
    if isinstance(out.get("legs"), list):
        out["legs"] = [
            _without(leg, f"legs[{i}].", source, ran) if isinstance(leg, dict) else leg
            for i, leg in enumerate(out["legs"])
        ]
    return out


def _without(
    data: Mapping[Any, Any], place: str, source: str, ran: bool
) -> dict[Any, Any]:
    """Data of a task or leg at ``place`` of the file, without the removed fields."""
    motion = data.get("motion")
    if not isinstance(motion, dict):
        return dict(data)
    if not ran:
        for name in GONE:
            if name in motion:
                _check(f"{place}motion.{name}", name, motion[name], source)
    kept = {name: value for name, value in motion.items() if name not in GONE}
    return {**data, "motion": kept}


def _check(field: str, name: str, value: object, source: str) -> None:
    usual, instead = GONE[name]
    same = value == usual and isinstance(value, bool) == isinstance(usual, bool)
    if not same:
        shown = json.dumps(usual)
        allowed = f"allowed: {shown}, or no such field; to run otherwise: {instead}"
        raise TaskError(source, field, value, allowed)
