"""From a choice to a plan: the timed path of the tracking point."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.task import Task
from pushpressslide.modes import MODES
from pushpressslide.selection.select import grasps

NUMBER = re.compile(r"-?\d+(\.\d+)?")


def plan(task: Task, choice: Choice | None = None, *, force: bool = False) -> Plan:
    """Return the plan for ``choice`` (default: the best one); of a task with legs, the
    best choice does every grasp but that one.

    ``force`` plans an infeasible choice all the same, as far as it has a path. Raises
    InfeasibleTaskError with the reasons, one per choice, where nothing can do the task.
    """
    if choice is not None and not task.legs:
        return grasp(task, choice, force=force)
    plans = []
    for choices in grasps(task):
        given = (
            [choice] if choice is not None and choice.leg == choices[0].leg else choices
        )
        plans.append(grasp(task, usable(task, given, force=force)[0], force=force))
    return chained(plans)


def usable(task: Task, choices: list[Choice], *, force: bool = False) -> list[Choice]:
    """Return the choices that can do their part of the task, or with ``force`` just
    have a path for it.

    Raises InfeasibleTaskError where there is none.
    """
    found = [c for c in choices if c.path is not None and (c.feasible or force)]
    if not found:
        raise InfeasibleTaskError(refusal(task, choices))
    return found


def grasp(task: Task, choice: Choice, *, force: bool = False) -> Plan:
    """Return the plan of one choice and nothing after it; raises InfeasibleTaskError as
    ``plan``.
    """
    usable(task, [choice], force=force)
    parts = task.parts
    following = None
    for stretch in reversed(choice.stretches):
        assert stretch.path is not None
        part = parts[stretch.leg]
        speed = stretch.parameters.get("speed", part.motion.speed)
        profile = SpeedProfile(stretch.path.length, speed, part.motion.acceleration)
        frame = MODES[stretch.mode].vehicle_frame(stretch)
        following = Plan(part, stretch, stretch.path, profile, frame, following)
    assert following is not None
    return following


def chained(plans: Sequence[Plan]) -> Plan:
    """Return the plans of single grasps as one, in order."""
    first, *rest = plans
    return replace(first, next_grasp=chained(rest)) if rest else first


def refusal(task: Task, choices: list[Choice]) -> str:
    """Return one line that says why no choice can do the task."""
    legs = task.parts
    by_leg = {c.leg: [d for d in choices if d.leg == c.leg] for c in choices}
    refused = next(
        (of for of in by_leg.values() if not any(c.feasible for c in of)), choices
    )
    part = legs[refused[0].leg]
    fitting = [c for c in refused if MODES[c.mode].arms == len(task.robots)] or refused
    reasons = "; ".join(
        f"{c.mode}: {c.reason}" for c in gathered(fitting) if not c.feasible
    )
    return f"{part.source or part.name}: no mode can do this task: {reasons}"


def gathered(choices: Sequence[Choice]) -> list[Choice]:
    """Return the choices without repetition: of refused ones of a mode whose reasons
    differ in their numbers only the first, which says how many more there are.
    """
    alike: dict[tuple[str, str], list[Choice]] = {}
    for i, choice in enumerate(choices):
        kind = str(i) if choice.feasible else NUMBER.sub("", choice.reason)
        alike.setdefault((choice.mode, kind), []).append(choice)
    return [
        replace(first, reason=f"{first.reason} ({len(more)} more like this)")
        if more
        else first
        for first, *more in alike.values()
    ]
