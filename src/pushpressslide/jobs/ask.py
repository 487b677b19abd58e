"""What Python asks for at the top: a task that was built there is checked as a file is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.task import Task

if TYPE_CHECKING:
    from pushpressslide.core.plan import Choice, Plan


def select(task: Task, enough: int = 1) -> list[Choice]:
    """Return all choices for ``task``, the quickest feasible one first; never empty.

    A choice that cannot do the task has a refusal with the number that decides; or it
    was passed over because ``enough`` choices of its mode are feasible and at least as
    fast. Joint paths are not looked at: ``run`` looks for them. Raises TaskError for a task that a
    file could not say.
    """
    from pushpressslide.selection import select as selection

    return selection.select(checked(task), enough)


def plan(task: Task, choice: Choice | None = None, *, force: bool = False) -> Plan:
    """Return the plan for ``choice``, by default the best one, or the best sequence of
    motions where none does it alone.

    Joint paths are not looked at: ``run`` looks for them. Of a task with legs, the best
    choice does every placement but that one. ``force`` plans an infeasible choice all
    the same, as far as it has a path. Raises TaskError for a task that a file could not
    say, and InfeasibleTaskError with the reasons where nothing can do it.
    """
    from pushpressslide.selection import solve

    return solve.plan(checked(task), choice, force=force)


def checked(task: object) -> Task:
    """Return a task that a file could say; else raise TaskError.

    What is no task at all is a PushPressSlideError.
    """
    from pushpressslide.taskfile.load import check_task

    if not isinstance(task, Task):
        raise PushPressSlideError(
            f"task: {task!r} is not allowed; allowed: a Task; load_task(name or path) "
            "returns one"
        )
    check_task(task)
    return task
