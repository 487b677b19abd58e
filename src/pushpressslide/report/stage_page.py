"""The report of a run in stages: the whole, and each stage's pictures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from pushpressslide.core.pose import wrap_angle
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import series, style
from pushpressslide.report.page import (
    again,
    columns,
    document,
    events,
    image,
    links,
    pictures,
    verdict,
    write_report,
)
from pushpressslide.report.page_tables import figures_tables, table
from pushpressslide.report.plane import path_figure, plan_figure
from pushpressslide.report.stage_files import load_stages, stage_folder
from pushpressslide.report.stages import StageRun
from pushpressslide.report.task_table import task_table


def write_stages_report(folder: Path, out: Path | None = None) -> Path:
    """Write the page of the run in stages in ``folder`` and return its path.

    Each stage has a page of its own too, which the first one links. Raises
    PushPressSlideError where the folder holds no finished run in stages.
    """
    run = load_stages(folder)
    out = folder / "report.html" if out is None else out
    parts = [
        f"<h1>{escape(run.task.name)}</h1><section>",
        verdict(run.result),
        events(run.result),
        f"<p>{escape(run.task.description)}</p>" if run.task.description else "",
        f'<p class="links">{links(folder, out)}</p>',
        pictures(folder),
        "<h3>Bodies</h3>",
        _bodies_table(run.result),
        "<h3>Stages</h3>",
        _stages_table(run.result),
        "<h3>Task</h3>",
        task_table(run.task, run.result),
        again(run.result),
        "<h3>Figures</h3>",
        columns(*figures_tables(run.result)),
        "</section>",
    ]
    for index, stage in enumerate(run.runs):
        write_report([stage_folder(folder, index)])
        parts.append(_stage_section(folder, index, stage))
    return write_whole(out, document(run.task.name, "".join(parts)))


def _stage_section(folder: Path, index: int, run: StageRun) -> str:
    """Return the pictures of a stage: what was planned, and what happened."""
    purpose = "put aside" if run.stage.aside else "to its goal"
    title = f"Stage {index + 1}: {run.stage.body}, {purpose}"
    shown = series.finite_part(run.record)
    parts = [
        f"<section><h2>{escape(title)}</h2>",
        f'<p class="links">{_links(folder, index)}</p>',
        columns(
            image(style.png(plan_figure(run.plan)), "plan", "The plan."),
            image(style.png(path_figure(run.plan, shown)), "path", "What happened."),
        ),
        "</section>",
    ]
    return "".join(parts)


def _links(folder: Path, index: int) -> str:
    """Return links to the pages of a stage that are there."""
    own = stage_folder(folder, index)
    return " ".join(
        f'<a class="button" href="stages/{index + 1}/{name}">{label}</a>'
        for name, label in (
            ("report.html", "All of this stage"),
            ("replay.html", "Watch it"),
            ("run.webp", "Video"),
        )
        if (own / name).is_file()
    )


def _bodies_table(result: Mapping[str, Any]) -> str:
    rows = []
    for name, body in result["bodies"].items():
        rows.append(
            [
                f"<th scope=row>{escape(name)}</th>",
                _pose_cell(body.get("goal")),
                _pose_cell(body["final_pose"]),
                _cell(body.get("position_error"), 1e3, " mm", 1),
                _cell(body.get("yaw_error"), math.degrees(1.0), "°", 2),
            ]
        )
    head = ("Body", "Goal", "Ended at", "Off by", "Turned by")
    return table(head, rows, numbers=4)


def _stages_table(result: Mapping[str, Any]) -> str:
    rows = []
    for number, stage in enumerate(result["stages"], start=1):
        reached = "yes" if stage["reached"] else "no"
        purpose = "put aside" if stage["aside"] else "goal"
        times = stage["time"] or (None, None)
        rows.append(
            [
                f"<td class=n>{number}</td>",
                f"<td>{escape(stage['body'])}</td>",
                f"<td>{purpose}</td>",
                f"<td>{escape(', '.join(stage['modes']))}</td>",
                f"<td>{reached}</td>",
                _pose_cell(stage["goal"]),
                _cell(times[0], 1.0, " s", 1),
                _cell(times[1], 1.0, " s", 1),
                _cell(stage["position_error"], 1e3, " mm", 1),
                _cell(stage["yaw_error"], math.degrees(1.0), "°", 2),
            ]
        )
    words = ("", "Body", "To", "Modes", "Reached")
    figures = ("Pose", "From", "Until", "Off by", "Turned by")
    return table((*words, *figures), rows, numbers=len(figures))


def _pose_cell(pose: list[float] | None) -> str:
    if pose is None:
        return "<td></td>"
    x, y, yaw = pose
    degrees = math.degrees(wrap_angle(yaw))
    return f"<td class=n>({x:.3f}, {y:.3f}) m, {degrees:.1f}°</td>"


def _cell(value: float | None, factor: float, unit: str, decimals: int) -> str:
    if value is None:
        return "<td></td>"
    return f"<td class=n>{factor * value:.{decimals}f}{unit}</td>"
