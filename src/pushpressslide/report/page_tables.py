"""The figures of a run, and of several runs side by side, as HTML tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from pushpressslide.core.plan import Plan
from pushpressslide.report.series import path_length

# label, key in result.json (dots go down), factor, unit, decimals
Row = tuple[str, str, float, str, int]

GROUPS: tuple[tuple[str, tuple[Row, ...]], ...] = (
    (
        "At the goal",
        (
            ("Position error", "final_position_error", 1e3, "mm", 2),
            ("Yaw error", "final_yaw_error", 180.0 / math.pi, "°", 2),
        ),
    ),
    (
        "On the way, against the reference at the same time",
        (
            ("Position error, RMS", "rms_position_error", 1e3, "mm", 2),
            ("Yaw error, RMS", "rms_yaw_error", 180.0 / math.pi, "°", 2),
            ("End-effector error, RMS", "rms_end_effector_error", 1e3, "mm", 2),
            ("Position error, largest", "max_position_error", 1e3, "mm", 2),
        ),
    ),
    (
        "Against the path",
        (
            ("Tracking point to the path, RMS", "path_rms_error", 1e3, "mm", 2),
            ("Way of the tracking point", "path_length", 1.0, "m", 3),
        ),
    ),
    (
        "Contact",
        (
            ("Largest normal force", "max_normal_force", 1.0, "N", 1),
            ("Contact lost for", "contact_loss_time", 1e3, "ms", 0),
            (
                "Outside the friction cone",
                "cone_violation_fraction",
                100.0,
                "% of ticks",
                2,
            ),
            ("Slip along the surface", "slip_distance", 1e3, "mm", 2),
            ("Largest tilt of the object", "max_tilt_deg", 1.0, "°", 2),
            ("Farthest off the support", "support_gap_max", 1e3, "mm", 2),
            ("Falls on the way in", "fall_height", 1e3, "mm", 1),
            ("Falls as fast as", "fall_speed", 1.0, "m/s", 2),
            ("Depth in the opening", "seated_depth", 1e3, "mm", 1),
        ),
    ),
    (
        "Arms",
        (
            ("Largest torque over its limit", "max_torque_share", 100.0, "%", 0),
            (
                "Beyond a torque limit",
                "torque_limit_violation_fraction",
                100.0,
                "% of ticks",
                2,
            ),
            (
                "Least distance to a joint limit",
                "joint_limit_margin",
                180.0 / math.pi,
                "°",
                1,
            ),
        ),
    ),
    (
        "Time",
        (
            ("Duration, simulated", "duration", 1.0, "s", 2),
            ("Contact phase", "motion_duration", 1.0, "s", 2),
            ("Simulated over wall time", "realtime_factor", 1.0, "×", 2),
            ("Track, median a tick", "tick_us.track.median", 1.0, "µs", 1),
            ("Allocate, median a tick", "tick_us.allocate.median", 1.0, "µs", 1),
            ("Execute, median a tick", "tick_us.execute.median", 1.0, "µs", 1),
            ("All of a tick, median", "tick_us.total.median", 1.0, "µs", 1),
            ("All of a tick, 99th percentile", "tick_us.total.p99", 1.0, "µs", 1),
        ),
    ),
)

CONTACT_ROWS: tuple[Row, ...] = (
    ("Planned load", "load", 1.0, "N", 1),
    ("Normal, mean", "mean_normal_force", 1.0, "N", 1),
    ("Normal, largest", "max_normal_force", 1.0, "N", 1),
    ("Friction used, mean", "mean_friction_use", 100.0, "%", 0),
    ("Outside the cone", "cone_violation_fraction", 100.0, "%", 2),
    ("Lost for", "contact_loss_time", 1e3, "ms", 0),
    ("Slip", "slip_distance", 1e3, "mm", 2),
)
KINDS = {"side": "push on a side", "top": "press on top"}

ASKED = {
    "final_position_error": "tolerance.position",
    "final_yaw_error": "tolerance.yaw",
    "motion_duration": "planned.motion_duration",
    "path_length": "planned.path_length",
    "joint_limit_margin": "planned.joint_limit_margin",
}
"""What a figure is set beside: a tolerance, or what the plan foresaw."""


def lookup(result: Mapping[str, Any], key: str) -> Any:
    """Return the value at a dotted key; None where any step is missing or null."""
    value: Any = result
    for step in key.split("."):
        value = value.get(step) if isinstance(value, Mapping) else None
    return value


def shown(
    result: Mapping[str, Any], key: str, factor: float, unit: str, decimals: int
) -> str:
    """Return a figure with its unit; a dash where it does not apply."""
    value = lookup(result, key)
    if value is None:
        return "–"
    space = "" if unit == "°" else " "
    return f"{factor * value:.{decimals}f}{space}{unit}"


def table(
    head: Sequence[str],
    rows: Sequence[Sequence[str]],
    attributes: Sequence[str] = (),
    numbers: int = 0,
) -> str:
    """Return an HTML table that scrolls sideways where it is too wide; ``rows`` hold
    finished cells.

    ``attributes``: of each row's tag. The last ``numbers`` columns of the head are set
    to the right.
    """
    cells = "".join(
        f'<th scope="col"{" class=n" if i >= len(head) - numbers else ""}>{escape(h)}</th>'
        for i, h in enumerate(head)
    )
    top = f"<thead><tr>{cells}</tr></thead>" if head else ""
    marks = attributes or [""] * len(rows)
    lines = "".join(
        f"<tr{mark}>{''.join(row)}</tr>" for mark, row in zip(marks, rows, strict=True)
    )
    return f'<div class="scroll"><table>{top}<tbody>{lines}</tbody></table></div>'


def figures_table(result: Mapping[str, Any]) -> str:
    """Return the figures of one run: measured, beside what was asked or planned."""
    rows: list[list[str]] = []
    marks = []
    for group, entries in GROUPS:
        if all(lookup(result, key) is None for _, key, *_ in entries):
            continue
        rows.append([f'<th colspan="3" scope="rowgroup">{escape(group)}</th>'])
        marks.append(' class="group"')
        for label, key, factor, unit, decimals in entries:
            if lookup(result, key) is None:
                continue
            rows.append(
                [
                    f'<th scope="row">{escape(label)}</th>',
                    f'<td class="n {_judged(result, key)}">{shown(result, key, factor, unit, decimals)}</td>',
                    f'<td class="n">{_asked(result, key, factor, unit, decimals)}</td>',
                ]
            )
            marks.append("")
    return table(("", "Measured", "Asked or planned"), rows, marks, numbers=2)


def comparison_table(names: Sequence[str], results: Sequence[Mapping[str, Any]]) -> str:
    """Return the figures of several runs, one column each."""
    rows = [
        [
            '<th scope="row">Engine</th>',
            *(f'<td class="n">{escape(str(r["engine"]))}</td>' for r in results),
        ]
    ]
    rows.append(
        [
            '<th scope="row">Mode</th>',
            *(f'<td class="n">{escape(", ".join(r["modes"]))}</td>' for r in results),
        ]
    )
    outcomes = [escape(r["reason"]["code"].replace("_", " ")) for r in results]
    rows.append(
        ['<th scope="row">Outcome</th>']
        + [
            f'<td class="n {"ok" if r["success"] else "no"}">{outcome}</td>'
            for r, outcome in zip(results, outcomes, strict=True)
        ]
    )
    marks = [""] * len(rows)
    for group, entries in GROUPS:
        known = [
            entry
            for entry in entries
            if any(lookup(r, entry[1]) is not None for r in results)
        ]
        if known:
            rows.append(
                [
                    f'<th colspan="{len(names) + 1}" scope="rowgroup">{escape(group)}</th>'
                ]
            )
            marks.append(' class="group"')
        for label, key, factor, unit, decimals in known:
            cells = [
                f'<td class="n {_judged(r, key)}">{shown(r, key, factor, unit, decimals)}</td>'
                for r in results
            ]
            rows.append([f'<th scope="row">{escape(label)}</th>', *cells])
            marks.append("")
    return table(("", *names), rows, marks, numbers=len(names))


def _asked(
    result: Mapping[str, Any], key: str, factor: float, unit: str, decimals: int
) -> str:
    if key not in ASKED or lookup(result, ASKED[key]) is None:
        return ""
    sign = "≤ " if ASKED[key].startswith("tolerance") else ""
    return sign + shown(result, ASKED[key], factor, unit, decimals)


def _judged(result: Mapping[str, Any], key: str) -> str:
    """Class of a figure that has a tolerance: kept or not."""
    asked = lookup(result, ASKED.get(key, ""))
    value = lookup(result, key)
    if (
        key not in ASKED
        or not ASKED[key].startswith("tolerance")
        or asked is None
        or value is None
    ):
        return ""
    return "ok" if value <= asked else "no"


def contacts_table(plan: Plan, result: Mapping[str, Any]) -> str:
    """Return where each arm touches the object, and what its contact went through: one
    column each.
    """
    grasps = plan.by_placement if result["contacts"] else (plan,)
    contacts = [c for grasp in grasps for c in grasp.contacts]
    measured = [*(result["contacts"] or ())]
    measured += [{}] * (len(contacts) - len(measured))
    robots = plan.task.robots
    names = [
        f"{_which(grasp, plan)}arm {c.arm}: {Path(robots[c.arm].model).name}".capitalize()
        for grasp in grasps
        for c in grasp.contacts
    ]
    lines = [
        ("Contact", [KINDS[c.kind] for c in contacts]),
        (
            "Place, from the CoM",
            [f"({1e3 * c.point[0]:.0f}, {1e3 * c.point[1]:.0f}) mm" for c in contacts],
        ),
        ("Height", [f"{1e3 * c.height:.0f} mm" for c in contacts]),
    ]
    lines += [
        (label, [shown(figures, key, factor, unit, decimals) for figures in measured])
        for label, key, factor, unit, decimals in CONTACT_ROWS
    ]
    rows = [
        [
            f'<th scope="row">{label}</th>',
            *(f'<td class="n">{escape(cell)}</td>' for cell in cells),
        ]
        for label, cells in lines
    ]
    return table(("", *names), rows, numbers=len(names))


def _which(grasp: Plan, plan: Plan) -> str:
    return (
        f"grasp {plan.by_placement.index(grasp) + 1}, "
        if len(plan.by_placement) > 1
        else ""
    )


def stretches_table(plan: Plan) -> str:
    """Return the stretches of a plan one by one; empty for a plan of one."""
    if len(plan.segments) < 2:
        return ""
    rows = []
    for i, stretch in enumerate(plan.segments):
        goal = stretch.goal
        axle = stretch.X_BV
        cells = (
            f"{path_length(stretch.path):.3f} m",
            f"{stretch.profile.duration:.1f} s",
            f"({1e3 * axle.x:.0f}, {1e3 * axle.y:.0f}) mm, "
            f"{math.degrees(axle.yaw):.1f}°",
            f"({goal.x:.3f}, {goal.y:.3f}) m, {math.degrees(goal.yaw):.1f}°",
        )
        rows.append(
            [
                f'<th scope="row">{i + 1}</th>',
                *(f'<td class="n">{escape(cell)}</td>' for cell in cells),
            ]
        )
    return table(
        ("Stretch", "Path", "Time", "Tracking point, from the CoM", "Leads to"),
        rows,
        numbers=4,
    )
