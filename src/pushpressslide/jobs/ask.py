"""Top-level Python functions that select and plan. Tasks built in Python are checked
like task files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING, Any

from pushpressslide.core.errors import TaskError
from pushpressslide.core.task import Task
from pushpressslide.jobs.engines import DEFAULT

if TYPE_CHECKING:
    from pushpressslide.core.plan import Choice, Plan
    from pushpressslide.taskfile.yaml_text import Overrides

AnyTask = Task | str | PathLike[str] | Mapping[str, Any]
"""A task, or any argument of ``load_task``."""


def select(task: AnyTask, enough: int = 1) -> list[Choice]:
    """All choices for ``task``, the fastest feasible one first; never empty.

    A choice that is not feasible has a refusal. If it cannot do the task, the refusal
    contains the deciding number. If ``enough`` choices of its mode are feasible, or too
    many are blocked, it is skipped and the refusal says why. Joint paths are not
    planned here but by ``run``. A tier's world is that of seed 0. Raises TaskError for
    a task that no task file could describe.
    """
    from pushpressslide.jobs.tiers import drawn_world
    from pushpressslide.selection import select as selection

    return selection.select(drawn_world(checked(task)), enough)


def plan(
    task: AnyTask,
    choice: Choice | str | None = None,
    *,
    force: bool = False,
    engine: str = DEFAULT,
) -> Plan:
    """Plan for ``choice``. By default it is the best choice, or the best sequence of
    motions if no single motion suffices.

    The name of a mode stands for its best choice.

    Joint paths are not planned here but by ``run``. In a task with legs, all other
    placements take their best choices. With ``force`` an infeasible choice is planned
    too, if it has a path. A tier's world is that of seed 0, for the plan and each run of
    it by ``engine``. Raises TaskError for a task that no task file could describe,
    and InfeasibleTaskError with the reasons if the task is infeasible.
    """
    from pushpressslide.core.plan import Choice
    from pushpressslide.jobs.hopes import of_first_hope
    from pushpressslide.jobs.remedy import remedies_named
    from pushpressslide.jobs.tiers import drawn_world
    from pushpressslide.selection import solve

    if isinstance(choice, str):
        known = checked(task, mode=choice)
        choice = None
    elif choice is None or isinstance(choice, Choice):
        known = checked(task)
    else:
        allowed = "allowed: a Choice, as select returns them, or the name of a mode"
        raise TaskError("", "choice", choice, allowed)
    world = drawn_world(known, engine=engine)
    with remedies_named(world):
        if choice is not None or force:
            return solve.plan(world, choice, force=force)
        return of_first_hope(world, solve.plan)


def checked(
    task: AnyTask, overrides: Overrides = (), *, mode: str | None = None
) -> Task:
    """Task, checked like a task file. If ``mode`` is given, it is the only mode.

    Raises TaskError for a task that no task file could describe, and for an argument
    that is not a task.
    """
    from pushpressslide.taskfile.load import check_task, load_task

    if not isinstance(task, Task):
        task = load_task(task, overrides)
    elif mode is None or overrides:
        task = check_task(task, overrides)
    return task if mode is None else check_task(replace(task, modes=(mode,)))
