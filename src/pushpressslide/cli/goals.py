"""``pps select`` for a task of several goals, and texts on stages."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path

import typer

from pushpressslide.cli.app import print_json
from pushpressslide.cli.tables import choice_rows, print_choices
from pushpressslide.core.bodies import Stage
from pushpressslide.core.pose import wrap_angle
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole


def select_stages(task: Task, folder: Path, as_json: bool) -> None:
    """Rank the contact modes for each stage of a task and write select.json.

    Raises InfeasibleTaskError if no plan brings all bodies to their goals.
    """
    from pushpressslide.report.json_text import to_json
    from pushpressslide.selection.stages import plan_stages

    planned = plan_stages(task)
    data = {
        "schema": 1,
        "task": task.name,
        "stages": [
            {**asdict(one.stage), "choices": choice_rows(one.solution.choices)}
            for one in planned
        ],
    }
    write_whole(folder / "select.json", to_json(data))
    if as_json:
        print_json(data)
        return
    for number, one in enumerate(planned, start=1):
        typer.echo(stage_text(number, one.stage))
        print_choices(one.solution.choices)
    typer.echo(folder / "select.json")


def stage_text(number: int, stage: Stage) -> str:
    """Purpose of a stage, in one line."""
    goal = stage.goal
    yaw = math.degrees(wrap_angle(goal.yaw))
    purpose = "aside to" if stage.aside else "to"
    place = f"({goal.x:.3f}, {goal.y:.3f}) m, {yaw:.0f} deg"
    return f"stage {number}: {stage.body} {purpose} {place}"
