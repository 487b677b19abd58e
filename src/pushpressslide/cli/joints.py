"""Choices for display: evaluated by mechanics and reach, or in full as in ``pps run``."""

from __future__ import annotations

from pushpressslide.core.plan import ENOUGH, Choice, Plan
from pushpressslide.core.task import Task
from pushpressslide.jobs.engines import DEFAULT, engine_named
from pushpressslide.selection.placement_planner import with_joint_paths
from pushpressslide.selection.select import select


def ranked(task: Task, joints: bool) -> list[Choice]:
    """All choices of a task, ranked.

    With ``joints``, as many choices as in a run are evaluated in full, including the
    arms' joint paths.
    """
    if not joints:
        return select(task)
    preparation = engine_named(DEFAULT).placement_planner(False)
    return with_joint_paths(preparation, Plan(task), select(task, ENOUGH))
