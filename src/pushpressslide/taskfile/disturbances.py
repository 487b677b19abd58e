"""Checks of the disturbances of a task file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pushpressslide.taskfile.place import Fault

PAIRS = (("time", "share"), ("ball", "push"))
"""Fields of a knock of which exactly one is given."""


def disturbance_faults(plain: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield faults for knocks without one beginning and one cause, for a second ball,
    and for knocks of a task with several goals.
    """
    knocks = plain["disturbances"]
    if knocks and plain["goals"]:
        allowed = "allowed: [] in a task with goals"
        yield "disturbances", knocks, allowed
    balls = 0
    for i, knock in enumerate(knocks):
        for one, other in PAIRS:
            if (knock[one] is None) == (knock[other] is None):
                value = {one: knock[one], other: knock[other]}
                allowed = f"allowed: {one} or {other}, one of them"
                yield f"disturbances[{i}]", value, allowed
        balls += knock["ball"] is not None
        if balls > 1:
            yield (
                f"disturbances[{i}].ball",
                knock["ball"],
                "allowed: one ball in a task",
            )
