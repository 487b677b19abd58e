"""What ``pps select`` and ``pps plan`` do with a task of several goals: the same for
each of its stages.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import typer

from pushpressslide.cli.app import print_json
from pushpressslide.cli.tables import JOINT_PATHS, choice_rows, print_choices
from pushpressslide.cli.text import print_text
from pushpressslide.core.bodies import Stage
from pushpressslide.core.pose import wrap_angle
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole


def select_stages(task: Task, folder: Path, as_json: bool) -> None:
    """Rank the contact modes for each stage of a task; writes select.json.

    Raises InfeasibleTaskError where nothing brings all bodies to their goals.
    """
    from pushpressslide.report.json_text import to_json
    from pushpressslide.report.stage_files import stages_to_dict
    from pushpressslide.selection.stages import plan_stages

    planned = plan_stages(task)
    data = stages_to_dict(task, [one.stage for one in planned])
    for entry, one in zip(data["stages"], planned, strict=True):
        entry["choices"] = choice_rows(one.solution.choices)
    write_whole(folder / "select.json", to_json(data))
    if as_json:
        print_json(data)
        return
    for number, one in enumerate(planned, start=1):
        typer.echo(stage_text(number, one.stage))
        print_choices(one.solution.choices)
    typer.echo(folder / "select.json")


def plan_stages_into(task: Task, folder: Path, as_json: bool) -> None:
    """Plan the stages of a task; writes plan.json, and each stage's plan.json and
    plan.png.

    Raises InfeasibleTaskError where nothing brings all bodies to their goals.
    """
    from pushpressslide.report.json_text import to_json
    from pushpressslide.report.plan_files import plan_to_dict, write_plan
    from pushpressslide.report.stage_files import stage_folder, stages_to_dict
    from pushpressslide.selection.stages import plan_stages

    planned = plan_stages(task)
    data: dict[str, Any] = stages_to_dict(task, [one.stage for one in planned])
    write_whole(folder / "plan.json", to_json(data))
    for index, one in enumerate(planned):
        made = one.solution.plan
        own = stage_folder(folder, index)
        own.mkdir(parents=True, exist_ok=True)
        _, picture = write_plan(made, own, one.solution.choices)
        data["stages"][index]["plan"] = plan_to_dict(made)
        if as_json:
            continue
        modes = ", ".join(dict.fromkeys(segment.mode for segment in made.segments))
        text = f"{stage_text(index + 1, one.stage)}: {modes}, {made.duration:.1f} s"
        print_text(text, 4)
        typer.echo(f"    {picture}")
    if as_json:
        print_json(data)
        return
    typer.echo(JOINT_PATHS)
    typer.echo(folder / "plan.json")


def stage_text(number: int, stage: Stage) -> str:
    """Say what a stage is to do, in one line."""
    goal = stage.goal
    yaw = math.degrees(wrap_angle(goal.yaw))
    purpose = "aside to" if stage.aside else "to"
    place = f"({goal.x:.3f}, {goal.y:.3f}) m, {yaw:.0f} deg"
    return f"stage {number}: {stage.body} {purpose} {place}"
