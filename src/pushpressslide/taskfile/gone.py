"""Fields of older task files that are of a run's execution now."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
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
"""Of each field of ``motion``: the value that every run has, and what gives others."""


def without_gone(data: Mapping[Any, Any], source: str, ran: bool) -> dict[Any, Any]:
    """A file's plain data without the fields that are gone.

    Raises TaskError for a value that runs no longer take from a task, unless the task is
    that of a run that is over, ``ran``.
    """
    if not ran:
        for section, motion in _motions(data):
            for name in GONE.keys() & motion.keys():
                _check(f"{section}.{name}", name, motion[name], source)
    out = dict(data)
    if isinstance(out.get("motion"), dict):
        out["motion"] = _kept(out["motion"])
    if isinstance(out.get("legs"), list):
        out["legs"] = [_kept_of_leg(leg) for leg in out["legs"]]
    return out


def _motions(data: Mapping[Any, Any]) -> Iterator[tuple[str, dict[Any, Any]]]:
    """Each section of motion that is one, with its place."""
    legs = data.get("legs")
    found = [("motion", data.get("motion"))]
    for i, leg in enumerate(legs if isinstance(legs, list) else ()):
        if isinstance(leg, dict):
            found.append((f"legs[{i}].motion", leg.get("motion")))
    yield from ((place, motion) for place, motion in found if isinstance(motion, dict))


def _check(field: str, name: str, value: object, source: str) -> None:
    usual, instead = GONE[name]
    same = value == usual and isinstance(value, bool) == isinstance(usual, bool)
    if not same:
        shown = json.dumps(usual)
        allowed = f"allowed: {shown}, or no such field; to run otherwise: {instead}"
        raise TaskError(source, field, value, allowed)


def _kept(motion: Mapping[Any, Any]) -> dict[Any, Any]:
    return {name: value for name, value in motion.items() if name not in GONE}


def _kept_of_leg(leg: Any) -> Any:
    if not isinstance(leg, dict) or not isinstance(leg.get("motion"), dict):
        return leg
    return {**leg, "motion": _kept(leg["motion"])}
