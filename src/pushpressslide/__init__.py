"""Push, press and slide objects with one or two robot arms: by reduced-order models and
closed-form control.

    import pushpressslide as pps
    task = pps.load_task("rear-push-rear")   # a shipped task, or the path of a YAML file
    choices = pps.select(task)               # every mode and placement, ranked
    plan = pps.plan(task, choices[0])        # pps.plan(task): the best, or several motions
    record = pps.run(plan, engine="planar")  # "drake", with arms: the extra drake
    record.success, record.figures["final_position_error"]

From a file and back
    load_task, dump_task, check_task, load_run, report
Parts of a task
    Task, Object, Support, Obstacle, Robot, Motion, Limits, Sensing, Tolerance, Pose2;
    shapes: Box, Cylinder, Prism, Compound, MeshSolid
From a task to a result
    select, Choice, plan, Plan, run, Record, result
The loop in your own program
    run_loop, RunLoop, RunOptions, Cell, Controller
Pushing with a flat finger
    push_sticks, FlatFinger
Packages: dir() lists their modules
    modes, mechanics, allocation, batch, planar
Errors, each with one line
    PushPressSlideError, TaskError, InfeasibleTaskError, SimulationError

Units are SI, angles are in radians. Every name is imported at its first use.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pushpressslide import allocation, batch, mechanics, modes, planar
    from pushpressslide.control.cell import Cell
    from pushpressslide.control.controller import Controller
    from pushpressslide.control.run_loop import (
        RunLoop,
        RunOptions,
        run_loop,
    )
    from pushpressslide.core.errors import (
        InfeasibleTaskError,
        PushPressSlideError,
        SimulationError,
        TaskError,
    )
    from pushpressslide.core.plan import (
        Choice,
        Plan,
    )
    from pushpressslide.core.pose import Pose2
    from pushpressslide.core.record import Record
    from pushpressslide.core.scene import (
        ObjectModel as Object,
    )
    from pushpressslide.core.scene import (
        Obstacle,
        Robot,
        Support,
    )
    from pushpressslide.core.task import (
        Limits,
        Motion,
        Sensing,
        Task,
        Tolerance,
    )
    from pushpressslide.geometry.shapes import (
        Box,
        Compound,
        Cylinder,
        MeshSolid,
        Prism,
    )
    from pushpressslide.jobs.ask import plan, select
    from pushpressslide.jobs.run import (
        measured_figures as result,
    )
    from pushpressslide.jobs.run import (
        run,
    )
    from pushpressslide.mechanics.line_push import (
        FlatFinger,
        push_sticks,
    )
    from pushpressslide.report.files import load_run
    from pushpressslide.report.page import write_report as report
    from pushpressslide.taskfile.load import (
        check_task,
        dump_task,
        load_task,
    )

    __version__: str

__all__ = [
    "Box",
    "Cell",
    "Choice",
    "Compound",
    "Controller",
    "Cylinder",
    "FlatFinger",
    "InfeasibleTaskError",
    "Limits",
    "MeshSolid",
    "Motion",
    "Object",
    "Obstacle",
    "Plan",
    "Pose2",
    "Prism",
    "PushPressSlideError",
    "Record",
    "Robot",
    "RunLoop",
    "RunOptions",
    "Sensing",
    "SimulationError",
    "Support",
    "Task",
    "TaskError",
    "Tolerance",
    "__version__",
    "allocation",
    "batch",
    "check_task",
    "dump_task",
    "load_run",
    "load_task",
    "mechanics",
    "modes",
    "plan",
    "planar",
    "push_sticks",
    "report",
    "result",
    "run",
    "run_loop",
    "select",
]

_ROOMS = frozenset({"mechanics", "allocation", "modes", "batch", "planar", "report"})
_HOMES = {
    "Box": "geometry.shapes.Box",
    "Choice": "core.plan.Choice",
    "Compound": "geometry.shapes.Compound",
    "Controller": "control.controller.Controller",
    "Cylinder": "geometry.shapes.Cylinder",
    "FlatFinger": "mechanics.line_push.FlatFinger",
    "InfeasibleTaskError": "core.errors.InfeasibleTaskError",
    "Limits": "core.motion.Limits",
    "MeshSolid": "geometry.shapes.MeshSolid",
    "Motion": "core.motion.Motion",
    "Object": "core.scene.ObjectModel",
    "Obstacle": "core.scene.Obstacle",
    "Plan": "core.plan.Plan",
    "Cell": "control.cell.Cell",
    "Pose2": "core.pose.Pose2",
    "Prism": "geometry.shapes.Prism",
    "PushPressSlideError": "core.errors.PushPressSlideError",
    "Record": "core.record.Record",
    "Robot": "core.scene.Robot",
    "RunLoop": "control.run_loop.RunLoop",
    "RunOptions": "control.run_loop.RunOptions",
    "Sensing": "core.sensing.Sensing",
    "SimulationError": "core.errors.SimulationError",
    "Support": "core.scene.Support",
    "Task": "core.task.Task",
    "TaskError": "core.errors.TaskError",
    "Tolerance": "core.motion.Tolerance",
    "check_task": "taskfile.load.check_task",
    "dump_task": "taskfile.load.dump_task",
    "load_run": "report.files.load_run",
    "load_task": "taskfile.load.load_task",
    "plan": "jobs.ask.plan",
    "push_sticks": "mechanics.line_push.push_sticks",
    "result": "jobs.run.measured_figures",
    "run": "jobs.run.run",
    "run_loop": "control.run_loop.run_loop",
    "select": "jobs.ask.select",
}
"""Module of each public name."""


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("pushpressslide")
    if name in _ROOMS:
        return importlib.import_module(f"pushpressslide.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'pushpressslide' has no attribute {name!r}")
    module, _, own = _HOMES[name].rpartition(".")
    value = getattr(importlib.import_module(f"pushpressslide.{module}"), own)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
