"""``pps select`` for a task with several goals, and descriptions of its stages."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path

import typer

from pushpressslide.cli.app import print_json
from pushpressslide.cli.tables import choice_rows, print_choices, write_selection
from pushpressslide.core.bodies import Stage
from pushpressslide.core.pose import wrap_angle
from pushpressslide.core.task import Task


def select_stages(task: Task, folder: Path | None, as_json: bool) -> None:
    """Rank the contact modes for each stage of a task. Write select.json if ``folder``
    is given.

    Raises InfeasibleTaskError if no plan brings all bodies to their goals.
    """
    from pushpressslide.selection.stages import plan_stages

    planned = plan_stages(task)
    stages = [
        {**asdict(one.stage), "choices": choice_rows(one.solution.choices)}
        for one in planned
    ]
    write_selection(task, {"stages": stages}, folder)
    if as_json:
        print_json({"schema": 1, "task": task.name, "stages": stages})
        return
    for number, one in enumerate(planned, start=1):
        typer.echo(stage_text(number, one.stage))
        print_choices(one.solution.choices)
    if folder is not None:
        typer.echo(folder / "select.json")


def stage_text(number: int, stage: Stage) -> str:
    """Purpose of a stage, in one line."""
    goal = stage.goal
    yaw = math.degrees(wrap_angle(goal.yaw))
    purpose = "aside to" if stage.aside else "to"
    place = f"({goal.x:.3f}, {goal.y:.3f}) m, {yaw:.0f} deg"
    return f"stage {number}: {stage.body} {purpose} {place}"
