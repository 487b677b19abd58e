"""The report of one or more runs as one HTML file: images inside, nothing loaded from
elsewhere.
"""

from __future__ import annotations

import base64
import math
import os
from collections.abc import Mapping, Sequence
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.task import Box, Cylinder, Robot, Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import style
from pushpressslide.report.files import Run, load_run
from pushpressslide.report.page_tables import (
    comparison_table,
    contacts_table,
    figures_table,
    stretches_table,
    table,
)
from pushpressslide.report.plane import plan_figure
from pushpressslide.report.plots import comparison_plot, figures
from pushpressslide.selection.planner import gathered

CAPTIONS = {
    "path": "What happened: footprints at even steps of the contact phase, with the force at each.",
    "errors": "Object against the reference at the same time, in the contact phase.",
    "tracking": "What the tracking law saw at its own tracking point.",
    "axle": "Where the object turned about, on the line from CoM to contact; and tracking errors.",
    "forces": "Contact force in the contact's axes. The band is what friction allows that normal force.",
    "torques": "Joint torques as a share of the maker's limits.",
    "speeds": "Speed of the tracking point and yaw rate of the object.",
}


def write_report(dirs: Sequence[Path], out: Path | None = None) -> Path:
    """Write the page of the runs in ``dirs`` and return its path; also writes each
    run's plots/*.png.

    ``out``: the HTML file; default report.html in the run's folder, or for several runs
    in the folder that holds them all. Several runs are compared first. Raises
    PushPressSlideError where a folder holds no finished run.
    """
    if not dirs:
        raise PushPressSlideError(
            "report: no folder given; give at least one that `pps run` has written"
        )
    runs = [load_run(Path(folder)) for folder in dirs]
    if out is None:
        home = (
            runs[0].folder
            if len(runs) == 1
            else Path(os.path.commonpath([r.folder.resolve() for r in runs]))
        )
        out = home / "report.html"
    names = _labels(runs)
    title = runs[0].task.name if len(runs) == 1 else f"{len(runs)} runs"
    body = [f"<h1>{escape(title)}</h1>"]
    if len(runs) == 1:
        body.append(_run_section(runs[0], out, ""))
    else:
        body.append(_comparison(runs, names))
        body += [
            _run_section(run, out, name) for run, name in zip(runs, names, strict=True)
        ]
    return write_whole(out, document(title, "".join(body)))


def document(title: str, body: str) -> str:
    """Return a whole HTML page, its style inside, around ``body``."""
    css = (
        resources.files("pushpressslide.report").joinpath("page.css").read_text("utf-8")
    )
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)} - pushpressslide</title><style>{css}</style></head>\n"
        f"<body><main>{body}</main></body></html>\n"
    )


def image(data: bytes, alt: str, caption: str = "") -> str:
    """Return a PNG as an HTML figure with the picture inside."""
    text = f"<figcaption>{escape(caption)}</figcaption>" if caption else ""
    source = base64.b64encode(data).decode("ascii")
    return f'<figure><img alt="{escape(alt)}" src="data:image/png;base64,{source}">{text}</figure>'


def _labels(runs: Sequence[Run]) -> list[str]:
    """Short names that tell the runs apart: the task's if all differ, else the
    folder's.
    """
    tasks = [run.task.name for run in runs]
    if len(set(tasks)) == len(runs):
        return tasks
    folders = [run.folder.resolve().name for run in runs]
    return (
        folders
        if len(set(folders)) == len(runs)
        else [f"{i + 1}: {name}" for i, name in enumerate(folders)]
    )


def _comparison(runs: Sequence[Run], names: Sequence[str]) -> str:
    curves = [
        (name, run.record, run.task, run.plan)
        for name, run in zip(names, runs, strict=True)
    ]
    return (
        "<section><h2>Side by side</h2>"
        + comparison_table(names, [run.result for run in runs])
        + image(style.png(comparison_plot(curves)), "errors of all runs over time")
        + "</section>"
    )


def _run_section(run: Run, page: Path, name: str) -> str:
    result = run.result
    won = bool(result["success"])
    plots = {}
    for key, made in figures(run.task, run.plan, run.record).items():
        plots[key] = style.png(made)
        write_whole(run.folder / "plots" / f"{key}.png", plots[key])
    links = " ".join(
        f'<a class="button" href="{escape(_link(run.folder / file, page))}">{label}</a>'
        for file, label in (
            ("replay.html", "Watch the replay"),
            ("result.json", "result.json"),
            ("task.yaml", "task.yaml"),
        )
        if (run.folder / file).is_file()
    )
    parts = [
        f"<h2>{escape(name)}</h2>" if name else "",
        f'<p class="verdict {"good" if won else "bad"}">'
        f"<strong>{'Goal reached' if won else 'Goal missed'}</strong> "
        f"<code>{escape(str(result['reason']['code']))}</code> "
        f"{escape(str(result['reason']['text']))}</p>",
        f"<p>{escape(run.task.description)}</p>" if run.task.description else "",
        f'<p class="links">{links}</p>',
        "<h3>Task</h3>",
        _task_table(run.task, run.result),
        "<h3>Choice of mode</h3>",
        _choice_part(run),
        image(
            style.png(plan_figure(run.plan)),
            "plan",
            "The plan, made before anything moves.",
        ),
        stretches_table(run.plan),
        "<h3>Figures</h3>",
        figures_table(result),
        "<h3>Contacts</h3>",
        contacts_table(run.plan, result),
        "<h3>Plots</h3>",
        *(image(data, key, _caption(key)) for key, data in plots.items()),
    ]
    return f"<section>{''.join(parts)}</section>"


def _caption(key: str) -> str:
    """What a figure shows; one of several grasps has its number behind the name."""
    name, _, grasp = key.partition("-")
    return f"Grasp {grasp}. {CAPTIONS[name]}" if grasp else CAPTIONS[name]


def _link(target: Path, page: Path) -> str:
    return Path(os.path.relpath(target.resolve(), page.resolve().parent)).as_posix()


def _pose(x: float, y: float, yaw: float) -> str:
    return f"({x:.3f}, {y:.3f}) m, {math.degrees(yaw):.1f}°"


def _robot(robot: Robot) -> str:
    x, y, z = robot.base
    name = Path(robot.model).name
    return name if robot.model == "hand" else f"{name} at ({x:g}, {y:g}, {z:g}) m"


def _with_belief(true: float, believed: float, unit: str = "") -> str:
    return f"{true:g}{unit}" + (
        f" (believed {believed:g}{unit})" if believed != true else ""
    )


def _task_table(task: Task, result: Mapping[str, Any]) -> str:
    shape = task.object.shape
    if isinstance(shape, Box):
        form = "box " + " × ".join(f"{1e3 * v:g}" for v in shape.size) + " mm"
    elif isinstance(shape, Cylinder):
        form = f"cylinder, radius {1e3 * shape.radius:g} mm, height {1e3 * shape.height:g} mm"
    else:
        form = (
            f"prism on {len(shape.polygon)} corners, height {1e3 * shape.height:g} mm"
        )
    belief = task.believed
    mu = _with_belief(task.support.friction, belief.support_friction)
    mu_c = _with_belief(task.contact_friction, belief.contact_friction)
    mass = _with_belief(task.object.mass, belief.mass, " kg")
    tool = []
    if task.tool is not None:
        end = task.tool.goal
        tool = [
            (
                f"Goal of {task.tool.body}",
                _pose(end.x, end.y, end.yaw) + f", pushed by face {task.tool.face}",
            )
        ]
    rows = [
        ("Object", f"{form}, {mass}"),
        ("Friction", f"{task.support.kind} {mu}, end effector {mu_c}"),
        ("Start", _pose(task.start.x, task.start.y, task.start.yaw)),
        ("Goal", _pose(task.goal.x, task.goal.y, task.goal.yaw)),
        *tool,
        (
            "Tolerance",
            f"{1e3 * task.tolerance.position:g} mm, "
            f"{math.degrees(task.tolerance.yaw):g}°",
        ),
        ("Robots", "; ".join(_robot(robot) for robot in task.robots)),
    ]
    error = task.start_error
    if (error.x, error.y, error.yaw) != (0.0, 0.0, 0.0):
        rows.insert(3, ("True start, off by", _pose(error.x, error.y, error.yaw)))
    if task.obstacles:
        rows.append(
            (
                "Obstacles",
                ", ".join(
                    o.name + (" (can move)" if o.movable else "")
                    for o in task.obstacles
                ),
            )
        )
    step = result.get("time_step")
    pace = f", time step {1e3 * step:g} ms" if step else ""
    rows.append(("Engine", f"{result['engine']}, seed {result['seed']}{pace}"))
    return table(
        (),
        [[f"<th scope=row>{escape(k)}</th>", f"<td>{escape(v)}</td>"] for k, v in rows],
    )


def _choice_part(run: Run) -> str:
    taken = run.plan.chosen(run.choices)
    rows = []
    for choice, reason in gathered(run.choices):
        chosen = choice in taken
        margin = (
            ""
            if choice.friction_margin is None
            else f"{math.degrees(choice.friction_margin):.1f}°"
        )
        cells = (
            ("chosen" if chosen else choice.verdict, ""),
            (choice.mode, ""),
            ("" if choice.path_length is None else f"{choice.path_length:.3f} m", "n"),
            ("" if choice.time is None else f"{choice.time:.1f} s", "n"),
            (margin, "n"),
            (reason, "why"),
        )
        mark = (
            ' class="chosen"'
            if chosen
            else ' class="refused"'
            if not choice.feasible
            else ""
        )
        rows.append(
            [
                f"<td{f' class={css}' if css else ''}>{escape(text)}</td>"
                for text, css in cells
            ]
            + [mark]
        )
    head = ("", "Mode", "Path", "Time", "Friction margin", "Why")
    return table(head, [row[:-1] for row in rows], [row[-1] for row in rows])
