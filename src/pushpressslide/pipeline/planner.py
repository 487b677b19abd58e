"""From a choice to a plan: the timed path of the tracking point."""

from __future__ import annotations

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.task import Task
from pushpressslide.modes import MODES
from pushpressslide.pipeline.selection import select


def plan(task: Task, choice: Choice | None = None, *, force: bool = False) -> Plan:
    """Return the plan for ``choice`` (default: the best one).

    ``force`` plans an infeasible choice all the same, as far as it has a path. Raises InfeasibleTaskError
    with the reasons, one per choice, where nothing can do the task.
    """
    if choice is None:
        choices = select(task)
        usable = [c for c in choices if c.path is not None and (c.feasible or force)]
        if not usable:
            raise InfeasibleTaskError(refusal(task, choices))
        choice = usable[0]
    if choice.path is None or not (choice.feasible or force):
        raise InfeasibleTaskError(refusal(task, [choice]))
    following = None
    for stretch in reversed(choice.stretches):
        assert stretch.path is not None
        speed = stretch.parameters.get("speed", task.motion.speed)
        profile = SpeedProfile(stretch.path.length, speed, task.motion.acceleration)
        frame = MODES[stretch.mode].vehicle_frame(stretch)
        following = Plan(task, stretch, stretch.path, profile, frame, following)
    assert following is not None
    return following


def refusal(task: Task, choices: list[Choice]) -> str:
    """Return one line that says for each choice why it cannot do the task."""
    reasons = "; ".join(f"{c.mode}: {c.reason}" for c in choices if not c.feasible)
    return f"{task.source or task.name}: no mode can do this task: {reasons}"
