"""Top-level Python functions that select and plan. They check a task built in Python as
a task file is checked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.task import Task

if TYPE_CHECKING:
    from pushpressslide.core.plan import Choice, Plan


def select(task: Task, enough: int = 1) -> list[Choice]:
    """All choices for ``task``, the fastest feasible one first; never empty.

    A choice that is not feasible has a refusal: with the deciding number if it cannot
    do the task, or as skipped, with the reason, if ``enough`` choices of its mode are
    feasible or many are blocked. Joint paths are not planned here; ``run`` plans them.
    Raises TaskError for a task that no task file could describe.
    """
    from pushpressslide.selection import select as selection

    return selection.select(checked(task), enough)


def plan(task: Task, choice: Choice | None = None, *, force: bool = False) -> Plan:
    """Plan for ``choice``, by default the best one, or the best sequence of motions if
    no single motion suffices.

    Joint paths are not planned here; ``run`` plans them. In a task with legs, every
    other placement takes its best choice. ``force`` plans an infeasible choice too, if
    it has a path. Raises TaskError for a task that no task file could describe, and
    InfeasibleTaskError with the reasons if the task is infeasible.
    """
    from pushpressslide.jobs.remedy import remedies_named
    from pushpressslide.selection import solve

    known = checked(task)
    with remedies_named(known):
        return solve.plan(known, choice, force=force)


def checked(task: object) -> Task:
    """A task checked as a task file is. Raises TaskError for a task that no task file
    could describe.

    Raises PushPressSlideError for an object that is not a task.
    """
    from pushpressslide.taskfile.load import check_task

    if not isinstance(task, Task):
        raise PushPressSlideError(
            f"task: {task!r} is not allowed; allowed: a Task; load_task(name or path) "
            "returns one"
        )
    check_task(task)
    return task
