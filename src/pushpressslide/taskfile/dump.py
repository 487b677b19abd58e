"""Conversion of a Task to the text of a task file, in the file's layout and units and
with every default.
"""

from __future__ import annotations

from typing import Any

import yaml

from pushpressslide.core.task import Task, ToolUse
from pushpressslide.taskfile.kinds import attributes
from pushpressslide.taskfile.layouts import POSE
from pushpressslide.taskfile.schema import SCHEMA


def task_data(task: Task) -> dict[str, Any]:
    """Plain data of the task in the layout and units of the file."""
    values = {**attributes(task), "legs": task.legs or None}
    values["goals"] = task.goals or None
    del values["source"], values["dares"]
    if task.tool is None:
        del values["tool"]
    plain: dict[str, Any] = SCHEMA.encode(values)
    if isinstance(task.tool, ToolUse):
        plain["goal"] = {**POSE.encode(task.tool.goal), "body": task.tool.body}
    if task.goals:
        plain["goal"] = None
    if task.legs and isinstance(plain["legs"][-1], dict):
        plain["legs"][-1]["pose"] = None  # the goal
    return plain


def dump_task(task: Task) -> str:
    """YAML text of a task with every default written out.

    Loading the text gives an equal task.
    """
    return yaml.safe_dump(
        task_data(task),
        sort_keys=False,
        default_flow_style=None,
        width=110,
        allow_unicode=True,
    )
