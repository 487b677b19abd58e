"""Tables of modes, choices and results, in millimetres, degrees, newtons, seconds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich import box
from rich.console import Console
from rich.padding import Padding
from rich.table import Table

from pushpressslide.cli.text import print_text
from pushpressslide.cli.wide_table import print_table
from pushpressslide.core.pose import wrap_angle
from pushpressslide.planning.segments import describe_points
from pushpressslide.selection.planner import gathered

if TYPE_CHECKING:
    from pushpressslide.core.plan import Choice, Plan
    from pushpressslide.core.task import Task
    from pushpressslide.modes.base import Mode

JOINT_PATHS = (
    "Not checked: whether the arm's joints can follow. `pps select --joints` checks it, "
    "and `pps run` in Drake does; it then takes another contact or a sequence."
)
"""Note on choices that were ranked without joint paths."""

MISSING = "-"
"""Shown for a figure that does not apply."""


def simple_table(*headings: str) -> Table:
    """An empty table of named columns, the first one never wrapped."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for i, heading in enumerate(headings):
        table.add_column(heading, overflow="fold", no_wrap=i == 0)
    return table


def _print(table: Table) -> None:
    print_table(table, Console(markup=False, highlight=False))


def _number(value: object, scale: float = 1.0, digits: int = 2) -> str:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return MISSING
    return f"{value * scale:.{digits}f}"


def mode_rows(modes: Iterable[Mode[Any]]) -> list[dict[str, Any]]:
    """Properties of each mode of the library, as plain data."""
    return [
        {
            "mode": mode.name,
            "arms": mode.arms,
            "reduced_model": mode.reduced_model,
            "tracking_point": mode.tracking_point,
            "cop_steering": mode.cop_steering,
        }
        for mode in modes
    ]


def print_modes(rows: Iterable[Mapping[str, Any]]) -> None:
    """Print the library of modes."""
    table = simple_table(
        "mode", "arms", "reduced model", "tracking point", "CoP steering"
    )
    for row in rows:
        steering = "yes" if row["cop_steering"] else "no"
        texts = (row["mode"], str(row["arms"]), row["reduced_model"])
        table.add_row(*texts, row["tracking_point"], steering)
    _print(table)


def choice_rows(choices: Iterable[Choice]) -> list[dict[str, Any]]:
    """Ranked choices as plain data, SI units, without their paths."""
    from pushpressslide.report.plan_files import drive_to_dict

    return [
        {
            "mode": choice.mode,
            "feasible": choice.feasible,
            "evaluated": choice.evaluated,
            "reason": choice.reason,
            "contacts": [asdict(contact) for contact in choice.contacts],
            "path_length": choice.path_length,
            "time": choice.time,
            "friction_margin": choice.friction_margin,
            "refusal": None if choice.refusal is None else asdict(choice.refusal),
            "drives": [drive_to_dict(segment.drive) for segment in choice.segments],
            "leg": choice.leg,
        }
        for choice in choices
    ]


def print_choices(choices: Sequence[Choice], joints: bool = False) -> None:
    """Print the ranked choices, each with its reason below it.

    ``joints`` says that their joint paths were checked.
    """
    console = Console(markup=False, highlight=False)
    console.print(*choice_lines(choices), sep="\n")
    if not joints:
        console.print(JOINT_PATHS)


def choice_lines(choices: Sequence[Choice]) -> list[str | Padding]:
    """Lines of ranked choices, each with its reason below it."""
    row = "{:<22}{:<12}{:>8}{:>8}{:>11}"
    lines: list[str | Padding] = [
        row.format("mode", "verdict", "path m", "time s", "margin deg")
    ]
    for choice, reason in gathered(choices):
        figures = (
            _number(choice.path_length, digits=3),
            _number(choice.time, digits=1),
            _number(choice.friction_margin, math.degrees(1.0), 1),
        )
        lines.append(row.format(choice.mode, choice.verdict, *figures))
        lines.append(Padding(reason, (0, 0, 0, 4)))
    return lines


def write_selection(task: Task, fields: Mapping[str, Any], folder: Path | None) -> None:
    """Write ``fields`` of a task as select.json if ``folder`` is given."""
    from pushpressslide.core.whole_file import write_whole
    from pushpressslide.report.json_text import to_json

    if folder is not None:
        data = {"schema": 1, "task": task.name, **fields}
        write_whole(folder / "select.json", to_json(data))


def print_legs(plan: Plan) -> None:
    """Print the motions of a plan of several motions, and the obstacles that it may
    push.
    """
    yielding = plan.query.yielding
    if yielding:
        names = ", ".join(obstacle.name for obstacle in yielding)
        modes = ", ".join(
            dict.fromkeys(one_segment.mode for one_segment in plan.segments)
        )
        print_text(f"{modes}, which may push movable obstacles: {names}", 4)
    if not plan.task.legs:
        return
    count = len(plan.task.legs)
    print_text(f"{count} motions, one after the other:")
    for number, placement in enumerate(plan.placements, start=1):
        contacts = describe_points(contact.point for contact in placement[0].contacts)
        print_text(f"contact {number}: {placement[0].mode} at {contacts}", 4)
        for leg in sorted({segment.leg for segment in placement}):
            goal = plan.task.legs[leg].goal
            print_text(
                f"    {leg + 1}. to ({goal.x:.3f}, {goal.y:.3f}) m, "
                f"{math.degrees(wrap_angle(goal.yaw)):.0f} deg"
            )


def _print_stages(stages: Sequence[Mapping[str, Any]]) -> None:
    """Print the result of each stage."""
    if len(stages) < 2:
        return
    for number, stage in enumerate(stages, start=1):
        reached = "reached" if stage["reached"] else "not reached"
        purpose = "aside" if stage["aside"] else "to its goal"
        modes = ", ".join(stage["modes"]) or "not begun"
        text = f"stage {number}: {stage['body']} {purpose}, {modes}, {reached}"
        if stage["time"] is not None:
            text += f" at {stage['time'][1]:.1f} s"
        print_text(text, 4)


def print_result(result: Mapping[str, Any], folder: Path) -> None:
    """Print the figures of a run, and the location of its pages."""
    from pushpressslide.report.parameters import parameter_lines

    table = simple_table("figure", "value", "unit")
    reason = result["reason"]
    modes = ", ".join(result["modes"])
    reached = {True: "yes", False: "no", None: "unknown"}[result["success"]]
    verified = "yes" if result["verified"] else "no"
    table.add_row("goal reached", f"{reached} ({reason['code']})", "")
    table.add_row("verified", verified, "")
    table.add_row("mode, engine", f"{modes}, {result['engine']}", "")
    for name, key, scale, digits, unit in (
        ("final position error", "final_position_error", 1e3, 2, "mm"),
        ("final yaw error", "final_yaw_error", math.degrees(1.0), 2, "deg"),
        ("path error, rms", "path_rms_error", 1e3, 2, "mm"),
        ("time, whole / contact", "duration", 1.0, 1, "s"),
        ("largest normal force", "max_normal_force", 1.0, 1, "N"),
        ("contact lost", "contact_loss_time", 1.0, 2, "s"),
        ("outside friction cone", "cone_violation_fraction", 100.0, 2, "%"),
        ("slip of the tip", "slip_distance", 1e3, 1, "mm"),
        ("real-time factor", "realtime_factor", 1.0, 1, ""),
    ):
        shown = _number(result.get(key), scale, digits)
        if key == "duration":
            shown += f" / {_number(result.get('motion_duration'), scale, digits)}"
        table.add_row(name, shown, unit)
    _print(table)
    _print_stages(result.get("stages", ()))
    for event in result["events"]:
        goes_on = (
            "replanned" if event["recovered"] else f"no recovery: {event['lacking']}"
        )
        text = f"{event['time']:.1f} s: {event['code']}, {event['text']}; {goes_on}"
        print_text(text, 4)
    if not (result["success"] and result["verified"]):
        print_text(reason["text"], 4)
    for line in parameter_lines(result):
        print_text(line, 4)
    for name in ("run.mp4", "run.webp", "replay.html", "report.html"):
        if (folder / name).exists():
            typer.echo(folder / name)


def print_figures(result: Mapping[str, Any]) -> None:
    """Print the scalar figures of a result by name."""
    table = simple_table("figure", "value")
    for key, value in result.items():
        name = key.replace("_", " ")
        if isinstance(value, float):
            table.add_row(name, f"{value:.4g}")
        elif isinstance(value, (bool, int, str)):
            table.add_row(name, str(value))
    _print(table)
