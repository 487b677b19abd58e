"""Mode selection: every mode and contact placement that the task's robots allow, judged and ranked."""

from __future__ import annotations

import math

from pushpressslide.core.plan import Choice
from pushpressslide.core.task import Task
from pushpressslide.modes import MODES


def select(task: Task) -> list[Choice]:
    """Return all choices for ``task``, feasible ones first and the quickest first; never empty.

    A choice that cannot do the task says in ``reason`` why not, with the number that decides.
    """
    out: list[Choice] = []
    names = task.modes if task.modes is not None else tuple(MODES)
    for name in names:
        mode = MODES[name]
        if mode.arms != len(task.robots):
            out.append(Choice(name, False, f"needs {mode.arms} arm(s), the task has {len(task.robots)}"))
        else:
            out.extend(mode.choices(task))
    return sorted(out, key=lambda c: (not c.feasible, c.time if c.time is not None else math.inf))
