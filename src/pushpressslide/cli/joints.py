"""Choices as they are shown: by mechanics and reach, or as ``pps run`` judges them."""

from __future__ import annotations

from pushpressslide.core.plan import ENOUGH, Choice, Plan
from pushpressslide.core.task import Task
from pushpressslide.jobs.engines import DEFAULT, engine_named
from pushpressslide.selection.placement_planner import with_joint_paths
from pushpressslide.selection.select import select


def ranked(task: Task, joints: bool) -> list[Choice]:
    """Return all choices of a task; with ``joints`` as many evaluated in full as a run
    looks at, by the joint paths of the arms, too.
    """
    if not joints:
        return select(task)
    preparation = engine_named(DEFAULT).placement_planner(False)
    return with_joint_paths(preparation, Plan(task), select(task, ENOUGH))
