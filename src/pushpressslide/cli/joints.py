"""Choices as ``pps run`` judges them: by the joint paths of the arms, too."""

from __future__ import annotations

from pushpressslide.core.plan import ENOUGH, Choice
from pushpressslide.core.task import Task
from pushpressslide.jobs.engines import DEFAULT, engine_named
from pushpressslide.selection.preparation import with_joint_paths
from pushpressslide.selection.select import select


def looked_at(task: Task) -> list[Choice]:
    """Return all choices of a task, as many judged in full as a run looks at."""
    preparation = engine_named(DEFAULT).preparation(False)
    return with_joint_paths(preparation, task, select(task, ENOUGH))
