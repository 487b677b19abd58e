"""Tables of a run's stages and bodies, for the report."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from typing import Any

from pushpressslide.core.pose import wrap_angle
from pushpressslide.report.page_tables import table


def bodies_table(result: Mapping[str, Any]) -> str:
    """Final pose of each body of a run, next to its goal."""
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


def stages_table(result: Mapping[str, Any]) -> str:
    """Purpose and result of each stage of a run."""
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
