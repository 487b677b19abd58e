"""Push, press and slide objects with one or two robot arms: by reduced-order models and
closed-form control.

    import pushpressslide as pps
    task = pps.load_task("task.yaml")
    choice = pps.select(task)[0]
    plan = pps.plan(task, choice)
    record = pps.run(plan, engine="drake")

Everything here is imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pushpressslide import modes
    from pushpressslide.core.errors import (
        InfeasibleTaskError,
        PushPressSlideError,
        SimulationError,
        TaskError,
    )
    from pushpressslide.jobs.run import run
    from pushpressslide.mechanics.line_push import FlatFinger, push_sticks
    from pushpressslide.selection.select import select
    from pushpressslide.selection.solve import plan
    from pushpressslide.taskfile.load import check_task, dump_task, load_task

    __version__: str

__all__ = [
    "FlatFinger",
    "InfeasibleTaskError",
    "PushPressSlideError",
    "SimulationError",
    "TaskError",
    "__version__",
    "check_task",
    "dump_task",
    "load_task",
    "modes",
    "plan",
    "push_sticks",
    "run",
    "select",
]

_HOMES = {
    "FlatFinger": "mechanics.line_push",
    "InfeasibleTaskError": "core.errors",
    "PushPressSlideError": "core.errors",
    "SimulationError": "core.errors",
    "TaskError": "core.errors",
    "check_task": "taskfile.load",
    "dump_task": "taskfile.load",
    "load_task": "taskfile.load",
    "plan": "selection.solve",
    "push_sticks": "mechanics.line_push",
    "run": "jobs.run",
    "select": "selection.select",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("pushpressslide")
    if name == "modes":
        return importlib.import_module("pushpressslide.modes")
    if name not in _HOMES:
        raise AttributeError(f"module 'pushpressslide' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"pushpressslide.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
